// File: fit_models.h
//
// The uncalibrated parts of a fit: HMMs and LSTMs, each with the scaling of
// its inputs, from the contacts alone. FitModel (fit.h) puts them together.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       Model model, FitHmms(contacts, names, options, Progress()));
//   TACTUS_RETURN_IF_ERROR(FitLstms(contacts, options, /*networks=*/3,
//                                   RunSerially, Progress(), model));
//
// Contacts must outlive the call. Thread-safe: free functions without state.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/classify/model.h"
#include "core/train/fit_options.h"
#include "core/train/labelled_contact.h"
#include "core/train/work.h"

namespace tactus {

// Returns a model with features, scaling and HMMs, a uniform prior and an
// inverse temperature of 1. `class_names` sets the order of the classes. Each
// class must have a contact.
absl::StatusOr<Model> FitHmms(
    const std::vector<const LabelledContact*>& contacts,
    const std::vector<std::string>& class_names, const FitOptions& options,
    const Progress& progress);

// Adds `networks` LSTMs, trained as `options.lstm` says, to `model`, which
// FitHmms returned. Adds an estimator if the options ask for one and the truth
// is known. The calibration leaves the networks' probabilities unchanged.
absl::Status FitLstms(const std::vector<const LabelledContact*>& contacts,
                      const FitOptions& options, int networks,
                      const ParallelFor& parallel, const Progress& progress,
                      Model& model);

}  // namespace tactus
