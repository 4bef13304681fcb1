// The program tactus-trainer, killed at any moment and started again.
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "core/base/errors.h"
#include "core/base/random.h"
#include "core/base/status_macros.h"
#include "core/base/status_proto.h"
#include "core/bundle/bundle.h"
#include "gtest/gtest.h"
#include "server/trainer/file_journal.h"
#include "server/trainer/job.h"
#include "tactus/v1/storage.pb.h"
#include "tests/server/trainer/small_job.h"
#include "tests/support/crash_file_system.h"

namespace tactus::internal::server {
namespace {

using std::chrono::duration;
using std::chrono::steady_clock;

class ResumeTest : public ::testing::Test {
 protected:
  std::string NewJob(const std::string& name) { return job_.New(name); }
  static pid_t Start(const std::string& folder, const char* threads = "3") {
    const pid_t pid = fork();
    if (pid == 0) {
      const int null = open("/dev/null", O_RDWR);
      dup2(null, STDOUT_FILENO);
      execl(TACTUS_TRAINER, TACTUS_TRAINER, folder.c_str(), threads, threads,
            nullptr);
      _exit(127);
    }
    return pid;
  }
  // The exit status; -1 after a signal.
  static int Wait(pid_t pid) {
    int status = 0;
    EXPECT_EQ(waitpid(pid, &status, 0), pid);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  LoneTeam alone_;
  testing::SmallJob job_;
  v1::JobSpec& spec_ = job_.spec();
};

TEST_F(ResumeTest, KilledTenTimesItMakesTheSameBundle) {
  const std::string whole = NewJob("whole");
  const auto begin = steady_clock::now();
  ASSERT_EQ(Wait(Start(whole, "1")), 0);
  const double seconds = duration<double>(steady_clock::now() - begin).count();
  v1::JobOutcome outcome;
  ASSERT_TRUE(outcome.ParseFromString(ReadBytes(whole + "/result.pb")));
  ASSERT_TRUE(outcome.has_result()) << outcome.error().message();
  const std::string bundle = ReadBytes(whole + "/bundle.tactus");
  ASSERT_TRUE(DecodeBundle(bundle).ok());

  const std::string job = NewJob("killed");
  Random random(12);
  int killed = 0;
  for (int i = 0; i < 10; ++i) {
    const pid_t pid = Start(job);
    std::this_thread::sleep_for(
        duration<double>(seconds * (0.05 + 0.4 * random.Uniform())));
    kill(pid, SIGKILL);
    killed += Wait(pid) == -1 ? 1 : 0;
  }
  // How many come in time depends on the machine.
  EXPECT_GE(killed, 1);
  EXPECT_FALSE(std::filesystem::is_empty(job + "/parts"))
      << "it went on from checkpoints";
  std::printf("%d of 10 processes were killed in time\n", killed);
  ASSERT_EQ(Wait(Start(job)), 0);
  EXPECT_EQ(ReadBytes(job + "/bundle.tactus"), bundle);
  EXPECT_EQ(ReadBytes(job + "/result.pb"), ReadBytes(whole + "/result.pb"));
}

// Threads read the trials in any order; the bundle is the same.
TEST_F(ResumeTest, TrialsAreReadByTheThreadsOfTheStart) {
  const int null = open("/dev/null", O_WRONLY);
  EventWriter events(null, &alone_);
  const auto bundle = [&](const std::string& name,
                          const ParallelFor& parallel) {
    const std::string folder = NewJob(name);
    std::filesystem::create_directory(folder + "/parts");
    FileJournal journal(PosixFileSystem(), folder + "/parts", &events);
    const absl::Status status = RunJob(PosixFileSystem(), folder,
                                       {.start = parallel, .run = RunSerially},
                                       &events, &journal, alone_);
    EXPECT_TRUE(status.ok()) << status;
    return ReadBytes(folder + "/bundle.tactus");
  };
  std::vector<int> counts;
  const std::string backwards =
      bundle("backwards", [&](int count, const std::function<void(int)>& body) {
        counts.push_back(count);
        for (int i = count - 1; i >= 0; --i) body(i);
      });
  ASSERT_FALSE(counts.empty());
  EXPECT_EQ(counts.front(), spec_.trials_size());
  EXPECT_FALSE(backwards.empty());
  EXPECT_EQ(backwards, bundle("forwards", RunSerially));
  close(null);
}

TEST_F(ResumeTest, AutoChoosesAPreset) {
  spec_.mutable_operation()->mutable_train()->set_preset("auto");
  spec_.mutable_operation()->mutable_train()->set_networks(0);
  const std::string folder = NewJob("auto");
  ASSERT_EQ(Wait(Start(folder)), 0);
  v1::JobOutcome outcome;
  ASSERT_TRUE(outcome.ParseFromString(ReadBytes(folder + "/result.pb")));
  ASSERT_TRUE(outcome.has_result()) << outcome.error().message();
  const v1::PresetChoice& choice = outcome.result().preset_choice();
  EXPECT_EQ(choice.contacts(), 24u);
  EXPECT_EQ(choice.folds(), 3u);
  ASSERT_EQ(choice.candidates_size(), 8);
  uint32_t most = 0;
  int unfit = 0;
  for (const v1::PresetCandidate& candidate : choice.candidates()) {
    most = std::max(most, candidate.correct());
    unfit += candidate.unfit().empty() ? 0 : 1;
  }
  // Those for taxels: the trials are ideal signals.
  EXPECT_EQ(unfit, 6);
  for (const v1::PresetCandidate& candidate : choice.candidates()) {
    if (candidate.preset() == choice.preset()) {
      EXPECT_EQ(candidate.correct(), most);
    }
  }
  EXPECT_TRUE(choice.preset() == "tuned" || choice.preset() == "paper");
  EXPECT_TRUE(DecodeBundle(ReadBytes(folder + "/bundle.tactus")).ok());
}

TEST_F(ResumeTest, BadJobsEndWithAnOutcomeOrAStatus) {
  const auto reason = [&](const std::string& name) {
    const std::string folder = NewJob(name);
    EXPECT_EQ(Wait(Start(folder)), 0);
    v1::JobOutcome outcome;
    EXPECT_TRUE(outcome.ParseFromString(ReadBytes(folder + "/result.pb")));
    return outcome.error().message();
  };
  spec_.mutable_operation()->mutable_train()->set_epochs(0);
  EXPECT_NE(reason("epochs").find("epochs"), std::string::npos);
  spec_.mutable_operation()->mutable_train()->clear_epochs();
  spec_.set_trials(0, std::string(64, '0'));
  EXPECT_NE(reason("trial").find("does not exist"), std::string::npos);
  const std::string folder = NewJob("garbage");
  WriteBytes(folder + "/job.pb", "garbage");
  EXPECT_EQ(Wait(Start(folder)), 1);
  EXPECT_EQ(Wait(Start(job_.Path("no"))), 1);
}

// A disk that fails at each operation of a job: the job ends with an outcome or
// a status that names the disk's error. On a sound disk it then makes the
// bundle that it would have made.
TEST_F(ResumeTest, ADiskThatFailsAtEachOperation) {
  spec_.mutable_operation()->mutable_train()->set_networks(0);
  const int null = open("/dev/null", O_WRONLY);
  EventWriter events(null, &alone_);
  const auto run = [&](FileSystem& files, const std::string& folder) {
    FileJournal journal(files, folder + "/parts", &events);
    return RunJob(files, folder, {.start = RunSerially, .run = RunSerially},
                  &events, &journal, alone_);
  };
  const auto new_job = [&] {
    std::filesystem::remove_all(job_.Path("job"));
    const std::string folder = NewJob("job");
    std::filesystem::create_directory(folder + "/parts");
    return folder;
  };
  testing::CrashFileSystem files;
  std::string folder = new_job();
  ASSERT_TRUE(run(files, folder).ok());
  const int operations = files.operations();
  const std::string bundle = ReadBytes(folder + "/bundle.tactus");
  const std::string result = ReadBytes(folder + "/result.pb");
  ASSERT_TRUE(DecodeBundle(bundle).ok());
  int failed = 0;
  for (int n = 1; n <= operations; ++n) {
    // A full disk stays full; an error comes once.
    const bool full = n % 2 == 0;
    SCOPED_TRACE(std::string(full ? "full from" : "fails at") + " operation " +
                 std::to_string(n));
    folder = new_job();
    files.Heal();
    if (full) {
      files.StopAt(n);
    } else {
      files.FailAt(n, StorageFull("disk", "no room"));
    }
    const absl::Status status = run(files, folder);
    EXPECT_TRUE(files.failed());
    if (status.ok()) {
      v1::JobOutcome outcome;
      ASSERT_TRUE(outcome.ParseFromString(ReadBytes(folder + "/result.pb")));
      EXPECT_TRUE(outcome.has_result() ||
                  ReasonOf(FromStatusProto(outcome.error())) == "STORAGE_FULL")
          << outcome.ShortDebugString();
      failed += outcome.has_error() ? 1 : 0;
    } else {
      EXPECT_EQ(ReasonOf(status), full ? "IO" : "STORAGE_FULL") << status;
      ++failed;
    }
    files.Heal();
    ASSERT_TRUE(run(files, folder).ok());
    EXPECT_EQ(ReadBytes(folder + "/bundle.tactus"), bundle);
    EXPECT_EQ(ReadBytes(folder + "/result.pb"), result);
  }
  close(null);
  std::printf("%d of %d operations failed the job\n", failed, operations);
  EXPECT_EQ(failed, operations);
}

}  // namespace
}  // namespace tactus::internal::server
