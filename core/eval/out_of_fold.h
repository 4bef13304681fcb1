// File: out_of_fold.h
//
// Which contacts the models of other folds answer rightly. One model is
// fitted per fold and not calibrated: a calibration would need inner folds, and
// the best class of HMMs or of LSTMs alone hardly depends on it.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       const std::vector<bool> right,
//       RightOutOfFold(contacts, folds, options, RunSerially));
//
// Deterministic. Contacts must outlive the call. Thread-safe: free functions
// without state.
#pragma once

#include <functional>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/ranks.h"
#include "core/base/work.h"
#include "core/contacts/labelled_contact.h"
#include "core/train/fit_options.h"

namespace tactus::internal {

// One per contact. The answers are those of the LSTMs if the options have some,
// else of the HMMs or of the ridge: a fitted model fuses both where that is
// better. The answer is that after the last calibration time. The errors of
// FitModel. `ranks`, if there are some, share out the folds; all must call it
// with the same arguments. CANCELLED once `cancelled`, if there is one, returns
// true; any thread asks it, as often as FitJournal::Cancelled.
absl::StatusOr<std::vector<bool>> RightOutOfFold(
    const std::vector<const LabelledContact*>& contacts,
    const std::vector<std::vector<int>>& folds, const FitOptions& options,
    const ParallelFor& parallel, const Progress& progress = {},
    Ranks* ranks = nullptr, const std::function<bool()>& cancelled = {});

// The same by models of `training`, the contacts that the model for each fold
// is fitted to.
absl::StatusOr<std::vector<bool>> RightOutOfFold(
    const std::vector<const LabelledContact*>& contacts,
    const std::vector<std::vector<int>>& folds,
    const std::vector<std::vector<int>>& training, const FitOptions& options,
    const ParallelFor& parallel, const Progress& progress = {},
    Ranks* ranks = nullptr, const std::function<bool()>& cancelled = {});

}  // namespace tactus::internal
