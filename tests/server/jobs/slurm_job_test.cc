// Trainings that Slurm runs: a cluster of one node, which the test starts.
#include "server/jobs/slurm_job.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <set>
#include <string>
#include <thread>

#include "core/base/errors.h"
#include "core/base/status_proto.h"
#include "core/bundle/bundle.h"
#include "gtest/gtest.h"
#include "server/trainer/exit_status.h"
#include "tests/server/trainer/small_job.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal::server {
namespace {

using std::chrono::milliseconds;

TEST(SlurmStateTest, SaysHowAJobStands) {
  const auto parse = [](const std::string& state, const std::string& code) {
    return ParseSlurmState(
        "JobId=7 JobName=tactus Priority=4 JobState=" + state +
        " Reason=None Requeue=1 Restarts=0 ExitCode=" + code +
        " RunTime=00:00:02\n");
  };
  EXPECT_TRUE(parse("PENDING", "0:0").waits);
  for (const char* const state :
       {"PENDING", "RUNNING", "COMPLETING", "SUSPENDED", "REQUEUED"}) {
    EXPECT_FALSE(parse(state, "0:0").ended) << state;
  }
  EXPECT_TRUE(parse("COMPLETED", "0:0").end.ok);
  EXPECT_EQ(parse("FAILED", "4:0").end.status, kExitStorageFull);
  EXPECT_EQ(parse("FAILED", "1:0").end.text, "exited with status 1");
  EXPECT_EQ(parse("FAILED", "0:9").end.status, -1);
  EXPECT_EQ(parse("OUT_OF_MEMORY", "0:125").end.status, kExitOutOfMemory);
  EXPECT_EQ(parse("TIMEOUT", "0:0").end.text,
            "reached the time limit of its Slurm job");
  EXPECT_EQ(parse("NODE_FAIL", "0:0").end.text, "lost its node in Slurm");
  EXPECT_EQ(parse("CANCELLED", "0:0").end.text, "was cancelled in Slurm");
  EXPECT_FALSE(parse("CANCELLED", "0:0").end.ok);
  // What it does not know is no success.
  EXPECT_TRUE(parse("NEW_STATE", "0:0").ended);
  EXPECT_FALSE(parse("NEW_STATE", "0:0").end.ok);
  EXPECT_FALSE(ParseSlurmState("").end.ok);
}

bool Await(const std::function<bool()>& condition) {
  for (int i = 0; i < 6'000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(milliseconds(10));
  }
  return false;
}

class SlurmJobTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (access("/usr/sbin/slurmctld", X_OK) != 0) return;
    std::string name = ::testing::TempDir() + "/tactus-slurm-XXXXXX";
    folder_ = mkdtemp(name.data());
    slurm_ = fork();
    if (slurm_ == 0) {
      setpgid(0, 0);
      const std::string script = std::string(std::getenv("TACTUS_SOURCE_DIR")) +
                                 "/tests/cluster/slurm.sh";
      execl(script.c_str(), script.c_str(), folder_.c_str(), nullptr);
      _exit(127);
    }
    setenv("SLURM_CONF", (folder_ + "/slurm.conf").c_str(), 1);
    // In a container there is often no other user.
    setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
    setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
    EXPECT_TRUE(Await([] {
      return std::filesystem::exists(folder_ + "/ready");
    })) << ReadBytes(folder_ + "/slurmctld.log");
  }
  static void TearDownTestSuite() {
    if (slurm_ == 0) return;
    kill(slurm_, SIGTERM);
    waitpid(slurm_, nullptr, 0);
    std::filesystem::remove_all(folder_);
  }
  void SetUp() override {
    if (slurm_ == 0) GTEST_SKIP() << "slurmctld is not installed";
  }

  v1::TrainSpec& train() {
    return *job_.spec().mutable_operation()->mutable_train();
  }
  std::unique_ptr<SlurmJob> Start(const std::string& folder, int ranks = 1) {
    auto run = SlurmJob::Start({.process = {.program = TACTUS_TRAINER},
                                .ranks = ranks,
                                .interval = milliseconds(200)},
                               folder);
    EXPECT_TRUE(run.ok()) << run.status();
    return *std::move(run);
  }
  // Reads all events until the job has ended, and calls `meanwhile` before each
  // look.
  JobRun::End Follow(
      JobRun& run, const std::function<void()>& meanwhile = [] {}) {
    points_.clear();
    v1::JobEvent event;
    JobRun::News news;
    while ((news = run.Next(milliseconds(100), &event)) !=
           JobRun::News::kClosed) {
      meanwhile();
      if (news == JobRun::News::kEvent && event.has_point()) {
        points_.insert({event.point().part(), event.point().iteration()});
      }
    }
    return run.Wait(std::chrono::seconds(30));
  }
  std::string BundleOf(const std::string& folder, JobRun& run) {
    const JobRun::End end = Follow(run);
    EXPECT_TRUE(end.ok) << end.text << "\n" << ReadBytes(folder + "/log");
    return ReadBytes(folder + "/bundle.tactus");
  }
  // The bundle of one process here.
  std::string Expected() {
    const std::string folder = job_.New("here");
    const auto run = JobProcess::Start({.program = TACTUS_TRAINER}, folder);
    EXPECT_TRUE(run.ok()) << run.status();
    return BundleOf(folder, **run);
  }
  static bool HasCheckpoint(const std::string& folder) {
    return std::filesystem::exists(folder + "/parts/lstm_0");
  }

  testing::SmallJob job_;
  std::multiset<std::pair<std::string, uint32_t>> points_;
  static std::string folder_;
  static pid_t slurm_;
};

std::string SlurmJobTest::folder_;
pid_t SlurmJobTest::slurm_ = 0;

TEST_F(SlurmJobTest, MakesTheBundleAndTellsThePoints) {
  const std::string expected = Expected();
  ASSERT_TRUE(DecodeBundle(expected).ok());
  const auto points = points_;
  for (const int ranks : {1, 2}) {
    const std::string folder = job_.New(std::to_string(ranks) + " ranks'");
    const auto run = Start(folder, ranks);
    EXPECT_TRUE(BundleOf(folder, *run) == expected) << ranks;
    EXPECT_EQ(points_, points) << ranks;
  }
}

TEST_F(SlurmJobTest, ARequestToEndLeavesAnOutcome) {
  train().set_epochs(5'000);
  const std::string folder = job_.New("cancelled");
  const auto run = Start(folder);
  bool asked = false;
  const JobRun::End end = Follow(*run, [&] {
    if (!asked && HasCheckpoint(folder)) {
      run->Terminate(/*kill=*/false);
      asked = true;
    }
  });
  EXPECT_TRUE(end.ok) << end.text;
  v1::JobOutcome outcome;
  ASSERT_TRUE(outcome.ParseFromString(ReadBytes(folder + "/result.pb")));
  EXPECT_TRUE(absl::IsCancelled(FromStatusProto(outcome.error())));
}

// A server that has died and is started again finds the job running.
TEST_F(SlurmJobTest, ASecondStartEndsTheFirstAndGoesOn) {
  train().set_epochs(60);
  const std::string expected = Expected();
  const std::string folder = job_.New("twice");
  const auto first = Start(folder);
  ASSERT_TRUE(Await([&] { return HasCheckpoint(folder); }));
  const auto second = Start(folder);
  EXPECT_TRUE(BundleOf(folder, *second) == expected);
  EXPECT_NE(first->number(), second->number());
  EXPECT_NE(second->number(), "");
  // What was trained before is not trained again.
  EXPECT_EQ(points_.count({"lstm/0", 1}), 0u);
  EXPECT_EQ(points_.count({"lstm/0", 60}), 1u);
  const JobRun::End end = Follow(*first);
  EXPECT_EQ(end.text, "was cancelled in Slurm");
}

TEST_F(SlurmJobTest, WhatSlurmRequeuesGoesOn) {
  train().set_epochs(60);
  const std::string expected = Expected();
  const std::string folder = job_.New("requeued");
  const auto run = Start(folder);
  bool requeued = false;
  const JobRun::End end = Follow(*run, [&] {
    if (requeued || !HasCheckpoint(folder)) return;
    const auto done = RunCommand({"scontrol", "requeue", run->number()},
                                 std::chrono::seconds(10));
    ASSERT_TRUE(done.ok() && done->status == 0) << done->output;
    requeued = true;
  });
  ASSERT_TRUE(requeued);
  EXPECT_TRUE(end.ok) << end.text << "\n" << ReadBytes(folder + "/log");
  EXPECT_TRUE(ReadBytes(folder + "/bundle.tactus") == expected);
  EXPECT_TRUE(std::filesystem::exists(folder + "/events.1"));
  EXPECT_EQ(points_.count({"lstm/0", 60}), 1u);
}

// What Slurm's programs see while slurmctld is away.
class SlurmAwayTest : public SlurmJobTest {
 protected:
  void SetUp() override {
    SlurmJobTest::SetUp();
    if (slurm_ == 0) return;
    const std::string away = folder_ + "/away.conf";
    // The last of equal keys counts.
    std::ofstream(away) << ReadBytes(folder_ + "/slurm.conf")
                        << "SlurmctldPort=1\nMessageTimeout=2\n";
    setenv("SLURM_CONF", away.c_str(), 1);
  }
  void TearDown() override { ComesBack(); }
  static void ComesBack() {
    setenv("SLURM_CONF", (folder_ + "/slurm.conf").c_str(), 1);
  }
};

TEST_F(SlurmAwayTest, AJobIsSubmittedOnceSlurmAnswers) {
  const std::string expected = Expected();
  const std::string folder = job_.New("early");
  const auto run = Start(folder);
  v1::JobEvent event;
  EXPECT_EQ(run->Next(milliseconds(300), &event), JobRun::News::kNone);
  EXPECT_EQ(run->number(), "");
  ComesBack();
  EXPECT_TRUE(BundleOf(folder, *run) == expected);
  EXPECT_NE(run->number(), "");
}

TEST_F(SlurmAwayTest, AJobThatWasNotSubmittedCanBeCancelled) {
  const auto run = Start(job_.New("given up"));
  run->Terminate(/*kill=*/false);
  const JobRun::End end = Follow(*run);
  EXPECT_FALSE(end.ok);
  EXPECT_EQ(end.text, "had not begun in Slurm");
}

TEST_F(SlurmJobTest, ARefusalSaysWhatSlurmSays) {
  const std::string folder = job_.New("refused");
  const auto run = SlurmJob::Start({.process = {.program = TACTUS_TRAINER},
                                    .sbatch = {"--partition=nowhere"}},
                                   folder);
  EXPECT_EQ(ReasonOf(run.status()), "IO");
  EXPECT_NE(run.status().message().find("invalid partition"), std::string::npos)
      << run.status();
}

}  // namespace
}  // namespace tactus::internal::server
