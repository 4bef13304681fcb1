// trainctl catalog copy, and doctor on what it made.
#include <filesystem>
#include <memory>

#include "gmock/gmock.h"
#include "tests/support/filled_data.h"
#include "tests/support/postgres_server.h"
#include "tests/support/scratch_dir.h"
#include "tests/tools/trainctl/remote/trainctl_program.h"
#include "tools/trainctl/exit_code.h"

namespace tactus::internal::client {
namespace {

using internal::testing::DataFilesBelow;
using internal::testing::FillData;
using internal::testing::FilledFiles;
using internal::testing::PostgresServer;
using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::Outcome;
using testing::Trainctl;

TEST(TrainctlCatalogUsageTest, EachSideIsOnePlace) {
  const auto usage = [](std::vector<std::string> flags) {
    std::vector<std::string> words = {"catalog", "copy"};
    words.insert(words.end(), flags.begin(), flags.end());
    const Outcome outcome = Trainctl(words);
    EXPECT_EQ(outcome.exit, kExitUsage) << outcome.err;
    return outcome.err;
  };
  EXPECT_THAT(usage({}), HasSubstr("--from-data-dir and --from-catalog"));
  EXPECT_THAT(usage({"--from-data-dir=/a"}),
              HasSubstr("--to-data-dir and --to-catalog"));
  usage({"--from-data-dir=/a", "--to-catalog=postgresql://db/x"});
  usage({"--from-data-dir=/a", "--to-catalog=/b", "--to-blobs=/c"});
  usage({"--from-data-dir=/a", "--to-data-dir=/b",
         "--to-catalog=postgresql://db/x", "--to-blobs=/c"});
}

class TrainctlCatalogTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!PostgresServer::IsInstalled()) {
      GTEST_SKIP() << "PostgreSQL is not installed";
    }
    postgres_ = std::make_unique<PostgresServer>();
    catalog_ = "=" + postgres_->NewDatabase();
    FillData(folder_ / "data");
  }
  Outcome CopyIn() const {
    return Trainctl({"catalog", "copy", "--from-data-dir=" + (folder_ / "data"),
                     "--to-catalog" + catalog_, "--to-blobs" + blobs_});
  }

  ScratchDir folder_;
  std::unique_ptr<PostgresServer> postgres_;
  // Behind the names of flags.
  std::string catalog_;
  const std::string blobs_ = "=" + (folder_ / "shared");
};

TEST_F(TrainctlCatalogTest, CopiesThereAndBack) {
  const Outcome copied = CopyIn();
  ASSERT_EQ(copied.exit, kExitOk) << copied.err;
  EXPECT_THAT(copied.out,
              AllOf(HasSubstr("the same on both sides"), HasSubstr("blobs: 7"),
                    HasSubstr("tactusd --catalog=postgresql://")));
  const Outcome again = CopyIn();
  EXPECT_EQ(again.exit, kExitError);
  EXPECT_THAT(again.err, HasSubstr("was finished before"));
  const Outcome back = Trainctl(
      {"catalog", "copy", "--from-catalog" + catalog_, "--from-blobs" + blobs_,
       "--to-data-dir=" + (folder_ / "back"), "--json"});
  ASSERT_EQ(back.exit, kExitOk) << back.err;
  EXPECT_EQ(back.json()["blobs"], 7);
  EXPECT_THAT(copied.out,
              HasSubstr(back.json()["records_sha256"].get<std::string>()));
  EXPECT_TRUE(DataFilesBelow(folder_ / "back") == FilledFiles());
}

TEST(TrainctlCatalogUsageTest, TheDoctorChecksOnePlace) {
  const std::string catalog = "--catalog=postgresql://db/x";
  EXPECT_EQ(Trainctl({"doctor", catalog}).exit, kExitUsage);
  EXPECT_EQ(Trainctl({"doctor", "--repair"}).exit, kExitUsage);
  EXPECT_EQ(Trainctl({"doctor", catalog, "--blobs=/c", "--data-dir=/d"}).exit,
            kExitUsage);
  EXPECT_EQ(
      Trainctl({"doctor", catalog, "--blobs=/c", "--accept-catalogue"}).exit,
      kExitUsage);
}

TEST_F(TrainctlCatalogTest, TheDoctorChecksWhatServersShare) {
  std::vector<std::string> doctor = {"doctor", "--catalog" + catalog_,
                                     "--blobs" + blobs_};
  // Nothing is there, and nothing is made.
  Outcome checked = Trainctl(doctor);
  EXPECT_EQ(checked.exit, kExitDoctorErrors);
  EXPECT_THAT(checked.out, HasSubstr("holds no catalogue"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "shared"));
  ASSERT_EQ(CopyIn().exit, kExitOk);
  checked = Trainctl(doctor);
  EXPECT_THAT(checked.out, AllOf(HasSubstr("ok       blobs"),
                                 HasSubstr("ok       orphans")));
  const std::string job = folder_ / "shared/jobs/99";
  std::filesystem::create_directories(job);
  checked = Trainctl(doctor);
  EXPECT_EQ(checked.exit, kExitDoctorWarnings);
  EXPECT_THAT(checked.out, HasSubstr("warning  jobs"));
  EXPECT_TRUE(std::filesystem::exists(job));
  doctor.push_back("--repair");
  EXPECT_THAT(Trainctl(doctor).out, HasSubstr("lost+found/1: 1 folders"));
  EXPECT_FALSE(std::filesystem::exists(job));
}

}  // namespace
}  // namespace tactus::internal::client
