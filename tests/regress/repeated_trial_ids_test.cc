// Imports count their trials from 000000. A dataset that grew by two uploads
// had each id twice, and no trial file could take the version: what was stored
// could not be had back. So it was with a trial named "touch 1".
#include <set>

#include "core/base/sha256.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/regress/dataset_server.h"

namespace tactus::internal {
namespace {

using testing::DatasetServer;
using ::testing::HasSubstr;
using testing::Packed;
using testing::SmallTrial;

// Stores trials as release 0.1.0 did: nobody looked at their ids.
void StoreAsBefore(DatasetServer& server, const std::vector<Trial>& trials) {
  auto& backend = server.server().backend();
  const auto version = backend.datasets().AddVersion(
      "datasets/w",
      [&](auto) -> absl::StatusOr<server::DatasetStore::Content> {
        server::DatasetStore::Content content;
        auto batch = backend.data().blobs().NewBatch();
        for (const Trial& trial : trials) {
          const std::string bytes = ToRecord(trial).SerializeAsString();
          v1::TrialInfo& info = content.trials.emplace_back();
          info.set_sha256(*batch.Add(bytes));
          info.set_bytes(static_cast<int64_t>(bytes.size()));
          info.set_id(trial.id);
          info.set_label(trial.label);
        }
        EXPECT_TRUE(batch.Commit().ok());
        return content;
      },
      "before", {"before", ""},
      [](auto&, const auto&) { return absl::OkStatus(); });
  EXPECT_TRUE(version.ok()) << version.status();
}

std::set<std::string> IdsOf(const std::vector<Trial>& trials) {
  std::set<std::string> ids;
  for (const Trial& trial : trials) ids.insert(trial.id);
  return ids;
}

TEST(RepeatedTrialIdsTest, TwoUploadsDownload) {
  DatasetServer server;
  ASSERT_EQ(server.Run({"datasets", "create", "w"}).exit, 0);
  const std::string monday = server.Write("monday.h5", 0, 6);
  const std::string tuesday = server.Write("tuesday.h5", 6, 12);
  ASSERT_EQ(server.Run({"datasets", "upload", "w", "--data=" + monday}).exit,
            0);
  const auto upload =
      server.Run({"datasets", "upload", "w", "--data=" + tuesday});
  ASSERT_EQ(upload.exit, 0) << upload.err;
  EXPECT_THAT(upload.out, HasSubstr("6 of the trials got another id"));
  EXPECT_THAT(upload.out, HasSubstr("pad_6.csv is 000000-2"));

  const auto download = server.Run(
      {"datasets", "download", "w@2", "--out=" + server.Path("w.h5")});
  ASSERT_EQ(download.exit, 0) << download.err;
  const auto trials = server.Read("w.h5");
  ASSERT_EQ(trials.size(), 12u);
  std::set<std::string> sources;
  for (const Trial& trial : trials) sources.insert(trial.source);
  EXPECT_EQ(sources.size(), 12u);
  EXPECT_TRUE(sources.contains("pad_0.csv"));
  EXPECT_TRUE(sources.contains("pad_11.csv"));
  // People see the names of their recordings.
  EXPECT_THAT(server.Run({"datasets", "show", "w", "--trials"}).out,
              HasSubstr("pad_7.csv"));
}

TEST(RepeatedTrialIdsTest, IdsThatNoFileCanHaveAreRefused) {
  DatasetServer server;
  ASSERT_EQ(server.Run({"datasets", "create", "w"}).exit, 0);
  Trial trial = SmallTrial(0);
  for (const char* id : {"touch 1", "a/b", ".", "\xc3\xa9t\xc3\xa9"}) {
    trial.id = id;
    auto& uploads = server.server().backend().uploads();
    const auto upload = uploads.Create("datasets/w", "", false, {"me", ""});
    const std::string pack = Packed(trial);
    {
      auto writer = *uploads.Write(upload->name(), {"me", ""});
      EXPECT_TRUE(writer->Append(0, pack, ExtendCrc32c(0, pack)).ok());
      EXPECT_TRUE(writer->Commit().ok());
    }
    uint32_t known = 0;
    const auto made =
        uploads.Finish(upload->name(), static_cast<int64_t>(pack.size()),
                       ExtendCrc32c(0, pack), {"me", ""}, &known);
    EXPECT_EQ(ReasonOf(made.status()), "INVALID_TRIAL") << id;
    EXPECT_THAT(std::string(made.status().message()),
                HasSubstr("it must be 1 to 64 letters, digits, - or _"));
  }
}

TEST(RepeatedTrialIdsTest, VersionsOfEarlierReleasesDownload) {
  DatasetServer server;
  ASSERT_EQ(server.Run({"datasets", "create", "w"}).exit, 0);
  std::vector<Trial> trials;
  for (const char* id :
       {"000000", "000000", "000000-2", "touch 1", "touch_1"}) {
    trials.push_back(SmallTrial(static_cast<int>(trials.size())));
    trials.back().id = id;
  }
  StoreAsBefore(server, trials);
  const auto download =
      server.Run({"datasets", "download", "w", "--out=" + server.Path("w.h5")});
  ASSERT_EQ(download.exit, 0) << download.err;
  EXPECT_THAT(download.out, HasSubstr("trials got another id"));
  EXPECT_THAT(download.out, HasSubstr("touch 1 is touch_1"));
  const auto read = server.Read("w.h5");
  EXPECT_EQ(read.size(), 5u);
  EXPECT_EQ(IdsOf(read).size(), 5u);
  // An upload to it still works, and knows its recordings.
  const auto again = server.Run(
      {"datasets", "upload", "w", "--data=" + server.Write("again.h5", 0, 3)});
  ASSERT_EQ(again.exit, 0) << again.err;
  EXPECT_THAT(again.out, HasSubstr("3 of the trials were there already"));
}

}  // namespace
}  // namespace tactus::internal
