#include "core/contacts/touch_contacts.h"

#include <algorithm>
#include <map>

#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/classify/contact_pipeline.h"
#include "core/contacts/anytime.h"
#include "core/sim/experiments/random_scene.h"
#include "gtest/gtest.h"
#include "tests/support/flat_layout.h"
#include "tests/support/small_model.h"

namespace tactus::internal {
namespace {

constexpr ExtractContactsOptions kAsAServer = {
    .max_contacts = limits::kMaxContacts, .whole_skin = false};

// Squares of 2 x 2 taxels on a skin of 20 x 30 taxels, at 100 Hz.
class Recording {
 public:
  explicit Recording(size_t frames) {
    SetSkin(testing::FlatLayout(20, 30), trial_);
    trial_.id = "000007";
    trial_.condition = "slow";
    trial_.taxels.rows = 20;
    trial_.taxels.columns = 30;
    trial_.taxels.f32.resize(frames * 600);
    for (size_t t = 0; t < frames; ++t) {
      trial_.time.push_back(0.01 * static_cast<double>(t));
    }
  }

  void Press(size_t begin, size_t end, int row, int column) {
    for (size_t t = begin; t < end; ++t) {
      for (const int i : {0, 1, 30, 31}) {
        trial_.taxels.f32[t * 600 + row * 30 + column + i] = 5;
      }
    }
  }

  void Expect(size_t begin, size_t end, const std::string& label, int row,
              int column) {
    Touch& touch = trial_.touches.emplace_back();
    touch.begin_s = trial_.time[begin];
    touch.end_s = trial_.time[end - 1];
    touch.label = label;
    touch.centre = {row + 0.5, column + 0.5};
  }

  TouchContacts Found() const {
    auto found = ExtractContacts(trial_, kAsAServer);
    EXPECT_TRUE(found.ok()) << found.status();
    return *std::move(found);
  }

  Trial& trial() { return trial_; }

 private:
  Trial trial_;
};

// The first contact of this touch.
const LabelledContact& ContactAt(size_t touch, const TouchContacts& found) {
  const auto at =
      std::ranges::find(found.contacts, touch, &LabelledContact::touch);
  EXPECT_NE(at, found.contacts.end());
  return *at;
}

TEST(ExtractContactsTest, EachTouchHasItsContact) {
  Recording recording(300);
  for (const size_t begin : {20, 150}) {
    const int column = begin == 20 ? 3 : 12;
    recording.Press(begin, begin + 80, 5, column);
    recording.Expect(begin, begin + 80, begin == 20 ? "HU" : "SM", 5, column);
  }
  std::vector<double>& motion = recording.trial().touches[1].object_motion;
  for (int t = 0; t < 80; ++t) motion.push_back(0.001 * t);
  const TouchContacts found = recording.Found();
  EXPECT_EQ(found.counts.touches, 2u);
  EXPECT_EQ(found.counts.found, 2u);
  EXPECT_EQ(found.counts.broken + found.counts.merged + found.counts.switched +
                found.counts.spurious,
            0u);
  ASSERT_EQ(found.contacts.size(), 2u);
  const LabelledContact& second = ContactAt(1, found);
  EXPECT_EQ(ContactName(second), "000007/01");
  EXPECT_EQ(second.label, "SM");
  EXPECT_EQ(second.condition, "slow");
  // From the touch to the release, 0.25 s after it.
  ASSERT_EQ(second.frames.size(), 80u + 24u);
  EXPECT_TRUE(second.frames.touched(79));
  EXPECT_FALSE(second.frames.touched(80));
  ASSERT_EQ(second.object_motion.size(), second.frames.size());
  EXPECT_DOUBLE_EQ(second.object_motion[10], 0.01);
  // After its touch the object rests.
  EXPECT_DOUBLE_EQ(second.object_motion.back(), 0.079);
  EXPECT_EQ(ContactAt(0, found).label, "HU");
  EXPECT_TRUE(ContactAt(0, found).object_motion.empty());
}

TEST(ExtractContactsTest, ATouchWithALongLossIsBroken) {
  Recording recording(300);
  recording.Press(20, 80, 5, 3);
  recording.Press(120, 200, 5, 3);
  recording.Expect(20, 200, "HU", 5, 3);
  const TouchContacts found = recording.Found();
  EXPECT_EQ(found.counts.found, 1u);
  EXPECT_EQ(found.counts.broken, 1u);
  EXPECT_EQ(found.contacts.size(), 2u);
}

TEST(ExtractContactsTest, ATouchThatFollowsTooSoonIsMerged) {
  Recording recording(300);
  recording.Press(20, 80, 5, 3);
  recording.Press(90, 200, 5, 3);
  recording.Expect(20, 80, "HU", 5, 3);
  recording.Expect(90, 200, "SU", 5, 3);
  const TouchContacts found = recording.Found();
  EXPECT_EQ(found.counts.found, 1u);
  EXPECT_EQ(found.counts.merged, 1u);
  ASSERT_EQ(found.contacts.size(), 1u);
  // It was at the second one for longer.
  EXPECT_EQ(found.contacts[0].label, "SU");
}

TEST(ExtractContactsTest, ATouchThatNothingFeelsIsNeitherFoundNorMerged) {
  Recording recording(300);
  recording.Press(20, 80, 5, 3);
  recording.Expect(20, 80, "HU", 5, 3);
  recording.Expect(100, 200, "SU", 5, 20);
  // Where nothing touches, at a time when nothing does.
  recording.Press(250, 290, 15, 20);
  const TouchContacts found = recording.Found();
  EXPECT_EQ(found.counts.touches, 2u);
  EXPECT_EQ(found.counts.found, 1u);
  EXPECT_EQ(found.counts.merged, 0u);
  EXPECT_EQ(found.counts.spurious, 1u);
  EXPECT_EQ(found.contacts.size(), 1u);
}

TEST(ExtractContactsTest, AContactThatWandersToAnotherTouchHasSwitched) {
  Recording recording(300);
  recording.Expect(20, 200, "HU", 5, 3);
  recording.Expect(21, 200, "SU", 5, 23);
  recording.Press(20, 60, 5, 3);
  for (int column = 3; column < 23; ++column) {
    const size_t at = 60 + 3 * (column - 3);
    recording.Press(at, at + 3, 5, column);
  }
  recording.Press(120, 200, 5, 23);
  const TouchContacts found = recording.Found();
  EXPECT_EQ(found.counts.switched, 1u);
}

TEST(ExtractContactsTest, NamesWhatATrialLacks) {
  Recording recording(30);
  const auto without_touches = ExtractContacts(recording.trial(), kAsAServer);
  EXPECT_EQ(ReasonOf(without_touches.status()), "INVALID_TRAINING_DATA");
  recording.Expect(2, 20, "HU", 5, 3);
  recording.trial().taxels = {};
  const auto without_taxels = ExtractContacts(recording.trial(), kAsAServer);
  EXPECT_EQ(ReasonOf(without_taxels.status()), "INVALID_TRAINING_DATA");
}

// What is evaluated is what a server answers, bit for bit.
TEST(ExtractContactsTest, AnswersEqualThoseOfThePipeline) {
  const SkinModel skin = *SkinModelNamed("good");
  int compared = 0;
  for (uint64_t n = 0; n < 12; ++n) {
    const SceneOptions scene = n % 2 == 0
                                   ? SceneOptions{.touches = 2, .touch_s = 1}
                                   : SceneOptions{.touch_s = 1, .objects = 3};
    const auto trial = SceneTrial(skin, scene, 3, n);
    ASSERT_TRUE(trial.ok()) << trial.status();
    const auto model = CompiledModel::Create(testing::SmallModel());
    ASSERT_TRUE(model.ok()) << model.status();
    auto pipeline = ContactPipeline::Create(skin.layout, *model, {});
    ASSERT_TRUE(pipeline.ok()) << pipeline.status();
    std::map<uint64_t, std::vector<double>> last;
    std::vector<float> taxels(skin.layout.taxels());
    for (size_t t = 0; t < trial->taxels.frames(); ++t) {
      trial->taxels.Decode(t, taxels.data());
      for (const ContactReport& report :
           (*pipeline)->Step({.taxels = taxels, .pose = &trial->poses[t]})) {
        if (report.released()) continue;
        const auto probability = report.classifier->probability();
        last[report.id].assign(probability.begin(), probability.end());
      }
    }
    const auto found = ExtractContacts(
        *trial, {.release_after_s = (*model)->model().release_after_s,
                 .max_contacts = limits::kMaxContacts,
                 .whole_skin = false});
    ASSERT_TRUE(found.ok()) << found.status();
    ASSERT_EQ(found->contacts.size() + found->counts.spurious, last.size());
    if (found->counts.spurious > 0) continue;
    auto served = last.begin();
    for (const LabelledContact& contact : found->contacts) {
      ContactClassifier classifier(*model, {});
      WalkFrames(contact, classifier, [](size_t) {});
      EXPECT_TRUE(std::ranges::equal(classifier.probability(), served->second))
          << n << " contact " << served->first;
      ++served;
      ++compared;
    }
  }
  EXPECT_GT(compared, 15);
}

}  // namespace
}  // namespace tactus::internal
