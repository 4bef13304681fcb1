#include "tools/common/monitor_view.h"

#include <cstdlib>
#include <fstream>
#include <iterator>

#include "absl/strings/str_join.h"
#include "core/base/text.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/flat_layout.h"
#include "tools/common/skin_heatmap.h"
#include "tools/common/terminal.h"

namespace tactus::internal::client {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

SkinLayout Grid(int rows, int columns) {
  return tactus::internal::testing::FlatLayout("grid", rows, columns,
                                               TaxelUnit::kNewton, 0.01, 0.02);
}

MonitorState Example() {
  MonitorState state;
  state.title = "grid, 16 x 24 at 100 Hz   models/no-poses/versions/1";
  state.layout = Grid(16, 24);
  state.layout.mask.assign(384, 1);
  state.layout.mask[30] = 0;
  state.values.resize(384);
  for (int r = 5; r < 9; ++r) {
    for (int c = 10; c < 16; ++c) {
      state.values[24 * r + c] = 0.1F * static_cast<float>(r + c - 14);
    }
  }
  state.in_contact = true;
  state.contact_id = 12;
  state.contact_s = 1.24;
  state.full_scale = 1;
  state.max_force = 0.9;
  state.area_taxels = 23;
  state.area_m2 = 23e-4;
  state.motion_m = 0.0031;
  state.class_names = {"HU", "HM", "SU", "SM"};
  state.probability = {0.812, 0.1, 0.088, 0};
  state.unknown = 0.05;
  state.decision = 0;
  state.decision_ms = 210;
  state.rate_hz = 99.98;
  state.configured_hz = 100;
  state.frames = 1234;
  state.lost = 3;
  state.age_p50_ms = 1.2;
  state.age_p99_ms = 4;
  state.answer_p50_ms = 0.6;
  state.answer_p99_ms = 2;
  state.footer = {"q or Ctrl-C ends"};
  return state;
}

// The same text as in tests/golden/monitor, which TACTUS_RENEW_GOLDEN=1 writes
// again.
void ExpectGolden(const std::string& name, const std::string& text) {
  const std::string path = std::string(std::getenv("TACTUS_SOURCE_DIR")) +
                           "/tests/golden/monitor/" + name;
  if (std::getenv("TACTUS_RENEW_GOLDEN") != nullptr) {
    std::ofstream(path) << text;
  }
  std::ifstream file(path);
  const std::string golden{std::istreambuf_iterator<char>(file), {}};
  EXPECT_EQ(text, golden) << path;
}

TEST(MonitorViewTest, LooksAsItDid) {
  ExpectGolden("plain.txt",
               absl::StrJoin(RenderMonitor(Example(), {80, 24, false}), "\n"));
  ExpectGolden("colour.txt",
               absl::StrJoin(RenderMonitor(Example(), {80, 24, true}), "\n"));
}

// Characters that a terminal shows.
size_t WidthOf(const std::string& line) {
  size_t width = 0;
  bool escape = false;
  for (const char c : line) {
    if (c == '\x1b') escape = true;
    const auto byte = static_cast<unsigned char>(c);
    if (!escape && (byte < 0x80 || byte >= 0xC0)) ++width;
    if (escape && c == 'm') escape = false;
  }
  return width;
}

TEST(MonitorViewTest, FitsEveryTerminal) {
  for (const bool colour : {false, true}) {
    for (const int rows : {0, 1, 2, 5, 12, 24, 60}) {
      for (const int columns : {0, 1, 20, 40, 80, 200}) {
        for (const auto& [r, c] : {std::pair{1, 1}, {64, 64}, {3, 64}}) {
          MonitorState state = Example();
          state.layout = Grid(r, c);
          state.values.assign(r * c, 0.5F);
          const auto lines = RenderMonitor(state, {columns, rows, colour});
          ASSERT_EQ(lines.size(), static_cast<size_t>(rows));
          for (const std::string& line : lines) {
            EXPECT_LE(WidthOf(line), static_cast<size_t>(columns));
            EXPECT_TRUE(IsUtf8(line));
          }
        }
      }
    }
  }
}

TEST(MonitorViewTest, WithoutColoursThereAreNoEscapes) {
  for (const std::string& line : RenderMonitor(Example(), {80, 24, false})) {
    for (const char c : line) EXPECT_TRUE(c >= ' ' && c <= '~') << line;
  }
}

TEST(MonitorViewTest, ManyClassesShowTheMostProbable) {
  MonitorState state = Example();
  state.class_names.clear();
  state.probability.assign(20, 0.01);
  for (int k = 0; k < 20; ++k)
    state.class_names.push_back("c" + std::to_string(k));
  state.probability[17] = 0.81;
  const auto lines = absl::StrJoin(RenderMonitor(state, {80, 24, false}), "\n");
  EXPECT_THAT(lines, HasSubstr("c17"));
  EXPECT_THAT(lines, Not(HasSubstr("c19")));
  EXPECT_THAT(lines, HasSubstr("answer"));
}

TEST(MonitorViewTest, TextOfOthersCannotMoveTheCursor) {
  MonitorState state = Example();
  state.title = "a\x1b[2Jb\n\xff";
  EXPECT_EQ(RenderMonitor(state, {80, 24, false})[0], "a?[2Jb??");
}

// A skin that is larger than the area shows the largest taxel of each dot, and
// nothing of masked ones.
TEST(SkinHeatmapTest, IsReducedByTheLargest) {
  SkinLayout layout = Grid(4, 6);
  layout.mask.assign(24, 1);
  std::vector<float> values(24, 0);
  values[2] = 1;
  layout.mask[6 * 2 + 0] = 0;
  values[6 * 2 + 0] = 1;
  for (const int masked : {16, 17, 22, 23}) layout.mask[masked] = 0;
  TextCanvas canvas(10, 10);
  DrawHeatmap(layout, values, 1, {.columns = 3, .rows = 2}, false, canvas);
  const auto lines = canvas.Lines(false);
  EXPECT_EQ(lines[0], ".@.");
  EXPECT_EQ(lines[1], "..x");
}

TEST(SkinHeatmapTest, TwoTaxelsShareACharacter) {
  std::vector<float> values = {0, 1, 1, 0};
  TextCanvas canvas(10, 10);
  const HeatmapArea drawn = DrawHeatmap(
      Grid(2, 2), values, 1, {.columns = 2, .rows = 1}, true, canvas);
  EXPECT_EQ(drawn.columns, 2);
  EXPECT_EQ(drawn.rows, 1);
  EXPECT_EQ(canvas.Lines(true)[0],
            "\x1b[0;38;5;234;48;5;230m▀\x1b[0;38;5;230;48;5;234m▀\x1b[0m");
}

TEST(SkinHeatmapTest, ALightContactIsSeenAndNoiseIsNot) {
  const std::vector<float> values = {0.011F, 0.009F};
  TextCanvas canvas(2, 1);
  DrawHeatmap(Grid(1, 2), values, 1, {.columns = 2, .rows = 1}, false, canvas);
  EXPECT_EQ(canvas.Lines(false)[0], ":.");
}

TEST(SkinHeatmapTest, ColoursRiseWithTheLoad) {
  EXPECT_EQ(HeatCharacter(0), '.');
  EXPECT_EQ(HeatCharacter(-1), '.');
  EXPECT_EQ(HeatCharacter(0.1), '.');
  EXPECT_EQ(HeatCharacter(0.12), ':');
  EXPECT_EQ(HeatCharacter(1), '@');
  EXPECT_EQ(HeatCharacter(7), '@');
  EXPECT_EQ(HeatColour(0), 234);
  EXPECT_EQ(HeatColour(1), 230);
}

TEST(TerminalTest, ColoursNeedUtf8AndNoVeto) {
  EXPECT_TRUE(UsesColour(nullptr, "xterm", "en_GB.UTF-8"));
  EXPECT_TRUE(UsesColour("", "screen", "C.utf8"));
  EXPECT_FALSE(UsesColour("1", "xterm", "en_GB.UTF-8"));
  EXPECT_FALSE(UsesColour(nullptr, "dumb", "en_GB.UTF-8"));
  EXPECT_FALSE(UsesColour(nullptr, nullptr, "en_GB.UTF-8"));
  EXPECT_FALSE(UsesColour(nullptr, "xterm", "C"));
  EXPECT_FALSE(UsesColour(nullptr, "xterm", nullptr));
}

}  // namespace
}  // namespace tactus::internal::client
