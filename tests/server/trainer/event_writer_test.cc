#include "server/trainer/event_writer.h"

#include <fcntl.h>
#include <unistd.h>

#include <cstring>
#include <map>
#include <thread>
#include <vector>

#include "gtest/gtest.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal::server {
namespace {

// The events of a file, as the server reads them.
std::vector<v1::JobEvent> EventsOf(const std::string& path) {
  const std::string bytes = ReadBytes(path);
  std::vector<v1::JobEvent> events;
  for (size_t at = 0; at < bytes.size();) {
    uint32_t length = 0;
    std::memcpy(&length, bytes.data() + at, sizeof length);
    at += sizeof length;
    EXPECT_TRUE(
        events.emplace_back().ParseFromString(bytes.substr(at, length)));
    at += length;
  }
  return events;
}

TEST(EventWriterTest, SendsPointsOfAllThreadsWhole) {
  const ScratchDir folder;
  const int file = open((folder / "events").c_str(), O_WRONLY | O_CREAT, 0666);
  LoneTeam alone;
  EventWriter events(file, &alone);
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      LearningPoint point;
      point.part = "lstm/" + std::to_string(t);
      point.loss = 0.5;
      for (point.iteration = 1; point.iteration <= 50; ++point.iteration) {
        events.Send(point);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  close(file);
  std::map<std::string, uint32_t> last;
  for (const v1::JobEvent& event : EventsOf(folder / "events")) {
    ASSERT_TRUE(event.has_point());
    EXPECT_EQ(event.point().iteration(), ++last[event.point().part()]);
    EXPECT_EQ(event.point().loss(), 0.5);
    EXPECT_FALSE(event.point().has_accuracy());
  }
  EXPECT_EQ(last.size(), 4u);
}

TEST(EventWriterTest, ProgressGrowsAndEndsAtOne) {
  const ScratchDir folder;
  const int file = open((folder / "events").c_str(), O_WRONLY | O_CREAT, 0666);
  LoneTeam alone;
  EventWriter events(file, &alone);
  const Progress part = events.progress().Part("read trials", 1);
  for (int i = 0; i < 1000; ++i) part.Add(0.0011);
  close(file);
  double fraction = 0;
  const auto all = EventsOf(folder / "events");
  for (const v1::JobEvent& event : all) {
    EXPECT_EQ(event.progress().phase(), "read trials");
    EXPECT_GE(event.progress().fraction(), fraction);
    fraction = event.progress().fraction();
  }
  EXPECT_EQ(fraction, 1);
  EXPECT_LT(all.size(), 300u);
}

// The first of three ranks; what the others say is given.
class FirstOfThree final : public Team {
 public:
  int rank() const override { return 0; }
  int size() const override { return 3; }
  absl::StatusOr<std::vector<std::string>> Exchange(
      const absl::StatusOr<std::string>& /*mine*/) override {
    if (while_waiting_) while_waiting_();
    return std::vector<std::string>(3);
  }
  void Tell(const std::string& /*bytes*/) override { ADD_FAILURE(); }
  void Hear(const Take& take) override {
    auto said = std::move(said_);
    said_.clear();
    for (const auto& [rank, bytes] : said) take(rank, bytes);
  }
  void WhileWaiting(std::function<void()> call) override {
    while_waiting_ = std::move(call);
  }

  void Say(int rank, const v1::JobEvent& event) {
    said_.emplace_back(rank, event.SerializeAsString());
  }

 private:
  std::vector<std::pair<int, std::string>> said_;
  std::function<void()> while_waiting_;
};

TEST(EventWriterTest, TheFirstRankWritesWhatAllHaveDone) {
  const ScratchDir folder;
  const int file = open((folder / "events").c_str(), O_WRONLY | O_CREAT, 0666);
  FirstOfThree team;
  EventWriter events(file, &team);
  v1::JobEvent point;
  point.mutable_point()->set_part("lstm/1");
  v1::JobEvent progress;
  progress.mutable_progress()->set_phase("train models");
  team.Say(1, point);
  progress.mutable_progress()->set_fraction(0.25);
  team.Say(1, progress);
  progress.mutable_progress()->set_fraction(0.375);
  // What came last of a rank counts.
  team.Say(1, progress);
  // It hears while it waits, and while it works.
  ASSERT_TRUE(team.Exchange(std::string()).ok());
  progress.mutable_progress()->set_fraction(0.125);
  team.Say(2, progress);
  const Progress own = events.progress().Part("train models", 1);
  own.Add(0.25);
  // One rank is in the next phase when the last of this one comes.
  progress.mutable_progress()->set_fraction(0.375);
  team.Say(2, progress);
  progress.mutable_progress()->set_phase("calibrate on left-out folds");
  team.Say(1, progress);
  own.Add(0.125);
  close(file);
  const auto all = EventsOf(folder / "events");
  ASSERT_FALSE(all.empty());
  EXPECT_EQ(all.front().point().part(), "lstm/1");
  ASSERT_GE(all.size(), 3u);
  EXPECT_EQ(all.back().progress().phase(), "calibrate on left-out folds");
  EXPECT_EQ(all[all.size() - 2].progress().phase(), "train models");
  EXPECT_EQ(all[all.size() - 2].progress().fraction(), 1);
}

}  // namespace
}  // namespace tactus::internal::server
