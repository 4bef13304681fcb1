// File: calibrate.h
//
// Fitting a Calibration to scores of held-out contacts, so that a probability
// of 0.8 is right eight times in ten, at any time since onset.
//
// The frames of a contact are far from independent given the state, so raw
// HMM likelihoods are overconfident, more so the longer the contact. One
// factor on the log-scores per time ("temperature") mends it (Guo et al.,
// ICML 2017, Section 4.2, on log-likelihoods). The LSTM has its own, and its
// weight is the one at which HMMs and LSTM together lose least.
//
// Thread-safe: free functions without state.
#pragma once

#include <span>
#include <vector>

#include "core/classify/compiled_model.h"
#include "core/classify/object_estimate.h"
#include "core/train/labelled_contact.h"

namespace tactus {

// Frames since onset at which calibrations are fitted: those of AnytimeFrames
// that differ.
std::vector<double> CalibrationFrames(double rate);

// A held-out contact's scores at each calibration time.
struct ScoredContact {
  int label = 0;
  // [times][classes]; a contact shorter than a time gives its last.
  std::vector<std::vector<double>> log_likelihood;
  // [times][classes], the LSTMs' log-probabilities; empty without an LSTM.
  std::vector<std::vector<double>> lstm_score;
  // What the LSTMs say of the object and what is true, at
  // each calibration time; empty without.
  struct Estimate {
    ObjectEstimate said;
    double log10_stiffness = 0;
    double moved_m = 0;
  };
  std::vector<Estimate> estimates;
  // Steps of the HMMs up to each time.
  std::vector<double> hmm_steps;
};

// Scores one contact by a model that has not seen it.
ScoredContact ScoreContact(const std::shared_ptr<const CompiledModel>& model,
                           const LabelledContact& contact, int label);

// Fills frames, temperatures, the LSTM's weight, evidence and the scales of the
// estimates' deviations; leaves prior and decision rule.
void FitCalibration(std::span<const ScoredContact> contacts, double rate,
                    Calibration& calibration);

}  // namespace tactus
