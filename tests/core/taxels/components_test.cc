#include "core/taxels/components.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/taxels/skin_range.h"
#include "core/taxels/taxel_embedding.h"
#include "core/taxels/whole_skin.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/flat_layout.h"

namespace tactus::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

SkinLayout Axes(int axes, std::optional<int> normal, bool with_sign) {
  SkinLayout layout = testing::FlatLayout("x", 2, 3, TaxelUnit::kCounts, 1, 1);
  layout.axes = axes;
  layout.normal_axis = normal;
  layout.signed_values = with_sign;
  return layout;
}

std::vector<TaxelLoad> ComponentsOf(const SkinLayout& layout,
                                    const std::vector<float>& values,
                                    const std::vector<uint64_t>& rows) {
  std::vector<TaxelLoad> loads;
  AddComponents(layout, values, rows, loads);
  return loads;
}

TEST(ComponentsTest, ASkinHasPlanesForWhatItsLoadsDoNotTell) {
  const auto planes = [](const SkinLayout& layout) {
    return ShapeOf(layout).planes;
  };
  EXPECT_EQ(planes(Axes(1, {}, false)), 0);
  EXPECT_EQ(planes(Axes(1, 0, true)), 0);
  EXPECT_EQ(planes(Axes(1, {}, true)), 2);
  EXPECT_EQ(planes(Axes(3, 2, false)), 2);
  EXPECT_EQ(planes(Axes(3, 2, true)), 4);
  EXPECT_EQ(planes(Axes(3, {}, true)), 6);
  EXPECT_EQ(ShapeOf(Axes(3, 2, true)).total(), 6 * 5);
}

TEST(ComponentsTest, ShearIsSplitBySign) {
  // Taxels 1 and 5 are touched; taxel 2 is not.
  std::vector<float> values(18, 0);
  values[3 * 1] = 4;
  values[3 * 1 + 1] = -9;
  values[3 * 1 + 2] = 100;
  values[3 * 2] = 1;
  values[3 * 5 + 1] = 16;
  EXPECT_THAT(ComponentsOf(Axes(3, 2, true), values, {0b010, 0b100}),
              ElementsAre(TaxelLoad{6 + 1, 2}, TaxelLoad{18 + 5, 4},
                          TaxelLoad{24 + 1, 3}));
}

TEST(ComponentsTest, AuxiliaryTaxelsCountWithoutTouch) {
  SkinLayout layout = Axes(1, 0, true);
  ASSERT_TRUE(AddAuxiliary({5, 3}, layout).ok());
  const TaxelShape shape = ShapeOf(layout);
  EXPECT_EQ(shape.planes, 0);
  EXPECT_EQ(shape.auxiliary, 4);
  EXPECT_THAT(ComponentsOf(layout, {1, 1, 1, -4, 1, 25}, {0, 0}),
              ElementsAre(TaxelLoad{7, 2}, TaxelLoad{8, 5}));
  EXPECT_THAT(ComponentsOf(layout, {1, 1, 1, 0, 1, 0}, {0b111, 0}), IsEmpty());
}

TEST(ComponentsTest, WhatLooksAtTaxelsAloneDoesNotSeeThem) {
  const std::vector<TaxelLoad> loads = {{1, 2}, {4, 3}};
  std::vector<TaxelLoad> all = loads;
  all.insert(all.end(), {{6, 9}, {11, 7}});
  EXPECT_TRUE(std::ranges::equal(WithoutComponents(all, 6), loads));
  EXPECT_THAT(WithoutComponents({}, 6), IsEmpty());

  WholeSkinTracker skin(6, 100);
  WholeSkinTracker same_skin(6, 100);
  const TaxelEmbedding embedding{
      .taxels = 6,
      .dimensions = 1,
      .weights = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}};
  EmbeddingTracker vectors(&embedding, 100);
  EmbeddingTracker same_vectors(&embedding, 100);
  ContactLoads means(6);
  for (int t = 0; t < 20; ++t) {
    skin.Step(all);
    same_skin.Step(loads);
    vectors.Step(all);
    same_vectors.Step(loads);
    means.Step(all);
  }
  EXPECT_EQ(skin.numbers().root_force, same_skin.numbers().root_force);
  EXPECT_EQ(skin.numbers().root_taxels, same_skin.numbers().root_taxels);
  EXPECT_EQ(vectors.values()[0], same_vectors.values()[0]);
  EXPECT_EQ(means.Mean(4), 9);
}

}  // namespace
}  // namespace tactus::internal
