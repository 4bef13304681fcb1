// File: small_model.h
//
// A tiny valid model for tests: two or more classes told apart by the level
// of log-force and by motion. Plain data; deterministic.
#pragma once

#include <string>
#include <vector>

#include "core/classify/model.h"

namespace tactus::internal::testing {

// Classes HU, HM, SU, SM; features force (log) and motion; one two-state
// left-right HMM a class around the given levels. Fits any skin.
inline Model SmallModel() {
  Model model;
  model.class_names = {"HU", "HM", "SU", "SM"};
  model.inputs.hmm = {{Cue::kForce, 0.01}, {Cue::kMotion, 0, 0, 100}};
  const double force[] = {1, 0, -1, -2};
  const double motion[] = {0, 1, 0.3, 1.5};
  for (int k = 0; k < 4; ++k) {
    GaussianHmm hmm;
    hmm.states = 2;
    hmm.dimensions = 2;
    hmm.covariance_type = CovarianceType::kDiagonal;
    hmm.start = {1, 0};
    hmm.transition = {0.9, 0.1, 0, 1};
    hmm.means = {force[k] - 1, motion[k] / 2, force[k], motion[k]};
    hmm.covariances = {1, 0.2, 0.5, 0.1};
    model.hmms.push_back({{0.0}, {hmm}});
  }
  Calibration& c = model.calibration;
  c.frames = {10, 100};
  c.hmm_inverse_temperature = {0.5, 0.1};
  c.hmm_bias.assign(8, 0);
  c.evidence_median = {-2, -2};
  c.evidence_deviation = {1, 1};
  c.prior = {0.25, 0.25, 0.25, 0.25};
  c.decision_threshold = 0.8;
  c.decision_frames = 5;
  model.provenance.command = "small_model";
  return model;
}

// Networks and HMMs of the same weight, at the two entries of SmallModel().
inline void AddLstmCalibration(Calibration& c) {
  c.lstm_inverse_temperature = {1, 1};
  c.hmm_weight = {0.5, 0.5};
  c.lstm_weight = {0.5, 0.5};
  c.lstm_bias = c.fused_bias = c.hmm_bias;
}

// Adds `count` untrained networks on the HMMs' inputs.
inline void AddLstms(int count, Model& model) {
  for (int n = 0; n < count; ++n) {
    model.lstms.push_back(RandomNetwork(2, {50, 50}, 4, Activation::kSoftsign,
                                        GateActivation::kHardSigmoid, 3 + n));
  }
  model.inputs.lstm = model.inputs.hmm;
  AddLstmCalibration(model.calibration);
}

}  // namespace tactus::internal::testing
