// File: unknown.h
//
// Measures how well `unknown` detects contacts of a class that was left out
// of training. A model of all other classes classifies contacts of that
// class and of the others, all from a robot condition that was left out too.
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
#include "core/base/work.h"
#include "core/contacts/labelled_contact.h"
#include "core/eval/metrics.h"
#include "core/train/fit.h"

namespace tactus::internal {

struct UnknownResult {
  // The class left out of fitting.
  std::string left_out;
  // Number of contacts of that class, and of the others.
  int contacts = 0;
  int other_contacts = 0;
  // Fraction of those contacts, and of the others, whose `unknown` is above one
  // half after the last frame.
  double detected = 0;
  double false_alarms = 0;
  // Probability that a contact of the class has a larger `unknown` than a
  // contact of the others; 0.5 is chance.
  double area_under_roc = 0;
  // Its 95 % interval.
  Interval area_interval;
};

// Returns one entry per class. The number and the size of the LSTMs that
// classify do not change `unknown`; without any, or without estimates, it comes
// from the HMMs alone. INVALID_TRAINING_DATA if there are fewer than three
// classes; else the errors of FitModel.
absl::StatusOr<std::vector<UnknownResult>> EvaluateUnknown(
    const std::vector<const LabelledContact*>& contacts,
    const FitOptions& options, const ParallelFor& parallel,
    const Progress& progress = {});

// The probability that a value of `positive` is above a value of `negative`;
// ties count one half. 0.5 if either is empty.
double AreaUnderRoc(std::span<const double> positive,
                    std::span<const double> negative);

// The 95 % interval of an area under the ROC curve that was measured on so many
// contacts (J. A. Hanley and B. J. McNeil, "The meaning and use of the area
// under a receiver operating characteristic (ROC) curve", Radiology 143, 1982,
// eq. 1). 0 to 1 if either count is 0.
Interval AreaInterval(double area, int positive, int negative);

}  // namespace tactus::internal
