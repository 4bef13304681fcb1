// A fit of signals without noise failed with "scaling of HMM input log_spring
// is 4.60517, 1.38762e+15": the cue was constant but for the rounding of its
// means, and its gain was the inverse of that.
#include "core/train/fit.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

// Force and motion are in proportion in all contacts, so springs are constant.
TEST(CueThatOnlyRoundingVariesTest, IsNotScaledUp) {
  std::vector<LabelledContact> contacts;
  for (int i = 0; i < 16; ++i) {
    LabelledContact& contact = contacts.emplace_back();
    contact.id = std::to_string(i);
    contact.label = i % 2 == 0 ? "HU" : "SU";
    contact.condition = i < 8 ? "slow" : "fast";
    const double level = 1 + 0.3 * (i % 2);
    for (int t = 0; t < 40; ++t) {
      contact.frames.push_back({IdealSample({level, 1e-4, 0.01 * level})});
    }
  }
  std::vector<const LabelledContact*> pointers;
  for (const LabelledContact& contact : contacts) pointers.push_back(&contact);
  FitOptions options = *FitPreset("tuned");
  options.states = 2;
  options.hmms_per_class = 1;
  options.max_iterations = 2;
  options.lstm.cells = {3};
  options.lstm.training.epochs = 1;
  const auto model = FitModel(pointers, options, RunSerially);
  ASSERT_TRUE(model.ok()) << model.status();
  for (const ModelInput& input : model->inputs.hmm) {
    EXPECT_LT(input.gain, 1e9) << CueName(input.cue);
  }
}

}  // namespace
}  // namespace tactus::internal
