#include "tools/trainctl/data/skin_strip.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/flat_layout.h"

namespace tactus::internal::client {
namespace {

using ::tactus::internal::testing::FlatLayout;
using ::testing::Each;
using ::testing::ElementsAre;

// The ends and the middle of matplotlib's table.
constexpr Rgb kBlack = {0, 0, 4};
constexpr Rgb kBrightest = {252, 255, 164};

TEST(SkinColourTest, RunsFromBlackToLightYellow) {
  EXPECT_EQ(SkinColour(0), kBlack);
  EXPECT_EQ(SkinColour(1), kBrightest);
  // Brightness only grows.
  int last = -1;
  for (int i = 0; i <= 20; ++i) {
    const Rgb colour = SkinColour(i / 20.);
    const int brightness = 299 * colour[0] + 587 * colour[1] + 114 * colour[2];
    EXPECT_GT(brightness, last) << i;
    last = brightness;
  }
}

// Pixels at the centres of the taxels of one row of picture `index`.
std::vector<Rgb> RowOf(const SkinStrip& strip, const SkinWindow& window,
                       int index, int row) {
  std::vector<Rgb> colours;
  for (int c = 0; c < window.columns; ++c) {
    const int x = strip.lefts[index] +
                  (2 * c + 1) * strip.picture_width / (2 * window.columns);
    const int y = (2 * row + 1) * strip.picture_height / (2 * window.rows);
    colours.push_back(strip.At(x, y));
  }
  return colours;
}

TEST(SkinStripTest, APictureShowsEachTaxel) {
  const SkinLayout layout = FlatLayout(2, 3);
  const SkinWindow window = {0, 0, 2, 3};
  const std::vector<float> frame = {0, 8, 0, 4, 0, 0};
  const std::vector<float> silent(6);
  const SkinStrip strip =
      DrawSkinStrip(layout, window, {frame, silent}, 8, {90, 60, 10});
  EXPECT_EQ(strip.width, 190);
  EXPECT_EQ(strip.height, 60);
  EXPECT_THAT(strip.lefts, ElementsAre(0, 100));
  EXPECT_THAT(RowOf(strip, window, 0, 0),
              ElementsAre(kBlack, kBrightest, kBlack));
  EXPECT_THAT(RowOf(strip, window, 0, 1),
              ElementsAre(SkinColour(0.5), kBlack, kBlack));
  EXPECT_THAT(RowOf(strip, window, 1, 0), Each(kBlack));
  // White between the pictures, and around what is in contact.
  EXPECT_EQ(strip.At(95, 30), (Rgb{255, 255, 255}));
  EXPECT_EQ(strip.At(30, 15), (Rgb{255, 255, 255}));
  EXPECT_EQ(strip.At(115, 15), kBlack);
}

TEST(SkinStripTest, MaskedTaxelsStayDark) {
  SkinLayout layout = FlatLayout(1, 2);
  layout.mask = {0, 1};
  const std::vector<float> frame = {8, 8};
  const SkinWindow window = {0, 0, 1, 2};
  const SkinStrip strip =
      DrawSkinStrip(layout, window, {frame}, 8, {80, 40, 0});
  EXPECT_THAT(RowOf(strip, window, 0, 0), ElementsAre(kBlack, kBrightest));
}

TEST(SkinStripTest, PicturesKeepTheSkinsProportions) {
  SkinLayout layout = FlatLayout(4, 4);
  layout.row_pitch_m = 2 * layout.column_pitch_m;
  const std::vector<float> frame(16);
  const SkinStrip strip =
      DrawSkinStrip(layout, {0, 0, 4, 4}, {frame}, 1, {200, 100, 0});
  EXPECT_EQ(strip.picture_height, 100);
  EXPECT_EQ(strip.picture_width, 50);
}

std::vector<float> FrameWith(const SkinLayout& layout,
                             const std::vector<std::pair<int, int>>& touched) {
  std::vector<float> frame(layout.taxels());
  for (const auto& [row, column] : touched) {
    frame[row * layout.columns + column] = 5;
  }
  return frame;
}

TEST(SkinWindowTest, HoldsTheContactsOfAllFramesWithTwoTaxelsAround) {
  const SkinLayout layout = FlatLayout(20, 30);
  const SkinWindow window = WindowAround(
      layout, {FrameWith(layout, {{8, 10}}), FrameWith(layout, {{10, 14}})});
  EXPECT_EQ(window.first_column, 8);
  EXPECT_EQ(window.columns, 9);
  // As high as it is wide.
  EXPECT_EQ(window.rows, 9);
  EXPECT_LE(window.first_row, 6);
  EXPECT_GE(window.first_row + window.rows, 13);
}

TEST(SkinWindowTest, RunsAcrossTheSeamOfAWrappedSkin) {
  SkinLayout layout = FlatLayout(20, 30);
  const auto frame = FrameWith(layout, {{8, 29}, {8, 0}});
  EXPECT_EQ(WindowAround(layout, {frame}).columns, 30);
  layout.wrap_columns = true;
  const SkinWindow window = WindowAround(layout, {frame});
  EXPECT_EQ(window.first_column, 27);
  EXPECT_EQ(window.columns, 6);
}

TEST(SkinWindowTest, EndsWithTheSkin) {
  const SkinLayout layout = FlatLayout(20, 30);
  const SkinWindow corner =
      WindowAround(layout, {FrameWith(layout, {{19, 29}})});
  EXPECT_EQ(corner.first_row + corner.rows, 20);
  EXPECT_EQ(corner.first_column + corner.columns, 30);
  const SkinWindow whole =
      WindowAround(layout, {FrameWith(layout, {{0, 0}, {19, 29}})});
  EXPECT_EQ(whole.first_row, 0);
  EXPECT_EQ(whole.rows, 20);
  EXPECT_EQ(whole.columns, 30);
}

}  // namespace
}  // namespace tactus::internal::client
