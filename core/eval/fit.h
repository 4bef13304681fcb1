// File: fit.h
//
// Fitting a Model to labelled contacts: feature scaling, one mixture of HMMs
// per category, calibration on inner folds.
//
//   TACTUS_ASSIGN_OR_RETURN(FitOptions options, FitPreset("default"));
//   TACTUS_ASSIGN_OR_RETURN(Model model, FitModel(contacts, options,
//   parallel));
//
// Deterministic: the same contacts, options and seed give the same model,
// however `parallel` spreads the work. Thread-safe.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/classify/model.h"
#include "core/eval/contact.h"
#include "core/eval/parallel.h"

namespace tactus {

struct FitOptions {
  std::vector<Feature> features = {Feature::kForce, Feature::kMotion,
                                   Feature::kArea};
  // Logarithms of the features instead of the features.
  bool log_features = true;
  int states = 10;
  int hmms_per_class = 1;
  Score score = Score::kForward;
  // Iterations of Baum-Welch.
  int max_iterations = 15;
  // Smallest variance of a scaled feature in any state.
  double covariance_floor = 1e-3;
  // Inner folds that the calibration is fitted on.
  int calibration_folds = 3;
  uint64_t seed = 1;
};

// "paper": one 10-state left-right HMM a category on the scaled features,
// scored by Viterbi (Section "Algorithm Parameters").
// "default": log-features, several HMMs a category, forward score.
absl::StatusOr<FitOptions> FitPreset(absl::string_view name);

// Class names in `contacts`: HU, HM, SU, SM first where present, others in
// alphabetical order.
std::vector<std::string> ClassNames(
    const std::vector<const Contact*>& contacts);

// INVALID_TRAINING_DATA if there are fewer than two classes or fewer than two
// contacts of some class, if skins or sampling rates are mixed. The
// provenance is left to the caller, but for trials and seed.
absl::StatusOr<Model> FitModel(const std::vector<const Contact*>& contacts,
                               const FitOptions& options,
                               const ParallelFor& parallel);

}  // namespace tactus
