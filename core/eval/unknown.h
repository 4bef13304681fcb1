// File: unknown.h
//
// Whether contacts of a category that no model knows are told to be unknown.
// Models of all categories but one meet contacts of that one, and of the
// others, from a robot condition that they were not fitted at.
//
//   TACTUS_ASSIGN_OR_RETURN(auto result,
//                           EvaluateUnknown(contacts, options, RunSerially));
//   result[0].area_under_roc;
//
// Thread-safe: a free function without state.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/train/fit.h"
#include "core/train/labelled_contact.h"
#include "core/train/work.h"

namespace tactus {

struct UnknownResult {
  // The category left out of fitting.
  std::string category;
  // Number of contacts of that category, and of the others.
  int contacts = 0;
  int other_contacts = 0;
  // After a contact's last frame, its probability of being unknown was above
  // one half: share of the contacts of that category, and of the others.
  double detected = 0;
  double false_alarms = 0;
  // Probability that a contact of the category was given a larger one than a
  // contact of the others; 0.5 is chance.
  double area_under_roc = 0;
};

// One entry a category. The probability comes from the HMMs, so no LSTM is
// trained. INVALID_TRAINING_DATA if there are fewer than three categories, or
// as FitModel fails.
absl::StatusOr<std::vector<UnknownResult>> EvaluateUnknown(
    const std::vector<const LabelledContact*>& contacts,
    const FitOptions& options, const ParallelFor& parallel,
    const Progress& progress = {});

// Probability that a value of `positive` is above one of `negative`, ties
// counted half; 0.5 if either is empty.
double AreaUnderRoc(std::span<const double> positive,
                    std::span<const double> negative);

}  // namespace tactus
