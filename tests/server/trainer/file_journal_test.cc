#include "server/trainer/file_journal.h"

#include <fcntl.h>
#include <unistd.h>

#include <set>

#include "gtest/gtest.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal::server {
namespace {

class FileJournalTest : public ::testing::Test {
 protected:
  ~FileJournalTest() override { close(null_); }
  ScratchDir folder_;
  const int null_ = open("/dev/null", O_WRONLY);
  LoneTeam alone_;
  EventWriter events_{null_, &alone_};
  FileJournal journal_{PosixFileSystem(), folder_.path(), &events_};
};

TEST_F(FileJournalTest, EachPartHasItsFile) {
  std::string long_name = "hmm/";
  for (int i = 0; i < 100; ++i) long_name += "\xe6\x9f\x94";
  const std::string parts[] = {
      "hmm/SU",  "fold/2/hmm/SU", "fold_2_hmm_SU", "hmm/..",       "..",
      "hmm/a b", "hmm/a%20b",     long_name,       long_name + "2"};
  for (const std::string& part : parts) {
    EXPECT_FALSE(journal_.Find(part).has_value()) << part;
    const absl::Status status = journal_.Put(part, "first " + part);
    ASSERT_TRUE(status.ok()) << status;
    ASSERT_TRUE(journal_.Put(part, "bytes of " + part).ok());
  }
  for (const std::string& part : parts) {
    EXPECT_EQ(journal_.Find(part), "bytes of " + part);
  }
  EXPECT_EQ(folder_.files(), std::size(parts));
}

TEST_F(FileJournalTest, TellsOfCancellation) {
  EXPECT_FALSE(journal_.Cancelled());
  journal_.Cancel();
  EXPECT_TRUE(journal_.Cancelled());
}

}  // namespace
}  // namespace tactus::internal::server
