// File: calibrate.h
//
// Fitting a Calibration to scores of held-out contacts, so that a probability
// of 0.8 is right eight times in ten, at any time since onset.
//
// The frames of a contact are not independent given the state, so raw HMM
// likelihoods are overconfident, and more so the longer the contact lasts. One
// factor on the log-scores per time, an inverse temperature, corrects this (Guo
// et al., ICML 2017, Section 4.2, applied to log-likelihoods), and a bias per
// class corrects what the scores think of how frequent classes are. The LSTMs
// have their own. The fused answer is one log-linear model of both
// (softmax_fit.h). It is used only if its log loss on held-out contacts is
// lower than that of HMMs or LSTMs alone by more than one standard error; else
// the better of the two answers.
//
//   std::vector<ScoredContact> scored;
//   const auto frames = CalibrationFrames(/*rate=*/100);
//   scored.push_back(ScoreContact(model_without_it, contact, frames));
//   FitCalibration(scored, frames, model.calibration);
//
// Thread-safe: free functions without state.
#pragma once

#include <span>
#include <vector>

#include "core/classify/compiled_model.h"
#include "core/classify/object_estimate.h"
#include "core/contacts/labelled_contact.h"

namespace tactus::internal {

// Frames since onset at which calibrations are fitted: those of AnytimeFrames
// that differ. Before them 0.01 and 0.03 s, if LSTMs of these steps have a
// first one that early (StepIntervals::first). After them each twice the last,
// until a contact of `longest` frames has ended.
std::vector<double> CalibrationFrames(double rate,
                                      const StepIntervals& lstm_steps = {},
                                      size_t longest = 0);

// A held-out contact's scores at each calibration time.
struct ScoredContact {
  // The class at each time: the label, or the label so far.
  std::vector<int> labels;
  // [times][classes], of the HMMs or of what stands in their place; a contact
  // shorter than a
  // time gives its last.
  std::vector<std::vector<double>> log_likelihood;
  // [times][classes], the LSTMs' log-probabilities; empty without an LSTM.
  std::vector<std::vector<double>> lstm_score;
  // Estimates of the object and the truth, at each calibration time; empty
  // without an estimator.
  struct Estimate {
    ObjectEstimate estimate;
    double log10_stiffness = 0;
    double moved_m = 0;
  };
  std::vector<Estimate> estimates;
  // ContactClassifier::evidence_steps() at each time.
  std::vector<double> hmm_steps;
  // [times]: estimated stiffness, log10 N/m; NaN before the first estimate.
  // Empty without an estimator.
  std::vector<double> log10_stiffness;
  // The scores do not grow with the steps: there are no HMMs.
  bool bounded = false;
};

// Scores one contact with a model that was not fitted to it. Its label must be
// a class of the model. `frames`: CalibrationFrames().
ScoredContact ScoreContact(const std::shared_ptr<const CompiledModel>& model,
                           const LabelledContact& contact,
                           const std::vector<double>& frames);

// How good the scores are after the last calibration time, without any
// temperature, a uniform prior, and HMMs and LSTMs with equal weights.
struct HeldOutSkill {
  double loss = 0;  // mean of -log(probability of the label)
  double accuracy = 0;
};
HeldOutSkill SkillOf(std::span<const ScoredContact> contacts);

// Sets frames, those of the scores, inverse temperatures, biases, weights, what
// `unknown` compares with (fit_unknown.h) and the scales of the estimates'
// deviations. Keeps prior and decision rule.
void FitCalibration(std::span<const ScoredContact> contacts,
                    const std::vector<double>& frames,
                    Calibration& calibration);

// Lets a fitted calibration hold the answer (Calibration::hold_after_frames)
// from the time on at which most contacts are answered rightly, so that frames
// that mislead change nothing. If that is the last time, nothing is held.
void HoldTheBestAnswer(std::span<const ScoredContact> contacts,
                       Calibration& calibration);

// Makes a fitted calibration answer as if all classes were equally frequent.
// The share of a class is the fraction of `contacts` that have its label in the
// end. Each probability is divided by the share of its class; then all are
// scaled to sum to 1. Source: M. Saerens et al., "Adjusting the Outputs of a
// Classifier to New a Priori Probabilities" (2002).
void PresumeEvenShares(std::span<const ScoredContact> contacts,
                       Calibration& calibration);

}  // namespace tactus::internal
