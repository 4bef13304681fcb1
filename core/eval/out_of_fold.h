// File: out_of_fold.h
//
// How many contacts the models of other folds answer rightly, as they would be
// served: HMMs and LSTMs fused and calibrated. One model is fitted per fold. A
// fold's answers are calibrated by the scores of the other folds, which costs
// no further fit.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       const int right,
//       CountOutOfFoldRight(contacts, folds, options, RunSerially));
//
// Deterministic. Contacts must outlive the call. Thread-safe: free functions
// without state.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "core/base/work.h"
#include "core/contacts/labelled_contact.h"
#include "core/train/fit_options.h"

namespace tactus {

// The answer is that after the last calibration time. The errors of FitModel.
absl::StatusOr<int> CountOutOfFoldRight(
    const std::vector<const LabelledContact*>& contacts,
    const std::vector<std::vector<int>>& folds, const FitOptions& options,
    const ParallelFor& parallel, const Progress& progress = {});

}  // namespace tactus
