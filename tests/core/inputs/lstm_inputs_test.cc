#include "core/inputs/lstm_inputs.h"

#include <algorithm>

#include "core/inputs/inputs.h"
#include "gtest/gtest.h"
#include "tests/core/eval/synthetic_contacts.h"

namespace tactus::internal {
namespace {

class LstmInputsTest : public ::testing::Test {
 protected:
  LstmInputsTest() {
    contacts_ = testing::SyntheticContacts(3, 12, 0.1, 1);
    for (size_t i = 0; i < contacts_.size(); ++i) {
      contacts_[i].stiffness = contacts_[i].label[0] == 'H' ? 1e6 : 1e3;
      contacts_[i].object_motion.assign(12, 1e-4 * static_cast<double>(i));
    }
    // At most paces, copies of this one are too short for a step.
    while (contacts_[5].frames.size() > 5) Shorten(contacts_[5]);
    varied_.emplace(testing::PointersTo(contacts_),
                    VariationRange{.copies = 4, .pace = 3, .load = 2}, 1);
    spec_.lstm_steps = {4, 8};
    const Cue cues[] = {NamedCue("log_force"), Cue::kMotion};
    spec_.lstm = FitInputs(*varied_, cues, {.steps = spec_.lstm_steps});
  }

  static void Shorten(LabelledContact& contact) {
    ContactFrames frames;
    for (size_t t = 0; t + 1 < contact.frames.size(); ++t) {
      frames.push_back(contact.frames[t]);
    }
    contact.frames = frames;
    contact.object_motion.pop_back();
  }

  std::vector<LabelledContact> contacts_;
  std::optional<VariedContacts> varied_;
  const std::vector<std::string> names_ = {"HU", "HM", "SU", "SM"};
  InputSpec spec_;
};

TEST_F(LstmInputsTest, MadeForEachBatchTheyAreThoseThatAreKept) {
  const LstmInputs kept(*varied_, names_, spec_,
                        {.keep = true, .with_targets = true});
  const LstmInputs made(*varied_, names_, spec_,
                        {.keep = false, .with_targets = true});
  for (const bool with_targets : {false, true}) {
    const auto a = kept.Source(with_targets);
    const auto b = made.Source(with_targets);
    ASSERT_EQ(a->size(), b->size());
    // Some copies, but not all, are left out.
    EXPECT_LT(a->size(), varied_->size());
    EXPECT_GT(a->size(), contacts_.size());
    std::vector<LstmSequence> of_a, of_b;
    for (size_t i = 0; i + 1 < a->size(); ++i) {
      const size_t numbers[] = {a->size() - 1 - i, i};
      a->Get(numbers, of_a);
      b->Get(numbers, of_b);
      ASSERT_EQ(of_a.size(), 2u);
      ASSERT_EQ(of_b.size(), 2u);
      for (int k = 0; k < 2; ++k) {
        EXPECT_FALSE(of_a[k].inputs.empty());
        EXPECT_TRUE(std::ranges::equal(of_a[k].inputs, of_b[k].inputs));
        EXPECT_TRUE(std::ranges::equal(of_a[k].targets, of_b[k].targets));
        EXPECT_EQ(of_a[k].targets.size(),
                  with_targets ? of_a[k].inputs.size() : 0);
        EXPECT_EQ(of_a[k].label, of_b[k].label);
      }
    }
  }
}

TEST_F(LstmInputsTest, TheBytesAreAtMostThoseStated) {
  const LstmInputs kept(*varied_, names_, spec_, {});
  const auto source = kept.Source(false);
  std::vector<LstmSequence> one;
  size_t bytes = 0;
  for (size_t i = 0; i < source->size(); ++i) {
    source->Get({&i, 1}, one);
    bytes += one[0].inputs.size_bytes();
  }
  const size_t stated =
      LstmInputs::KeptBytes(*varied_, spec_.lstm.size(), spec_.lstm_steps);
  EXPECT_LE(bytes, stated);
  EXPECT_GT(bytes, stated / 2);
}

}  // namespace
}  // namespace tactus::internal
