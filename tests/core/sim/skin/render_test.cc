#include "core/sim/skin/render.h"

#include <algorithm>
#include <cmath>

#include "core/base/errors.h"
#include "core/sim/exact/simulate_contact.h"
#include "core/sim/experiments/paper_set.h"
#include "gtest/gtest.h"
#include "tests/support/find_material.h"

namespace tactus {
namespace {

const SimulatedContact& RubberCube() {
  static const SimulatedContact contact = [] {
    TrialSpec spec;
    spec.object = {*FindMaterial("neoprene-rubber"), 0.0311, Surface::kWood};
    spec.fixed = true;
    spec.number = 12;
    return *SimulateContact(spec);
  }();
  return contact;
}

SkinLayout Cody() { return *LayoutPreset("cody-forearm"); }

RenderOptions Noiseless() {
  RenderOptions options;
  options.taxel_noise = 0;
  options.encoder_noise_m = 0;
  // Fine steps that still reach 2 N on one taxel.
  options.taxel_step = 1e-4;
  return options;
}

double FrameSum(const Trial& trial, size_t frame) {
  const size_t taxels = trial.taxels.rows * trial.taxels.columns;
  double sum = 0;
  for (size_t i = 0; i < taxels; ++i) {
    sum += trial.taxels.u16[frame * taxels + i] * trial.taxels.scale;
  }
  return sum;
}

TEST(TaxelTrialTest, TaxelForcesSumToTheSurfaceForce) {
  const auto trial = TaxelTrial(RubberCube(), Cody(), Noiseless(), 1);
  ASSERT_TRUE(trial.ok()) << trial.status();
  for (size_t i = 0; i < 500; ++i) {
    // Rounding: half a step on each of the taxels touched.
    EXPECT_NEAR(FrameSum(*trial, 10 + i), RubberCube().signals.samples[i][0],
                25 * 0.5e-4)
        << i;
  }
}

TEST(TaxelTrialTest, PatchHasTheModelsAreaAndPlace) {
  RenderOptions options = Noiseless();
  options.centre = SkinPoint{6.25, 23.75};
  const SkinLayout layout = Cody();
  const auto trial = TaxelTrial(RubberCube(), layout, options, 1);
  ASSERT_TRUE(trial.ok()) << trial.status();
  const size_t last = trial->time.size() - 1;
  double row_moment = 0;
  double column_moment = 0;
  double total = 0;
  int touched = 0;
  for (int row = 0; row < layout.rows; ++row) {
    for (int column = 0; column < layout.columns; ++column) {
      const double value =
          trial->taxels.u16[last * 384 + row * layout.columns + column];
      // Columns beyond half way round are left of the patch.
      const double unwrapped = column < 12 ? column + 24 : column;
      touched += value > 0;
      total += value;
      row_moment += value * row;
      column_moment += value * unwrapped;
    }
  }
  EXPECT_NEAR(row_moment / total, 6.25, 0.1);
  EXPECT_NEAR(column_moment / total, 23.75, 0.1);
  // A side of at least 31.1 mm on pitches of 10.8 and 12.05 mm.
  const double side = std::sqrt(RubberCube().signals.samples.back()[1]);
  EXPECT_GE(side, 0.0311);
  EXPECT_GE(touched, 3 * 3);
  EXPECT_LE(touched, 4 * 4);
}

TEST(TaxelTrialTest, FramesBeforeTheTouchHoldNoiseOnly) {
  const auto trial = TaxelTrial(RubberCube(), Cody(), RenderOptions(), 1);
  ASSERT_TRUE(trial.ok());
  ASSERT_EQ(trial->time.size(), 510);
  ASSERT_EQ(trial->poses.size(), 510);
  ASSERT_EQ(trial->taxels.u16.size(), 510 * 384);
  EXPECT_EQ(trial->time[0], 0);
  EXPECT_NEAR(trial->time[509], 5.09, 1e-12);
  // 3840 readings of 2 mN noise stay under the contact threshold of 10 mN.
  EXPECT_LT(*std::max_element(trial->taxels.u16.begin(),
                              trial->taxels.u16.begin() + 10 * 384),
            10);
  EXPECT_LT(trial->poses[9].position.norm(), 0.00025);
  EXPECT_GT(FrameSum(*trial, 40), 1);
}

TEST(TaxelTrialTest, NoiseHasTheSizeAskedFor) {
  RenderOptions options;
  options.taxel_noise = 0.1;
  options.encoder_noise_m = 0.001;
  options.lead_in_frames = 100;
  const auto trial = TaxelTrial(RubberCube(), Cody(), options, 1);
  ASSERT_TRUE(trial.ok());
  // Half of a Gaussian is clamped at 0: mean square s^2 / 2.
  double taxels = 0;
  double encoder = 0;
  for (int i = 0; i < 100 * 384; ++i) {
    taxels += std::pow(trial->taxels.u16[i] * 0.001, 2) / (100 * 384);
  }
  for (int i = 0; i < 100; ++i) {
    encoder += trial->poses[i].position.squaredNorm() / 100;
  }
  EXPECT_NEAR(std::sqrt(2 * taxels), 0.1, 0.002);
  EXPECT_NEAR(std::sqrt(encoder), 0.001, 0.0003);
}

TEST(TaxelTrialTest, ReadingsAreRoundedToSteps) {
  RenderOptions fine = Noiseless();
  fine.centre = SkinPoint{8, 4};
  RenderOptions coarse = fine;
  coarse.taxel_step = 0.1;
  const auto a = TaxelTrial(RubberCube(), Cody(), fine, 1);
  const auto b = TaxelTrial(RubberCube(), Cody(), coarse, 1);
  ASSERT_TRUE(a.ok() && b.ok());
  EXPECT_EQ(b->taxels.scale, 0.1);
  for (size_t i = 0; i < a->taxels.u16.size(); ++i) {
    ASSERT_NEAR(b->taxels.u16[i] * 0.1, a->taxels.u16[i] * 1e-4,
                0.05 + 0.5e-4 + 1e-9);
  }
}

TEST(TaxelTrialTest, ReadingsSaturateAtTheLargestStep) {
  RenderOptions options = Noiseless();
  options.taxel_step = 1e-6;
  options.centre = SkinPoint{8, 4};
  const auto trial = TaxelTrial(RubberCube(), Cody(), options, 1);
  ASSERT_TRUE(trial.ok());
  EXPECT_EQ(trial->taxels.u16[(509 * 16 + 8) * 24 + 4], 65535);
}

TEST(TaxelTrialTest, DeadTaxelsReadZeroAndChangeNoOther) {
  RenderOptions options;
  options.centre = SkinPoint{8, 4};
  const auto whole = TaxelTrial(RubberCube(), Cody(), options, 1);
  options.dead_taxels = {8 * 24 + 4};
  options.dead_count = 20;
  options.dead_seed = 5;
  const auto holed = TaxelTrial(RubberCube(), Cody(), options, 1);
  ASSERT_TRUE(whole.ok() && holed.ok());
  int dead = 0;
  for (int taxel = 0; taxel < 384; ++taxel) {
    bool zero = true;
    for (int frame = 0; frame < 510; ++frame) {
      const int i = frame * 384 + taxel;
      zero &= holed->taxels.u16[i] == 0;
      if (holed->taxels.u16[i] != 0) {
        ASSERT_EQ(holed->taxels.u16[i], whole->taxels.u16[i]);
      }
    }
    dead += zero;
    EXPECT_TRUE(zero || taxel != 8 * 24 + 4);
  }
  EXPECT_GE(dead, 20);
  EXPECT_LE(dead, 21);
}

TEST(TaxelTrialTest, TheLinkMovesAlongTheNormalAtThePatch) {
  RenderOptions options = Noiseless();
  options.centre = SkinPoint{8, 6};
  const auto trial = TaxelTrial(RubberCube(), Cody(), options, 1);
  ASSERT_TRUE(trial.ok());
  const double motion = RubberCube().signals.samples.back()[2];
  ASSERT_GT(motion, 0);
  // Column 6 of 24 looks along +y.
  EXPECT_NEAR(
      (trial->poses.back().position - Eigen::Vector3d(0, motion, 0)).norm(), 0,
      1e-12);
  EXPECT_EQ(trial->poses.back().orientation.w(), 1);
}

TEST(TaxelTrialTest, WorksOnAFlatLayoutOfCounts) {
  const SkinLayout layout = *LayoutPreset("vitac-12x32");
  RenderOptions options;
  options.unit_per_newton = 1000;
  options.taxel_noise = 2;
  options.taxel_step = 1;
  const auto trial = TaxelTrial(RubberCube(), layout, options, 1);
  ASSERT_TRUE(trial.ok()) << trial.status();
  EXPECT_EQ(trial->layout, "vitac-12x32");
  EXPECT_EQ(trial->unit, "counts");
  EXPECT_TRUE(Detectable(*trial, layout));
  EXPECT_NEAR(trial->poses.back().position.z(),
              RubberCube().signals.samples.back()[2], 0.0003);
}

TEST(TaxelTrialTest, SameSeedSameBitsOtherSeedOtherPlaceAndNoise) {
  const auto a = TaxelTrial(RubberCube(), Cody(), RenderOptions(), 7);
  const auto b = TaxelTrial(RubberCube(), Cody(), RenderOptions(), 7);
  const auto c = TaxelTrial(RubberCube(), Cody(), RenderOptions(), 8);
  ASSERT_TRUE(a.ok() && b.ok() && c.ok());
  EXPECT_EQ(a->taxels.u16, b->taxels.u16);
  EXPECT_EQ(a->poses.back().position, b->poses.back().position);
  EXPECT_NE(a->taxels.u16, c->taxels.u16);
  EXPECT_NE(a->poses.back().position, c->poses.back().position);
}

TEST(TaxelTrialTest, EachBadOptionIsNamed) {
  struct Case {
    const char* field;
    void (*spoil)(RenderOptions&);
  };
  const Case cases[] = {
      {"render.centre.row",
       [](RenderOptions& o) {
         o.centre = SkinPoint{16, 0};
       }},
      {"render.centre.column",
       [](RenderOptions& o) {
         o.centre = SkinPoint{0, -1};
       }},
      {"render.unit_per_newton",
       [](RenderOptions& o) { o.unit_per_newton = 0; }},
      {"render.taxel_noise", [](RenderOptions& o) { o.taxel_noise = -1; }},
      {"render.taxel_step", [](RenderOptions& o) { o.taxel_step = 0; }},
      {"render.dead_taxels", [](RenderOptions& o) { o.dead_taxels = {384}; }},
      {"render.dead_count", [](RenderOptions& o) { o.dead_count = 385; }},
      {"render.encoder_noise_m",
       [](RenderOptions& o) { o.encoder_noise_m = std::nan(""); }},
      {"render.lead_in_frames",
       [](RenderOptions& o) { o.lead_in_frames = -1; }},
  };
  for (const Case& c : cases) {
    RenderOptions options;
    c.spoil(options);
    const auto trial = TaxelTrial(RubberCube(), Cody(), options, 1);
    EXPECT_EQ(ReasonOf(trial.status()), "INVALID_SCENE") << c.field;
    EXPECT_EQ(InfoOf(trial.status()).metadata().at("field"), c.field);
  }
}

TEST(DetectableTest, AFeatherIsNotFeltAndMasksCount) {
  TrialSpec spec;
  spec.object = {*FindMaterial("light-foam"), 0.01, Surface::kWood};
  const auto feather = SimulateContact(spec);
  ASSERT_TRUE(feather.ok());
  const auto unfelt = TaxelTrial(*feather, Cody(), RenderOptions(), 1);
  ASSERT_TRUE(unfelt.ok());
  EXPECT_FALSE(Detectable(*unfelt, Cody()));
  const auto felt = TaxelTrial(RubberCube(), Cody(), RenderOptions(), 1);
  ASSERT_TRUE(felt.ok());
  EXPECT_TRUE(Detectable(*felt, Cody()));
  SkinLayout masked = Cody();
  masked.mask.assign(384, 0);
  EXPECT_FALSE(Detectable(*felt, masked));
}

// Demonstrations need contacts of all classes from robots never trained on.
TEST(UnseenRobotTest, GivesDetectableContactsOfAllClasses) {
  std::vector<TrialSpec> specs;
  for (const TrialSpec& spec : TrialSpecs({{900, 0.012, kPaperGoal}})) {
    if (spec.number % 14 == 0) specs.push_back(spec);
  }
  std::vector<std::string> labels;
  for (const TrialSpec& spec : specs) {
    const auto contacts = SimulateWithTwin(spec);
    ASSERT_TRUE(contacts.ok()) << contacts.status();
    for (const SimulatedContact& contact : *contacts) {
      const auto trial = TaxelTrial(contact, Cody(), RenderOptions(), 1);
      ASSERT_TRUE(trial.ok()) << trial.status();
      EXPECT_EQ(trial->condition, "k900-v0.012");
      if (Detectable(*trial, Cody())) labels.push_back(trial->label);
    }
  }
  for (const char* label : {"HU", "HM", "SU", "SM"}) {
    EXPECT_GE(std::count(labels.begin(), labels.end(), label), 2) << label;
  }
}

}  // namespace
}  // namespace tactus
