// File: learning_curve.h
//
// How the accuracy grows with the number of recordings, so that a user knows
// whether more of them would help.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       const LearningCurve curve,
//       MeasureLearningCurve(contacts, protocol, options, RunSerially));
//   const auto twice =
//       ExpectedAccuracy(curve, 2 * curve.points.back().per_class);
//
// Deterministic. Thread-safe: free functions without state.
#pragma once

#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/work.h"
#include "core/contacts/folds.h"
#include "core/contacts/labelled_contact.h"
#include "core/train/fit_options.h"

namespace tactus::internal {

struct CurvePoint {
  // Contacts of a class that a model was fitted to, at most.
  int per_class = 0;
  // Tested contacts that were answered rightly.
  int right = 0;
};

struct LearningCurve {
  // By rising number of contacts; the last point has all of them.
  std::vector<CurvePoint> points;
  int tested = 0;
};

// Tests each contact by models of 5, 10, 20 and 50 contacts a class, and of all
// there are, in the folds of the protocol. The contacts of a smaller number are
// among those of a larger one. The models are not calibrated: the best class
// hardly depends on it. The errors of MakeFolds and FitModel.
absl::StatusOr<LearningCurve> MeasureLearningCurve(
    const std::vector<const LabelledContact*>& contacts,
    const Protocol& protocol, const FitOptions& options,
    const ParallelFor& parallel, const Progress& progress = {});

// The accuracy to expect with so many contacts a class: the error is taken to
// fall as a power of their number, which is fitted to the curve's last points.
// Nothing if the curve has fewer than three points, or does not rise.
std::optional<double> ExpectedAccuracy(const LearningCurve& curve,
                                       double per_class);

}  // namespace tactus::internal
