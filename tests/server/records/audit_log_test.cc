#include "server/records/audit_log.h"

#include "core/base/errors.h"
#include "core/store/records.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/server/records/stores.h"

namespace tactus::server {
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

}  // namespace
}  // namespace tactus::server
