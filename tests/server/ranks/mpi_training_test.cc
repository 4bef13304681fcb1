// Trainings of several ranks, as tactusd starts them.
#include <dirent.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <map>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "core/base/status_proto.h"
#include "core/bundle/bundle.h"
#include "gtest/gtest.h"
#include "server/jobs/job_process.h"
#include "tests/server/trainer/small_job.h"

namespace tactus::internal::server {
namespace {

using std::chrono::milliseconds;

struct Process {
  pid_t pid;
  pid_t parent;
  std::string name;
};

std::vector<Process> Processes() {
  std::vector<Process> all;
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    std::ifstream file(entry.path() / "stat");
    std::string line;
    if (!std::getline(file, line)) continue;
    const size_t open = line.find('(');
    const size_t close = line.rfind(')');
    if (open == std::string::npos || close == std::string::npos) continue;
    Process process;
    process.pid = std::stoi(line);
    process.name = line.substr(open + 1, close - open - 1);
    std::istringstream rest(line.substr(close + 1));
    char state = 0;
    rest >> state >> process.parent;
    // What has ended and nobody has asked for is no process any more.
    if (state != 'Z') all.push_back(process);
  }
  return all;
}

// The ranks of the launcher that this process has started.
std::vector<pid_t> RunningRanks() {
  const auto all = Processes();
  std::vector<pid_t> ranks;
  for (const Process& launcher : all) {
    if (launcher.parent != getpid()) continue;
    for (const Process& rank : all) {
      // A name is cut to 15 letters.
      if (rank.parent == launcher.pid && rank.name == "tactus-trainer-") {
        ranks.push_back(rank.pid);
      }
    }
  }
  return ranks;
}

bool IsRunning(pid_t pid) {
  return std::ranges::count(Processes(), pid, &Process::pid) > 0;
}

bool Await(const std::function<bool()>& condition) {
  for (int i = 0; i < 6'000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(milliseconds(10));
  }
  return false;
}

class MpiTrainingTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    // In a container there is often no other user.
    setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
    setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
  }

  v1::TrainSpec& train() {
    return *job_.spec().mutable_operation()->mutable_train();
  }

  std::unique_ptr<JobProcess> Start(const std::string& folder, int ranks,
                                    int threads = 1) {
    JobProcess::Options options = {.program = TACTUS_TRAINER,
                                   .start_threads = threads,
                                   .threads = threads};
    if (ranks > 1) {
      options.launcher = {"mpirun",    "-n",   std::to_string(ranks),
                          "--bind-to", "none", "--oversubscribe"};
    }
    auto process = JobProcess::Start(options, folder);
    EXPECT_TRUE(process.ok()) << process.status();
    return *std::move(process);
  }

  // Reads all events, until the process has ended.
  JobProcess::End Follow(JobProcess& process) {
    events_.clear();
    v1::JobEvent event;
    JobProcess::News news;
    while ((news = process.Next(milliseconds(100), &event)) !=
           JobProcess::News::kClosed) {
      if (news == JobProcess::News::kEvent) events_.push_back(event);
    }
    return process.Wait(std::chrono::seconds(30));
  }

  // The bundle that so many ranks make.
  std::string Bundle(const std::string& folder, int ranks, int threads = 1) {
    const auto process = Start(folder, ranks, threads);
    const JobProcess::End end = Follow(*process);
    EXPECT_TRUE(end.ok) << end.text << "\n" << ReadBytes(folder + "/log");
    return ReadBytes(folder + "/bundle.tactus");
  }

  testing::SmallJob job_;
  std::vector<v1::JobEvent> events_;
};

TEST_F(MpiTrainingTest, AnyNumberOfRanksMakesTheSameBundle) {
  train().set_networks(2);
  train().set_epochs(2);
  for (const int shards : {1, 4}) {
    train().set_gradient_shards(shards);
    const std::string suffix = "-" + std::to_string(shards);
    const std::string alone = Bundle(job_.New("alone" + suffix), 1);
    ASSERT_TRUE(DecodeBundle(alone).ok());
    for (const int ranks : {2, 3, 4}) {
      const std::string folder = job_.New(std::to_string(ranks) + suffix);
      EXPECT_TRUE(Bundle(folder, ranks, /*threads=*/ranks % 2 + 1) == alone)
          << ranks << " ranks, " << shards << " shards";
    }
  }
}

TEST_F(MpiTrainingTest, TheFirstRankTellsWhatAllDo) {
  const auto points = [&](const std::string& name, int ranks) {
    Bundle(job_.New(name), ranks);
    std::multiset<std::pair<std::string, uint32_t>> points;
    for (const v1::JobEvent& event : events_) {
      if (!event.has_point()) continue;
      points.insert({event.point().part(), event.point().iteration()});
    }
    return points;
  };
  const auto alone = points("alone", 1);
  EXPECT_GT(alone.size(), 20u);
  EXPECT_EQ(points("three", 3), alone);
  double last = 0;
  for (const v1::JobEvent& event : events_) {
    if (event.progress().phase() != "train models") continue;
    EXPECT_GE(event.progress().fraction(), last);
    last = event.progress().fraction();
  }
  EXPECT_NEAR(last, 1, 1e-6);
}

TEST_F(MpiTrainingTest, AKilledRankEndsAllAndAnotherNumberGoesOn) {
  train().set_epochs(40);
  train().set_gradient_shards(4);
  const std::string alone = Bundle(job_.New("alone"), 1);
  const std::string folder = job_.New("killed");
  {
    const auto process = Start(folder, 2);
    ASSERT_TRUE(Await([&] {
      return RunningRanks().size() == 2 &&
             std::filesystem::exists(folder + "/parts/lstm_0");
    })) << ReadBytes(folder + "/log");
    const std::vector<pid_t> ranks = RunningRanks();
    ASSERT_EQ(ranks.size(), 2u);
    kill(ranks[1], SIGKILL);
    const JobProcess::End end = Follow(*process);
    EXPECT_FALSE(end.ok);
    EXPECT_FALSE(std::filesystem::exists(folder + "/result.pb"));
    EXPECT_TRUE(Await([&] { return !IsRunning(ranks[0]); }));
  }
  EXPECT_TRUE(Bundle(folder, 3) == alone);
}

// As tactusd ends a job that must not go on.
TEST_F(MpiTrainingTest, RanksEndWithTheirLauncher) {
  train().set_epochs(2'000);
  const std::string folder = job_.New("killed");
  std::vector<pid_t> ranks;
  {
    const auto process = Start(folder, 2);
    ASSERT_TRUE(Await([&] {
      ranks = RunningRanks();
      return ranks.size() == 2 && std::filesystem::exists(folder + "/parts") &&
             !std::filesystem::is_empty(folder + "/parts");
    }));
  }
  EXPECT_TRUE(Await([&] {
    return std::ranges::none_of(ranks,
                                [](pid_t pid) { return IsRunning(pid); });
  }));
}

TEST_F(MpiTrainingTest, ARequestToEndReachesAllRanks) {
  train().set_epochs(10'000);
  const std::string folder = job_.New("cancelled");
  const auto process = Start(folder, 3);
  ASSERT_TRUE(Await([&] {
    return std::filesystem::exists(folder + "/parts") &&
           !std::filesystem::is_empty(folder + "/parts");
  }));
  process->Terminate(/*kill=*/false);
  const JobProcess::End end = Follow(*process);
  v1::JobOutcome outcome;
  ASSERT_TRUE(outcome.ParseFromString(ReadBytes(folder + "/result.pb")))
      << end.text << "\n"
      << ReadBytes(folder + "/log");
  EXPECT_TRUE(absl::IsCancelled(FromStatusProto(outcome.error())))
      << outcome.error().message();
}

TEST_F(MpiTrainingTest, ABadJobEndsWithTheSameOutcome) {
  job_.spec().set_trials(3, std::string(64, '0'));
  const auto error = [&](const std::string& name, int ranks) {
    const std::string folder = job_.New(name);
    const auto process = Start(folder, ranks);
    const JobProcess::End end = Follow(*process);
    EXPECT_TRUE(end.ok) << end.text << "\n" << ReadBytes(folder + "/log");
    v1::JobOutcome outcome;
    EXPECT_TRUE(outcome.ParseFromString(ReadBytes(folder + "/result.pb")));
    return outcome.error().message();
  };
  const std::string alone = error("alone", 1);
  EXPECT_NE(alone.find("does not exist"), std::string::npos) << alone;
  EXPECT_EQ(error("three", 3), alone);
}

}  // namespace
}  // namespace tactus::internal::server
