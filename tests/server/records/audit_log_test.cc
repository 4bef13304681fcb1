#include "server/records/audit_log.h"

#include "core/base/errors.h"
#include "core/store/records.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/server/records/stores.h"

namespace tactus::internal::server {
namespace {

using ::testing::ElementsAre;

// "verb resource" of all entries, in order.
std::vector<std::string> Entries(const Stores& stores) {
  std::vector<std::string> lines;
  EXPECT_TRUE(stores.data->catalog()
                  .Look([&](const Transaction& look) -> absl::Status {
                    TACTUS_ASSIGN_OR_RETURN(
                        const auto entries,
                        ScanRecords<v1::AuditEntry>(look, Table::kAudit, {}));
                    for (const v1::AuditEntry& entry : entries) {
                      EXPECT_EQ(entry.caller(), kCaller.name);
                      EXPECT_EQ(entry.peer(), kCaller.peer);
                      EXPECT_EQ(entry.time_ms(), stores.time_ms);
                      lines.push_back(entry.verb() + " " + entry.resource());
                    }
                    return absl::OkStatus();
                  })
                  .ok());
  return lines;
}

TEST(AuditLogTest, EveryChangeIsRecorded) {
  const ScratchDir folder;
  Stores stores(&PosixFileSystem(), folder / "data");
  ASSERT_TRUE(stores.datasets->Create(kDataset, "", kCaller).ok());
  ASSERT_TRUE(stores.Upload(Pack(0, 1)).ok());
  ASSERT_TRUE(stores.operations->Create({}, "", kCaller).ok());
  for (const int seed : {1, 2}) {
    ASSERT_TRUE(
        stores.models->AddVersion("models/m", TestBundle(seed), {}, kCaller)
            .ok());
  }
  v1::PromoteSpec spec;
  spec.set_alias("aliases/a");
  spec.set_model_version("models/m/versions/1");
  ASSERT_TRUE(stores.models->Promote(spec, false, kCaller).ok());
  spec.set_model_version("models/m/versions/2");
  ASSERT_TRUE(stores.models->Promote(spec, true, kCaller).ok());
  ASSERT_TRUE(stores.models->Rollback("aliases/a", "", kCaller).ok());
  v1::UpdateAliasRequest update;
  update.set_name("aliases/b");
  ASSERT_TRUE(stores.models->UpdateAlias(update, kCaller).ok());
  // What fails leaves no entry.
  EXPECT_FALSE(stores.datasets->Create(kDataset, "", kCaller).ok());
  EXPECT_FALSE(stores.models->Delete("models/m/versions/1", kCaller).ok());
  ASSERT_TRUE(stores.datasets->Delete(kDataset, kCaller).ok());
  EXPECT_THAT(
      Entries(stores),
      ElementsAre("create datasets/d", "create uploads/1",
                  "create datasets/d/versions/1", "create operations/1",
                  "create models/m/versions/1", "create models/m/versions/2",
                  "promote aliases/a", "force aliases/a", "roll back aliases/a",
                  "update aliases/b", "delete datasets/d"));
}

TEST(AuditLogTest, IsListedInPagesAndFiltered) {
  const ScratchDir folder;
  Stores stores(&PosixFileSystem(), folder / "data");
  const int entries = 2'100;
  ASSERT_TRUE(stores.data->catalog()
                  .Change([&](Transaction& change) -> absl::Status {
                    for (int i = 1; i <= entries; ++i) {
                      const Caller caller = {i % 3 == 0 ? "a" : "b", ""};
                      TACTUS_RETURN_IF_ERROR(
                          Audit(change, caller, i, "do",
                                i % 700 == 0 ? "models/m" : "datasets/d"));
                    }
                    return absl::OkStatus();
                  })
                  .ok());
  const auto list = [&](int size, const AuditFilter& filter) {
    std::vector<int64_t> times;
    std::string token;
    do {
      const auto page = ListAudit(stores.data->catalog(), size, token, filter);
      EXPECT_TRUE(page.ok()) << page.status();
      EXPECT_LE(page->items.size(), static_cast<size_t>(size));
      for (const auto& entry : page->items) times.push_back(entry.time_ms());
      token = page->next_token;
    } while (!token.empty());
    return times;
  };
  const auto all = list(1'000, {});
  ASSERT_EQ(all.size(), static_cast<size_t>(entries));
  EXPECT_EQ(all.front(), entries);
  EXPECT_EQ(all.back(), 1);
  EXPECT_THAT(list(1, {.resource_prefix = "models/"}),
              ElementsAre(2'100, 1'400, 700));
  EXPECT_THAT(list(2, {.resource_prefix = "models/", .caller = "a"}),
              ElementsAre(2'100));
  EXPECT_EQ(list(7, {.caller = "a"}).size(), 700u);
  EXPECT_TRUE(list(7, {.caller = "c"}).empty());
}

}  // namespace
}  // namespace tactus::internal::server
