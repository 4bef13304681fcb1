#include "core/inputs/inputs.h"

#include <algorithm>
#include <cmath>

#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

// Force rises by 1 a frame from `first`.
LabelledContact Ramp(double first, int frames) {
  LabelledContact contact;
  for (int t = 0; t < frames; ++t) {
    contact.frames.push_back({IdealSample({first + t, 0, 0})});
  }
  return contact;
}

VariedContacts Only(const LabelledContact& contact) {
  return VariedContacts({&contact});
}

constexpr Cue kForceCue[] = {Cue::kForce};

TEST(FitInputsTest, ScalesToZeroMeanAndUnitDeviationOrToZeroAndOne) {
  const LabelledContact contact =
      Ramp(3, 9);  // 3 .. 11: mean 7, variance 60 / 9
  const auto standard = FitInputs(Only(contact), kForceCue, {});
  EXPECT_DOUBLE_EQ(standard[0].offset, 7);
  EXPECT_DOUBLE_EQ(standard[0].gain, 1 / std::sqrt(60.0 / 9));
  const auto span =
      FitInputs(Only(contact), kForceCue, {.scaling = Scaling::kMinMax});
  const auto rows = MakeSequence(contact, span, {});
  EXPECT_DOUBLE_EQ(rows.front(), 0);
  EXPECT_DOUBLE_EQ(rows.back(), 1);
}

// The four stretches of a cue, without the cue itself.
std::vector<ModelInput> StretchesOf(const LabelledContact& contact, Cue cue) {
  return FitInputs(Only(contact), {},
                   {.stretched_cues = {cue}, .stretches = 4});
}

TEST(FitStretchesTest, EachRisesOverItsOwnPartAndRestsElsewhere) {
  const LabelledContact contact = Ramp(0, 101);
  const auto stretches = StretchesOf(contact, Cue::kForce);
  ASSERT_EQ(stretches.size(), 4u);
  const auto rows = MakeSequence(contact, stretches, {});
  for (int t = 0; t <= 100; ++t) {
    for (int n = 0; n < 4; ++n) {
      const double want = std::clamp((t - 25.0 * n) / 12.5 - 1, -1.0, 1.0);
      EXPECT_NEAR(rows[4 * t + n], want, 1e-12) << t << " " << n;
    }
  }
}

TEST(FitStretchesTest, ACueThatNeverChangesHasNone) {
  const LabelledContact contact = Ramp(0, 30);
  EXPECT_TRUE(StretchesOf(contact, Cue::kArea).empty());
}

TEST(WalkCuesTest, VisitsTouchedFramesThatAreDue) {
  LabelledContact contact = Ramp(1, 60);
  contact.frames.Set(9, {contact.frames[9].sample, false});
  std::vector<size_t> visited;
  WalkCues(contact, {5, 20}, kAllCueGroups, nullptr,
           [&](CueTracker&, size_t frame) { visited.push_back(frame + 1); });
  EXPECT_EQ(visited,
            (std::vector<size_t>{5, 11, 16, 21, 26, 31, 36, 41, 46, 51, 56}));
}

}  // namespace
}  // namespace tactus::internal
