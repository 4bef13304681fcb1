// File: fit_decisions.h
//
// Fits the thresholds at which questions are decided, so that of the decisions
// that are made at least 95 % hold.
//
// Held-out contacts are walked frame by frame with the calibrated model, once
// for all thresholds that are tried. The first decision of each contact on each
// question is judged: a property by the contact's label, a state by the label
// so far at the frame of the decision (question_truth.h).
//
// The thresholds are tested from the strictest down to the nominal 0.95. One
// passes if the lower end of the 95 % interval (Wilson) of the fraction that
// holds is at least 0.95. The test ends at the first that fails, and the last
// one that passed is taken. Because the order is fixed, the chance that a bad
// threshold passes by luck is that of a single test (A. Angelopoulos et al.,
// "Learn then Test", 2021, Section 2.2). Thresholds with fewer than 73
// decisions are passed over: they could not pass if all of them held. If none
// passes, the strictest is taken: there are too few contacts, or too few
// decisions hold.
//
//   std::vector<TriedDecisions> tried;
//   for (const LabelledContact* contact : held_out) {
//     tried.push_back(TryDecisions(calibrated_model, *contact));
//   }
//   FitDecisions(tried, calibration);
//
// Thread-safe: free functions without state.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/classify/compiled_model.h"
#include "core/contacts/labelled_contact.h"

namespace tactus::internal {

// The fraction of decisions that are to hold.
inline constexpr double kDecisionsThatHold = 0.95;

// The thresholds that are tried, increasing.
inline constexpr std::array<double, 12> kTriedThresholds = {
    0.95, 0.96,  0.97,  0.975, 0.98,  0.985,
    0.99, 0.993, 0.995, 0.997, 0.998, 0.999};

// [questions][thresholds]: whether the first decision of a contact holds;
// nothing without a decision.
using TriedDecisions =
    std::vector<std::array<std::optional<bool>, kTriedThresholds.size()>>;

// Walks a contact with a model that was not fitted to it. Its label must be a
// class of the model.
TriedDecisions TryDecisions(const std::shared_ptr<const CompiledModel>& model,
                            const LabelledContact& contact);

// Sets the thresholds and the frames of all questions; the frames are those of
// the decision on the class. There must be a contact.
void FitDecisions(std::span<const TriedDecisions> tried,
                  Calibration& calibration);

}  // namespace tactus::internal
