#include <cmath>

#include "client/tools/plot/frame.h"
#include "gtest/gtest.h"

namespace tactus::client {
namespace {

constexpr double kWidth = 560;
constexpr double kHeight = 400;

// Where the labels of both axes stand.
std::vector<Box> LabelBoxes(const PlotFrame& frame) {
  std::vector<Box> boxes;
  for (const Tick& tick : frame.x().ticks) {
    const double half = Canvas::TextWidth(tick.label, {.size = kTickSize}) / 2;
    const double x = frame.AtX(tick.value);
    const double top = frame.plot().bottom + 8;
    boxes.push_back({x - half, top, x + half, top + kTickSize});
  }
  for (const Tick& tick : frame.y().ticks) {
    const double width = Canvas::TextWidth(tick.label, {.size = kTickSize});
    const double right = frame.plot().left - 8;
    const double y = frame.AtY(tick.value);
    boxes.push_back(
        {right - width, y - kTickSize / 2, right, y + kTickSize / 2});
  }
  return boxes;
}

TEST(PlotFrameTest, LabelsOfLogarithmicAxesNeverOverlap) {
  Canvas canvas(kWidth, kHeight);
  for (int decades = 1; decades <= 20; ++decades) {
    for (const double low : {1e-14, 3e-7, 0.2, 170.0}) {
      const DataRange range = {low, low * std::pow(10, decades)};
      const Axis axis = {.scale = AxisScale::kLog};
      const auto scale = MakeScale(axis, range, 6);
      ASSERT_TRUE(scale.ok()) << scale.status();
      const PlotFrame frame(canvas, kWidth, kHeight,
                            {.title = "t", .x = *scale, .y = *scale});
      EXPECT_GE(frame.x().ticks.size(), 3u) << low << ' ' << decades;
      EXPECT_GE(frame.y().ticks.size(), 3u) << low << ' ' << decades;
      const std::vector<Box> boxes = LabelBoxes(frame);
      for (size_t i = 0; i < boxes.size(); ++i) {
        for (size_t j = 0; j < i; ++j) {
          EXPECT_FALSE(boxes[i].Overlaps(boxes[j]))
              << low << ", " << decades << " decades, labels " << i << " and "
              << j;
        }
      }
    }
  }
}

}  // namespace
}  // namespace tactus::client
