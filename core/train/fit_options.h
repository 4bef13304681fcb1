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
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/classify/model.h"
#include "core/contacts/varied_contacts.h"
#include "core/inputs/inputs.h"
#include "core/lstm/train.h"
#include "core/questions/question_table.h"

namespace tactus::internal {

// How LSTMs are trained.
struct LstmFit {
  // Number of networks, of the model and of each inner fold of its calibration.
  // They differ by their seeds. 0 for HMMs alone.
  int networks = 0;
  // The cues that their inputs are made from, as FitOptions::hmm_cues.
  std::vector<Cue> cues;
  Scaling scaling = Scaling::kStandard;
  // The scaled inputs are clamped to plus and minus this.
  double limit = std::numeric_limits<double>::infinity();
  // Cues that also give `stretches` inputs each (InputOptions).
  std::vector<Cue> stretched_cues;
  int stretches = 0;
  StepIntervals steps;
  std::vector<int> cells = {50, 50};
  // Also train an estimator of the object (object_estimate.h), where the truth
  // is known. It is a network of its own on the same inputs.
  bool estimates = false;
  std::vector<int> estimator_cells = {50, 50};
  Activation activation = Activation::kTanh;
  GateActivation gate_activation = GateActivation::kSigmoid;
  // Network n is trained with the seed FitOptions::seed + n.
  LstmTrainOptions training;
};

// What each inner fold of a calibration leaves out.
enum class InnerFolds {
  kConditions,
  kMaterials,
  // What the contacts ask for (choice_folds.h): groups, else conditions. The
  // answers are fitted up to the end of the longest contact, and hold where
  // later frames mislead.
  kChoice,
};

// How frequent the classes are where a model will be used.
enum class ClassShares {
  kRecorded,  // as among the contacts of the fit
  kEven,      // equally frequent
};

// What answers beside the LSTMs.
enum class Learner {
  // HMMs of each class, on cues.
  kHmms,
  // A linear classifier (core/ridge). It sees all taxels, and no cues.
  kRidge,
  // Extremely randomised trees (core/trees), likewise.
  kTrees,
  // One nearest neighbour (core/nearest), likewise.
  kNearest,
};

// The learner that a model has.
Learner LearnerOf(const Model& model);

struct FitOptions {
  Learner learner = Learner::kHmms;
  // Features that models may use. Cues that need others are left out.
  std::vector<Feature> features = {Feature::kForce, Feature::kMotion,
                                   Feature::kArea};
  // The cues that the HMMs' inputs are made from; empty for the features
  // themselves.
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
  // What the classes answer; without rows, DefaultQuestions().
  QuestionTable questions;
  // What the posteriors are about.
  Truth truth = Truth::kFinal;
  // Models are trained on every contact and on its copies drawn from this
  // range. HMMs are trained on copies of the same stiffness.
  VariationRange variations;
  // The calibration is fitted on inner folds. Each leaves out one condition, or
  // a group of materials. If the contacts have one condition or very many,
  // there are `calibration_folds` stratified folds instead.
  InnerFolds inner_folds = InnerFolds::kConditions;
  int calibration_folds = 3;
  // Above 0: this fraction of the contacts, drawn within each class, is left
  // out of the fit, and the calibration is fitted to what the model itself
  // answers on them. For so many contacts that a part of them is enough. There
  // are no inner folds then.
  double held_out = 0;
  // Without calibration the scores become probabilities unchanged. The best
  // class of the HMMs alone or of the LSTMs alone stays the same.
  bool calibrate = true;
  // The prior of the classes in calibrated answers.
  ClassShares shares = ClassShares::kRecorded;
  uint64_t seed = 1;
};

// Returns `cues` without those that need other features; for an empty list, the
// features themselves.
std::vector<Cue> CuesFor(const std::vector<Cue>& cues,
                         const std::vector<Feature>& features);

// The options without the cues of shear, unless all skins of the contacts have
// three axes. Models that take no other cues keep them.
FitOptions SuitedToAxes(const FitOptions& options,
                        const std::vector<const LabelledContact*>& contacts);

// What models of these classes are asked: the options' label table, or
// DefaultQuestions(). INVALID_CONFIG as QuestionsFor() has it.
absl::StatusOr<std::vector<Question>> QuestionsOf(
    const FitOptions& options, const std::vector<std::string>& class_names);

// True if the models look at more of the skin than the features
// (ExtractOptions::whole_skin).
bool UsesWholeSkin(const FitOptions& options);

// All but "paper" take the cues of shear too, on skins of three axes.
// "paper": one 10-state left-right HMM a class on the scaled features,
// scored by Viterbi, and a 2 x 50 softsign LSTM on every frame (Section
// "Algorithm Parameters").
// "tuned": mixtures of HMMs and an LSTM on cues, fused.
// "world": as "tuned", for 10,000 contacts and more of many objects and arms
// (docs/simulator.md). No copies, held-out contacts instead of inner folds, and
// answers about the class so far.
// "profile": mixtures of HMMs on the load profile, for recordings on a skin
// whose place matters (research/recordings.md).
// "ridge": a linear classifier of all taxels so far, for few trials
// (core/ridge).
// "trees": randomised trees on the same (core/trees).
// "nearest": the class of the most similar contact (core/nearest).
// "pattern": mixtures of HMMs on a learned linear embedding of all taxels, for
// skins on which the place or the pattern of the load is the information.
// "whole-skin": the same on the whole skin's load without its places, for
// skins that are touched anywhere.
absl::StatusOr<FitOptions> FitPreset(absl::string_view name);

// Stands for the preset that suits the contacts best (core/eval).
inline constexpr absl::string_view kAutoPreset = "auto";

}  // namespace tactus::internal
