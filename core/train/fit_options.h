// File: fit_options.h
//
// FitOptions: everything that decides how a model is fitted, and the presets.
//
//   TACTUS_ASSIGN_OR_RETURN(FitOptions options, FitPreset("tuned"));
//   options.lstm.networks = 1;
//   TACTUS_ASSIGN_OR_RETURN(Model model,
//                           FitModel(contacts, options, RunSerially));
//
// Plain data and free functions without state; thread-safe.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/classify/model.h"
#include "core/lstm/train.h"
#include "core/train/inputs.h"
#include "core/train/variation.h"

namespace tactus {

// How LSTMs are trained.
struct LstmFit {
  // Networks of the model, which differ by their seeds; 0 for HMMs alone.
  int networks = 0;
  // What they see, as FitOptions::hmm_cues.
  std::vector<Cue> cues;
  Scaling scaling = Scaling::kStandard;
  // Of the scaled inputs.
  double limit = std::numeric_limits<double>::infinity();
  // Cues of which they see this many stretches too.
  std::vector<Cue> stretched_cues;
  int stretches = 0;
  StepIntervals steps;
  std::vector<int> cells = {50, 50};
  // Also train an estimator of the object (object_estimate.h), where the truth
  // is known.
  bool estimates = false;
  Activation activation = Activation::kTanh;
  GateActivation gate_activation = GateActivation::kSigmoid;
  // Its seed is FitOptions::seed and those after it.
  LstmTrainOptions training;
};

// What the inner folds of a calibration leave out.
enum class InnerFolds { kConditions, kMaterials };

struct FitOptions {
  // What may be known of a contact; cues that need others are left out.
  std::vector<Feature> features = {Feature::kForce, Feature::kMotion,
                                   Feature::kArea};
  // What the HMMs see; empty for the features themselves.
  std::vector<Cue> hmm_cues;
  // Logarithms of the features instead of the features.
  bool log_features = true;
  StepIntervals hmm_steps;
  int states = 10;
  int hmms_per_class = 1;
  Score score = Score::kForward;
  // Iterations of Baum-Welch.
  int max_iterations = 15;
  // Smallest variance of a scaled input in any state.
  double covariance_floor = 1e-3;
  LstmFit lstm;
  // Models are trained on every contact as it is, and on such copies of it;
  // HMMs on copies of the same stiffness.
  VariationRange variations;
  // A calibration is fitted on inner folds that leave out one condition each
  // where there are a few, or a material or two each; else on this many even
  // ones.
  InnerFolds inner_folds = InnerFolds::kConditions;
  int calibration_folds = 3;
  // Without, scores are probabilities as they are: the best class is the same
  // where HMMs or LSTMs are asked alone.
  bool calibrate = true;
  uint64_t seed = 1;
};

// `cues` without those that need other features; for an empty list, the
// features themselves.
std::vector<Cue> CuesFor(const std::vector<Cue>& cues,
                         const std::vector<Feature>& features);

// "paper": one 10-state left-right HMM a category on the scaled features,
// scored by Viterbi, and a 2 x 50 softsign LSTM on every frame (Section
// "Algorithm Parameters").
// "tuned": mixtures of HMMs and several LSTMs on cues, fused.
// "profile": mixtures of HMMs on the load profile, for recordings on a skin
// whose place matters (docs/recordings.md).
absl::StatusOr<FitOptions> FitPreset(absl::string_view name);

}  // namespace tactus
