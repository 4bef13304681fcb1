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
  EventWriter events(file);
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
  EventWriter events(file);
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

}  // namespace
}  // namespace tactus::internal::server
