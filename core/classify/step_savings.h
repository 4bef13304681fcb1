// File: step_savings.h
//
// StepSavings: leaves out steps of the LSTMs that would probably not change the
// answer. Unlike the rules of skip_rules.h this changes answers: a network that
// missed a step has another state, and `unknown` uses the object's estimate of
// the last step taken. No looks are taken either (contact_classifier.h).
// docs/skipping.md states what each setting costs and saves.
//
//   ContactClassifier::Options options;
//   options.savings = {.settled_probability = 0.98,
//                      .settled_steps = 4,
//                      .settled_stride = 4};
//   ContactClassifier classifier(model, options);
//
// Plain data; thread-safe.
#pragma once

#include <cstdint>

namespace tactus::internal {

struct StepSavings {
  // The answer is settled if the same class had at least this probability after
  // `settled_steps` steps in a row. Above 1: it never is.
  double settled_probability = 2;
  uint32_t settled_steps = 1;
  // While the answer is settled, only every step of this number is taken. A
  // step that unsettles the answer ends that. 0: no further step is taken in
  // this contact.
  uint32_t settled_stride = 1;
  // A step is left out if no input differs from the inputs of the last step by
  // this or more, but at most `most_unchanged` steps in a row. 0: never.
  double unchanged_input = 0;
  uint32_t most_unchanged = 3;
  // While the HMMs' best class has at least this probability, the HMMs answer
  // alone and the LSTMs are not stepped. Above 1: never.
  double sure_hmm_probability = 2;

  bool any() const {
    return settled_probability <= 1 || unchanged_input > 0 ||
           sure_hmm_probability <= 1;
  }
};

}  // namespace tactus::internal
