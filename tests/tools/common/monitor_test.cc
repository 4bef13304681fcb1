#include "tools/common/monitor.h"

#include "gtest/gtest.h"
#include "tests/support/flat_layout.h"

namespace tactus::internal::client {
namespace {

SkinInfo SmallSkin() {
  SkinInfo info;
  info.layout = tactus::internal::testing::FlatLayout("small", 2, 2,
                                                      TaxelUnit::kCounts, 2, 3);
  info.layout.mask = {1, 1, 1, 0};
  info.scale = 0.5;
  return info;
}

SkinFrame FrameOf(std::vector<uint16_t> values, int64_t time_ns) {
  SkinFrame frame;
  frame.capture_time_ns = time_ns;
  frame.u16 = std::move(values);
  return frame;
}

TEST(MonitorTest, MeasuresAgesAndAnswers) {
  Monitor monitor(SmallSkin());
  EXPECT_EQ(monitor.Snapshot({}).age_p50_ms, -1);
  EXPECT_EQ(monitor.Snapshot({}).answer_p50_ms, -1);
  for (uint64_t i = 1; i <= 1'000; ++i) {
    const int64_t time_ns = static_cast<int64_t>(i) * 10'000'000;
    monitor.Frame(FrameOf({1, 2, 3, 4}, time_ns), i, time_ns + 2'000'000);
    if (i % 2 == 0) continue;
    v1::Answer posterior;
    posterior.set_sequence(i);
    monitor.Answer(posterior, time_ns + 2'500'000);
  }
  // One that was sent too long ago.
  v1::Answer late;
  late.set_sequence(3);
  monitor.Answer(late, 20'000'000'000);
  const MonitorState state = monitor.Snapshot({});
  EXPECT_EQ(state.frames, 1'000u);
  EXPECT_DOUBLE_EQ(state.age_p50_ms, 2);
  EXPECT_DOUBLE_EQ(state.age_p99_ms, 2);
  EXPECT_DOUBLE_EQ(state.answer_p99_ms, 0.5);
  EXPECT_EQ(state.values, (std::vector<float>{0.5, 1, 1.5, 2}));
}

TEST(MonitorTest, TheFullScaleFollowsThePeakAndSinks) {
  Monitor monitor(SmallSkin());
  // Twice the onset threshold; a masked taxel does not count.
  monitor.Frame(FrameOf({1, 0, 0, 9'000}, 1), 0, 1);
  EXPECT_EQ(monitor.Snapshot({}).full_scale, 6);
  monitor.Frame(FrameOf({200, 0, 0, 0}, 2), 0, 2);
  EXPECT_EQ(monitor.Snapshot({}).full_scale, 100);
  for (int i = 0; i < 500; ++i) monitor.Frame(FrameOf({0, 0, 0, 0}, 3), 0, 3);
  EXPECT_NEAR(monitor.Snapshot({}).full_scale, 50, 0.01);
}

}  // namespace
}  // namespace tactus::internal::client
