#include "core/features/segmenter.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/random.h"
#include "gtest/gtest.h"
#include "tests/core/features/segmentation_reference.h"
#include "tests/support/flat_layout.h"
#include "tests/support/shared_data.h"

namespace tactus::internal {
namespace {

SkinLayout MakeLayout(int rows, int columns, bool wrap,
                      Connectivity connectivity = Connectivity::kEight) {
  SkinLayout layout = testing::FlatLayout(rows, columns);
  layout.wrap_columns = wrap;
  layout.connectivity = connectivity;
  return layout;
}

// A frame from rows of digits; '.' is 0.
std::vector<float> Frame(const std::vector<std::string>& rows) {
  std::vector<float> taxels;
  for (const std::string& row : rows) {
    for (char c : row) {
      taxels.push_back(c == '.' ? 0.0F : static_cast<float>(c - '0'));
    }
  }
  return taxels;
}

std::string Picture(const SkinLayout& layout,
                    const std::vector<float>& taxels) {
  std::string text = absl::StrCat(
      layout.rows, " x ", layout.columns, layout.wrap_columns ? " wraps" : "",
      layout.connectivity == Connectivity::kEight ? " 8" : " 4", "\n");
  for (int i = 0; i < layout.taxels(); ++i) {
    const bool masked = !layout.mask.empty() && layout.mask[i] == 0;
    text += masked ? 'x' : static_cast<char>('0' + taxels[i]);
    if ((i + 1) % layout.columns == 0) text += '\n';
  }
  return text;
}

LoadSpread LargestSpread(Segmenter& segmenter,
                         const std::vector<float>& taxels) {
  return segmenter.Spread(taxels, segmenter.LargestRows(), segmenter.largest());
}

std::vector<uint16_t> Labels(const SkinLayout& layout,
                             const Segmenter& segmenter) {
  std::vector<uint16_t> labels(layout.taxels(), 99);
  segmenter.CopyLabels(labels);
  return labels;
}

// True if `a` and `b` split the taxels into the same sets.
template <typename A, typename B>
bool SamePartition(const A& a, const B& b) {
  std::map<int, int> forward, backward;
  for (size_t i = 0; i < a.size(); ++i) {
    if (forward.try_emplace(a[i], b[i]).first->second != b[i]) return false;
    if (backward.try_emplace(b[i], a[i]).first->second != a[i]) return false;
  }
  return forward.count(0) == 0 || forward[0] == 0;
}

// The rule of Segmenter::largest(), spelled out.
Region LargestOf(const std::vector<Region>& regions) {
  return *std::min_element(regions.begin(), regions.end(),
                           [](const Region& a, const Region& b) {
                             if (a.taxels != b.taxels)
                               return a.taxels > b.taxels;
                             if (a.max_value != b.max_value)
                               return a.max_value > b.max_value;
                             return a.first_taxel < b.first_taxel;
                           });
}

// Random shape, density, mask and values (small integers, so that ties occur).
struct RandomCase {
  SkinLayout layout;
  std::vector<float> taxels;
};

RandomCase MakeRandomCase(Random& random) {
  // Mostly small skins: there each frame meets more corner cases.
  const int limit = random.Uniform() < 0.1 ? 64 : 12;
  const auto side = [&] { return 1 + static_cast<int>(random.Index(limit)); };
  const int rows = side();
  const int columns = random.Uniform() < 0.02 ? 64 : side();
  RandomCase result;
  result.layout = MakeLayout(
      rows, columns, random.Index(2) == 0,
      random.Index(2) == 0 ? Connectivity::kEight : Connectivity::kFour);
  const double density = random.Uniform();
  result.taxels.resize(result.layout.taxels());
  for (float& taxel : result.taxels) {
    if (random.Uniform() < density) taxel = 1 + random.Index(4);
  }
  if (random.Index(4) == 0) {
    result.layout.mask.resize(result.layout.taxels(), 1);
    for (uint8_t& valid : result.layout.mask) valid = random.Index(8) != 0;
  }
  return result;
}

TEST(SegmenterTest, AgreesWithFloodFillOnRandomFrames) {
  Random random(1);
  for (int i = 0; i < 30'000; ++i) {
    const auto [layout, taxels] = MakeRandomCase(random);
    Segmenter segmenter(layout);
    const int count = segmenter.Segment(taxels);
    const ReferenceSegmentation want = FloodFill(layout, taxels);
    SCOPED_TRACE(absl::StrCat("frame ", i, ", ", Picture(layout, taxels)));
    ASSERT_EQ(count, static_cast<int>(want.regions.size()));
    const std::vector<uint16_t> labels = Labels(layout, segmenter);
    ASSERT_TRUE(std::equal(want.labels.begin(), want.labels.end(),
                           labels.begin(), labels.end()));
    float peak = 0;
    for (const Region& region : want.regions) {
      peak = std::max(peak, region.max_value);
    }
    ASSERT_EQ(segmenter.peak(), peak);
    const Region region = count > 0 ? LargestOf(want.regions) : Region();
    ASSERT_EQ(segmenter.largest().taxels, region.taxels);
    ASSERT_EQ(segmenter.largest().first_taxel, region.first_taxel);
    ASSERT_EQ(segmenter.largest().max_value, region.max_value);
    ASSERT_EQ(segmenter.largest().total, region.total);
    ASSERT_NEAR(segmenter.largest().centroid_row, region.centroid_row, 1e-10);
    // The reference may round up to a full turn.
    ASSERT_NEAR(std::remainder(segmenter.largest().centroid_column -
                                   region.centroid_column,
                               layout.wrap_columns ? layout.columns : 1e3),
                0, 1e-10);
    ASSERT_GE(segmenter.largest().centroid_column, 0);
    ASSERT_LT(segmenter.largest().centroid_column, layout.columns);
  }
}

TEST(SegmenterTest, AgreesWithOpenCvOnRandomFrames) {
  Random random(2);
  for (int i = 0; i < 30'000; ++i) {
    const auto [layout, taxels] = MakeRandomCase(random);
    Segmenter segmenter(layout);
    const int count = segmenter.Segment(taxels);
    const ReferenceSegmentation want = OpenCvSegmentation(layout, taxels);
    SCOPED_TRACE(absl::StrCat("frame ", i, ", ", Picture(layout, taxels)));
    ASSERT_TRUE(SamePartition(Labels(layout, segmenter), want.labels));
    if (count == 0) continue;
    const Region& region = segmenter.largest();
    int most = 0;
    for (const Region& r : want.regions) most = std::max(most, r.taxels);
    ASSERT_EQ(region.taxels, most);
    if (layout.wrap_columns) continue;
    const Region& same = want.regions[want.labels[region.first_taxel] - 1];
    ASSERT_EQ(region.taxels, same.taxels);
    ASSERT_NEAR(region.centroid_row, same.centroid_row, 1e-10);
    ASSERT_NEAR(region.centroid_column, same.centroid_column, 1e-10);
  }
}

// A block anywhere on the cylinder has its centre in its middle.
TEST(SegmenterTest, BlocksAnywhereOnACylinderAreCentred) {
  for (int columns = 2; columns <= 64; ++columns) {
    Segmenter segmenter(MakeLayout(2, columns, true));
    for (int width = 1; width < columns; ++width) {
      for (int begin = 0; begin < columns; ++begin) {
        std::vector<float> taxels(2 * columns);
        for (int i = 0; i < width; ++i) {
          taxels[(begin + i) % columns] = 1;
          taxels[columns + (begin + i) % columns] = 1;
        }
        ASSERT_EQ(segmenter.Segment(taxels), 1);
        ASSERT_EQ(segmenter.largest().taxels, 2 * width);
        ASSERT_EQ(segmenter.largest().centroid_row, 0.5);
        ASSERT_EQ(segmenter.largest().centroid_column,
                  std::fmod(begin + (width - 1) / 2.0, columns));
      }
    }
  }
}

TEST(SegmenterTest, CountsARegionAcrossTheSeamOnce) {
  const std::vector<float> taxels = Frame({"12....34",  //
                                           "........"});
  Segmenter flat(MakeLayout(2, 8, false));
  EXPECT_EQ(flat.Segment(taxels), 2);
  Segmenter round(MakeLayout(2, 8, true));
  EXPECT_EQ(round.Segment(taxels), 1);
  EXPECT_EQ(round.largest().taxels, 4);
  EXPECT_EQ(round.largest().max_value, 4);
  EXPECT_EQ(round.largest().total, 10);
  // Columns 6, 7, 8, 9.
  EXPECT_EQ(round.largest().centroid_column, 7.5);
}

TEST(SegmenterTest, DiagonalAcrossTheSeamNeedsEightNeighbours) {
  for (const auto& rows : {std::vector<std::string>{"1...", "...1"},
                           std::vector<std::string>{"...1", "1..."}}) {
    Segmenter eight(MakeLayout(2, 4, true));
    EXPECT_EQ(eight.Segment(Frame(rows)), 1);
    EXPECT_EQ(eight.largest().centroid_column, 3.5);
    Segmenter four(MakeLayout(2, 4, true, Connectivity::kFour));
    EXPECT_EQ(four.Segment(Frame(rows)), 2);
    Segmenter flat(MakeLayout(2, 4, false));
    EXPECT_EQ(flat.Segment(Frame(rows)), 2);
  }
}

TEST(SegmenterTest, RingIsCountedFromColumnZero) {
  Segmenter segmenter(MakeLayout(3, 5, true));
  EXPECT_EQ(segmenter.Segment(Frame({".....", "11111", "....."})), 1);
  EXPECT_EQ(segmenter.largest().centroid_column, 2);
  EXPECT_EQ(segmenter.largest().centroid_row, 1);
}

TEST(SegmenterTest, LargestBreaksTiesByValueThenPlace) {
  Segmenter segmenter(MakeLayout(3, 7, false));
  segmenter.Segment(Frame({"22...33", ".......", "33....."}));
  EXPECT_EQ(segmenter.largest().first_taxel, 5);
  segmenter.Segment(Frame({"22...33", ".......", ".444..."}));
  EXPECT_EQ(segmenter.largest().first_taxel, 15);
  segmenter.Segment(Frame({"22....9", ".......", "......."}));
  EXPECT_EQ(segmenter.largest().max_value, 2);
  EXPECT_EQ(segmenter.peak(), 9);
}

// From the distances between all pairs of taxels.
TEST(SegmenterTest, SpreadIsHalfTheMeanSquaredDistanceOfTwoPartsOfTheLoad) {
  Random random(6);
  for (int round = 0; round < 500; ++round) {
    const SkinLayout layout = MakeLayout(7, 9, /*wrap=*/false);
    std::vector<float> taxels(layout.taxels());
    for (float& taxel : taxels) {
      taxel =
          random.Index(3) == 0 ? 2 + static_cast<float>(random.Uniform()) : 0;
    }
    Segmenter segmenter(layout);
    if (segmenter.Segment(taxels) == 0) continue;
    const auto region = segmenter.LargestRows();
    const auto holds = [&](int taxel) {
      return (region[taxel / 9] >> (taxel % 9) & 1) != 0;
    };
    double load = 0, rows = 0, columns = 0;
    for (int a = 0; a < layout.taxels(); ++a) {
      if (!holds(a)) continue;
      load += taxels[a];
      for (int b = 0; b < layout.taxels(); ++b) {
        if (!holds(b)) continue;
        const double both = double{taxels[a]} * taxels[b] / 2;
        rows += both * std::pow(a / 9 - b / 9, 2);
        columns += both * std::pow(a % 9 - b % 9, 2);
      }
    }
    const LoadSpread spread = LargestSpread(segmenter, taxels);
    ASSERT_NEAR(spread.rows, rows / (load * load), 1e-5);
    ASSERT_NEAR(spread.columns, columns / (load * load), 1e-5);
  }
}

TEST(SegmenterTest, SpreadIsTheSameAcrossTheSeam) {
  const SkinLayout layout = MakeLayout(3, 8, /*wrap=*/true);
  Segmenter segmenter(layout);
  for (int turn = 0; turn < 8; ++turn) {
    std::vector<float> taxels(layout.taxels());
    const auto at = [&](int row, int column) -> float& {
      return taxels[row * 8 + (column + turn) % 8];
    };
    at(0, 0) = 3;
    at(0, 1) = 1;
    at(1, 1) = 4;
    ASSERT_EQ(segmenter.Segment(taxels), 1);
    const LoadSpread spread = LargestSpread(segmenter, taxels);
    EXPECT_NEAR(spread.rows, 0.25, 1e-7) << turn;
    EXPECT_NEAR(spread.columns, 3.0 / 8 * 5 / 8, 1e-7) << turn;
  }
  EXPECT_EQ(segmenter.Segment(std::vector<float>(24)), 0);
  EXPECT_EQ(LargestSpread(segmenter, std::vector<float>(24)), LoadSpread());
}

TEST(SegmenterTest, CheckerboardIsOneRegionByEightAndManyByFour) {
  std::vector<float> taxels(64 * 64);
  for (int i = 0; i < 64 * 64; ++i) {
    taxels[i] = static_cast<float>((i / 64 + i) % 2);
  }
  Segmenter eight(MakeLayout(64, 64, true));
  EXPECT_EQ(eight.Segment(taxels), 1);
  EXPECT_EQ(eight.largest().taxels, 2048);
  const SkinLayout layout = MakeLayout(64, 64, true, Connectivity::kFour);
  Segmenter four(layout);
  EXPECT_EQ(four.Segment(taxels), 2048);
  EXPECT_EQ(Labels(layout, four).back(), 2048 * (taxels.back() > 0));
}

TEST(SegmenterTest, EverySingleTaxelAndTheFullSkinAreFound) {
  Segmenter segmenter(MakeLayout(64, 64, true));
  std::vector<float> taxels(64 * 64);
  for (int i = 0; i < 64 * 64; ++i) {
    taxels[i] = 2;
    ASSERT_EQ(segmenter.Segment(taxels), 1);
    ASSERT_EQ(segmenter.largest().first_taxel, i);
    ASSERT_EQ(segmenter.largest().centroid_row, i / 64);
    ASSERT_EQ(segmenter.largest().centroid_column, i % 64);
    taxels[i] = 0;
  }
  EXPECT_EQ(segmenter.Segment(taxels), 0);
  EXPECT_EQ(segmenter.largest().taxels, 0);
  std::fill(taxels.begin(), taxels.end(), 1.0F);
  EXPECT_EQ(segmenter.Segment(taxels), 1);
  EXPECT_EQ(segmenter.largest().taxels, 64 * 64);
  EXPECT_EQ(segmenter.largest().centroid_column, 31.5);
}

TEST(SegmenterTest, MaskedTaxelsSplitRegionsAndCountForNothing) {
  SkinLayout layout = MakeLayout(1, 5, false);
  layout.mask = {1, 1, 0, 1, 1};
  Segmenter segmenter(layout);
  EXPECT_EQ(segmenter.Segment(Frame({"11911"})), 2);
  EXPECT_EQ(segmenter.largest().taxels, 2);
  EXPECT_EQ(segmenter.peak(), 1);
}

TEST(SegmenterTest, ThresholdIsMetByTheFloatNearestToIt) {
  SkinLayout layout = MakeLayout(1, 3, false);
  // 0.01F is below 0.01.
  layout.contact_threshold = 0.01;
  Segmenter segmenter(layout);
  EXPECT_EQ(segmenter.Segment(std::vector<float>{
                0.01F, std::nextafterf(0.01F, 0), 10 * 0.001F}),
            2);
  // A threshold that rounds to zero still leaves empty taxels untouched.
  layout.contact_threshold = 1e-300;
  Segmenter tiny(layout);
  EXPECT_EQ(tiny.Segment(std::vector<float>{0, 0, 1e-30F}), 1);
  layout.contact_threshold = 1e300;
  Segmenter huge(layout);
  EXPECT_EQ(huge.Segment(std::vector<float>{1e12F, 0, 0}), 0);
}

TEST(SegmenterTest, NanIsNotTouched) {
  Segmenter segmenter(MakeLayout(1, 3, false));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(segmenter.Segment(std::vector<float>{2, nan, 2}), 2);
}

// One frame of the paper's own forearm skin: a 4 x 2 contact.
TEST(SegmenterTest, FindsTheContactInARealForearmFrame) {
  const std::string path = SharedDataPath("meka_forearm/forearm_taxels.csv");
  std::ifstream file(path);
  if (!file) {
    std::cout << path << " is absent; nothing to check\n";
    return;
  }
  SkinLayout layout = *LayoutPreset("cody-forearm");
  std::vector<float> taxels;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    // force_mag is the last column.
    taxels.push_back(std::stof(line.substr(line.rfind(',') + 1)));
  }
  ASSERT_EQ(taxels.size(), 384U);
  EXPECT_EQ(std::count_if(taxels.begin(), taxels.end(),
                          [](float taxel) { return taxel > 0; }),
            12);
  // The paper's threshold for the covered skin, above the noise of 0.1.
  layout.contact_threshold = 0.1;
  layout.onset_threshold = 0.1;
  Segmenter segmenter(layout);
  EXPECT_EQ(segmenter.Segment(taxels), 1);
  const Region& region = segmenter.largest();
  EXPECT_EQ(region.taxels, 8);
  EXPECT_NEAR(region.max_value, 1.53343, 1e-5);
  EXPECT_EQ(region.centroid_row, 7.5);
  EXPECT_EQ(region.centroid_column, 9.5);
}

}  // namespace
}  // namespace tactus::internal
