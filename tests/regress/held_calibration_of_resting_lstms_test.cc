// A held calibration was read at the steps of the LSTMs only if they were
// taken. A rule that leaves out steps of the LSTMs, and should change no bit,
// changed the probabilities of the HMMs.
#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "core/base/random.h"
#include "core/classify/contact_classifier.h"
#include "gtest/gtest.h"
#include "tests/support/small_model.h"

namespace tactus::internal {
namespace {

std::shared_ptr<const CompiledModel> HeldModel() {
  Model model = testing::SmallModel();
  testing::AddLstms(1, model);
  model.inputs.hmm_steps = {2, 5};
  model.inputs.lstm_steps = {3, 10};
  model.calibration.held = true;
  return *CompiledModel::Create(model);
}

// Steps both on the same 300 random frames and expects the same HMM answers.
void ExpectSameHmms(ContactClassifier one, ContactClassifier other) {
  Random random(2);
  for (int t = 0; t < 300; ++t) {
    const double force = random.Uniform(1, 3);
    for (ContactClassifier* c : {&one, &other}) {
      c->Step({{force, 1e-3, 0.01}, force}, 0);
    }
    ASSERT_TRUE(
        std::ranges::equal(one.hmm_probability(), other.hmm_probability()))
        << t;
    ASSERT_EQ(one.unknown(), other.unknown()) << t;
  }
}

TEST(HeldCalibrationOfRestingLstmsTest, LstmsThatNobodyAskedFor) {
  const auto model = HeldModel();
  ContactClassifier::Options hmms;
  hmms.scorers = Scorers::kHmms;
  SkipRules step_anyway;
  step_anyway[SkipRule::kUnusedLstms] = false;
  ExpectSameHmms(ContactClassifier(model, hmms),
                 ContactClassifier(model, hmms, step_anyway));
  ExpectSameHmms(ContactClassifier(model, hmms), ContactClassifier(model, {}));
}

}  // namespace
}  // namespace tactus::internal
