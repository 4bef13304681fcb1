// The load generator: its histogram against sorting, its messages against the
// encoder's, and whole tests against an in-process server.
#include "tools/load/load.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "core/base/random.h"
#include "google/protobuf/util/message_differencer.h"
#include "gtest/gtest.h"
#include "nlohmann/json.hpp"
#include "tests/server/support/test_server.h"
#include "tools/load/find_max.h"
#include "tools/load/latency_histogram.h"
#include "tools/load/schedule.h"

namespace tactus::internal::client {
namespace {

using testing::TestServer;

TEST(LatencyHistogramTest, PercentilesAreThoseOfSorting) {
  Random random(3);
  LatencyHistogram histogram;
  EXPECT_EQ(histogram.PercentileNs(0.5), 0);
  std::vector<int64_t> sorted;
  for (int i = 0; i < 20'000; ++i) {
    sorted.push_back(static_cast<int64_t>(std::exp(random.Uniform(0, 25))));
    histogram.Add(sorted.back());
  }
  std::sort(sorted.begin(), sorted.end());
  EXPECT_EQ(histogram.count(), sorted.size());
  EXPECT_EQ(histogram.max_ns(), sorted.back());
  for (const double share : {0.001, 0.1, 0.5, 0.9, 0.99, 0.999, 1.0}) {
    const auto rank = static_cast<size_t>(std::ceil(share * sorted.size()));
    const auto want = sorted[rank - 1];
    const auto got = histogram.PercentileNs(share);
    EXPECT_GE(got, want);
    EXPECT_LE(static_cast<double>(got), 1.01 * static_cast<double>(want));
  }
  LatencyHistogram extremes;
  extremes.Add(-5);
  extremes.Add(std::numeric_limits<int64_t>::max());
  EXPECT_EQ(extremes.PercentileNs(0.5), 0);
  EXPECT_EQ(extremes.PercentileNs(1), std::numeric_limits<int64_t>::max());
}

TEST(ScheduleTest, DependsOnNumbersAlone) {
  const Schedule schedule(100, 1'000, 10'000'000, 7);
  const Schedule same(100, 1'000, 10'000'000, 7);
  std::set<int64_t> phases;
  for (int robot = 0; robot < 100; ++robot) {
    const int64_t first = schedule.DueNs(robot, 0);
    EXPECT_EQ(first, same.DueNs(robot, 0));
    EXPECT_GE(first, 1'000);
    EXPECT_LT(first, 1'000 + 10'000'000);
    if (robot > 0) {
      EXPECT_GE(first, schedule.DueNs(robot - 1, 0));
    }
    EXPECT_EQ(schedule.DueNs(robot, 1'000'000), first + 10'000'000'000'000);
    phases.insert(first);
  }
  EXPECT_GT(phases.size(), 95u);
}

v1::FrameBatch MessageOf(const FrameScript& script, size_t position,
                         uint64_t first_sequence) {
  std::string bytes;
  script.AppendMessage(position, first_sequence, &bytes);
  v1::ClassifyContactRequest request;
  EXPECT_TRUE(request.ParseFromString(bytes));
  return request.frames();
}

TEST(FrameScriptTest, MessagesCarryTheirNumbersAndSeededFrames) {
  for (const bool sparse : {false, true}) {
    for (const uint32_t frames : {1u, 4u}) {
      const FrameScript::Options options = {
          .frames_per_message = frames, .sparse = sparse, .contacts = 1};
      const auto script = *FrameScript::Create(options);
      ASSERT_GT(script.size(), 100 / frames);
      const uint64_t sequence = 1'000'000'000;
      v1::FrameBatch batch = MessageOf(script, 17, sequence);
      EXPECT_EQ(batch.first_sequence(), sequence);
      EXPECT_EQ(batch.first_capture_time_ns(),
                static_cast<int64_t>(sequence) * 10'000'000);
      EXPECT_EQ(batch.frame_count(), frames);
      EXPECT_EQ(batch.has_sparse(), sparse);
      EXPECT_EQ(batch.taxels().size(), sparse ? 0 : frames * 16 * 24 * 2);
      EXPECT_EQ(batch.poses_size(), static_cast<int>(frames) * 7);
      const auto same = *FrameScript::Create(options);
      EXPECT_TRUE(google::protobuf::util::MessageDifferencer::Equals(
          batch, MessageOf(same, 17 + same.size(), sequence)));
    }
  }
  EXPECT_FALSE(
      FrameScript::Create({.frames_per_message = 1000, .contacts = 1}).ok());
}

class LoadTest : public ::testing::Test {
 protected:
  explicit LoadTest(int max_streams = 100)
      : server_({.listen = {"127.0.0.1:0"}, .max_streams = max_streams}) {}

  LoadOptions Options() {
    return {
        .servers = {"127.0.0.1:" + std::to_string(server_.server().ports()[0])},
        .robots = 4,
        .rate_hz = 200,
        .seconds = 0.3,
        .warm_up_seconds = 0.05,
        .connections = 2};
  }
  // Short, and made once.
  static const FrameScript& Script(uint32_t frames_per_message) {
    static const FrameScript one = *FrameScript::Create({.contacts = 1});
    static const FrameScript four = *FrameScript::Create(
        {.frames_per_message = 4, .sparse = true, .contacts = 1});
    return frames_per_message == 1 ? one : four;
  }
  // A slow machine may make the server drop answers; nothing else may get lost.
  static void ExpectWhole(const LoadReport& report, uint64_t messages) {
    EXPECT_EQ(report.sent, messages);
    EXPECT_LE(report.lost(), report.superseded);
    EXPECT_EQ(report.refused, 0) << report.first_error;
    EXPECT_EQ(report.failed, 0) << report.first_error;
    EXPECT_GT(report.p50_ms, 0);
    EXPECT_LE(report.p50_ms, report.p90_ms);
    EXPECT_LE(report.p99_ms, report.p999_ms);
    EXPECT_LE(report.p999_ms, report.max_ms);
  }

  TestServer server_;
};

TEST_F(LoadTest, EveryMessageIsAnswered) {
  LoadOptions options = Options();
  const auto report = RunLoad(options, Script(1));
  ASSERT_TRUE(report.ok()) << report.status();
  ExpectWhole(*report, 4 * 60);
  options.frames_per_message = 4;
  options.connections = 0;
  ExpectWhole(*RunLoad(options, Script(4)), 4 * 15);
  EXPECT_EQ(server_.server().gate().refused(), 0u);
  EXPECT_TRUE(testing::Eventually(
      [this] { return server_.server().gate().live() == 0; }));
  EXPECT_EQ(server_.server().gate().frames(), 2u * 240);
}

TEST_F(LoadTest, ReportsAsTextAndJson) {
  const LoadReport report = *RunLoad(Options(), Script(1));
  const auto json = nlohmann::json::parse(LoadToJson(report));
  EXPECT_EQ(json["sent"], report.sent);
  EXPECT_EQ(json["lost"], report.lost());
  EXPECT_EQ(json["p99_ms"], report.p99_ms);
  EXPECT_NE(LoadToText(report).find("4 robots: 240 messages sent"),
            std::string::npos);
}

class FewStreamsTest : public LoadTest {
 protected:
  FewStreamsTest() : LoadTest(3) {}
};

TEST_F(FewStreamsTest, RefusedRobotsAreCounted) {
  const LoadReport report = *RunLoad(Options(), Script(1));
  EXPECT_EQ(report.refused, 1);
  EXPECT_FALSE(report.ok());
  EXPECT_EQ(report.sent, 3u * 60);
  EXPECT_NE(report.first_error.find("STREAM_LIMIT"), std::string::npos)
      << report.first_error;
}

TEST_F(FewStreamsTest, TheSearchEndsAtTheServersLimit) {
  int tests = 0;
  LoadOptions options = Options();
  options.seconds = 0.1;
  const auto most = FindMaxRobots(
      options, {.p99_limit_ms = 1e6, .min_robots = 1, .attempts = 1},
      [&](const LoadReport&) { ++tests; });
  ASSERT_TRUE(most.ok()) << most.status();
  // A slow machine may end it earlier, never later.
  EXPECT_LE(most->robots, 3);
  EXPECT_GE(tests, 2);
  EXPECT_LE(tests, 6);
}

// What a server that answers up to `most` robots in time reports, on a machine
// that is disturbed while 100 are tried.
LoadReport ReportOf(int robots, int most) {
  LoadReport report;
  report.robots = robots;
  report.streams = robots;
  report.sent = report.answered = 100;
  report.p99_ms = robots > most || robots == 100 ? 50 : 1;
  return report;
}

TEST(FindMaxTest, ADisturbanceDoesNotEndTheSearch) {
  for (const int most : {3, 60, 390}) {
    int tests = 0;
    const auto found = FindMaxRobots(
        {.min_robots = 25},
        [&](int robots) -> absl::StatusOr<LoadReport> {
          return ReportOf(robots, most);
        },
        [&](const LoadReport&) { ++tests; });
    ASSERT_TRUE(found.ok()) << found.status();
    EXPECT_LE(found->robots, most);
    EXPECT_GE(found->robots, most - most / 20);
    EXPECT_LE(tests, 30);
  }
}

TEST(LoadOptionsTest, NobodyListensAndBadOptions) {
  const LoadOptions nobody = {.servers = {"unix:/no/such/socket"},
                              .robots = 2,
                              .seconds = 0.1,
                              .warm_up_seconds = 0};
  const FrameScript script = *FrameScript::Create({.contacts = 1});
  const auto report = RunLoad(nobody, script);
  ASSERT_TRUE(report.ok()) << report.status();
  EXPECT_EQ(report->refused, 2);
  EXPECT_EQ(report->sent, 0u);
  EXPECT_FALSE(report->ok());
  LoadOptions bad = nobody;
  bad.robots = 0;
  EXPECT_FALSE(RunLoad(bad, script).ok());
  bad = nobody;
  bad.warm_up_seconds = 1;
  EXPECT_FALSE(RunLoad(bad, script).ok());
}

}  // namespace
}  // namespace tactus::internal::client
