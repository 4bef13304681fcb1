// File: model.h
//
// Model: everything needed to classify contacts, as plain data. It is what a
// bundle file holds (core/bundle) and what fitting produces (core/train);
// CompiledModel makes it runnable.
//
// Copyable; safe to share between threads once built.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/classify/step_clock.h"
#include "core/features/cues.h"
#include "core/features/feature.h"
#include "core/hmm/mixture.h"
#include "core/lstm/network.h"
#include "core/skin/layout.h"

namespace tactus {

// One input of a model: cue x -> (g(x) - offset) * gain, held within `limit`
// either way, where g(x) is x if log_offset is 0, else
// log(max(x, 0) + log_offset). Several inputs may look at one cue, each at
// another stretch of it.
struct ModelInput {
  Cue cue = Cue::kForce;
  double log_offset = 0;
  double offset = 0;
  double gain = 1;
  double limit = std::numeric_limits<double>::infinity();
};

// How the frames of a contact become model inputs.
struct FeatureSpec {
  // At least one.
  std::vector<ModelInput> hmm;
  StepIntervals hmm_steps;
  // Empty without an LSTM.
  std::vector<ModelInput> lstm;
  StepIntervals lstm_steps;
  // Frames per second the models were trained at.
  double sample_rate_hz = 100;
};

// Maps scores to probabilities. The tables run over frames since onset;
// between entries they are interpolated in log(frames), outside held.
struct Calibration {
  std::vector<double> frames;
  // Factors on the log-scores before the softmax, > 0.
  std::vector<double> hmm_temperature;
  std::vector<double> lstm_temperature;
  // Share of the LSTM in the fused log-probability, 0 to 1.
  std::vector<double> lstm_weight;
  // Best class's log-likelihood per HMM step: the median of training contacts,
  // and the deviation that the share of unknown is reckoned with.
  std::vector<double> evidence_mean;
  std::vector<double> evidence_deviation;
  // Factors on the standard deviations of the object estimate.
  double stiffness_deviation_scale = 1;
  double moved_deviation_scale = 1;
  // Per class; sums to 1.
  std::vector<double> prior;
  // A decision is a probability >= threshold for this many frames.
  double decision_threshold = 0.9;
  uint32_t decision_frames = 10;
};

struct Provenance {
  std::string command;
  std::string version;
  uint32_t trials = 0;
  uint64_t seed = 0;
  std::string data;
  std::string note;
};

// Touched frames of one contact and the answers they must give.
struct WarmUpTrial {
  std::vector<ContactSample> samples;
  std::vector<double> probability;
  std::vector<double> log_likelihood;
};

struct Model {
  std::vector<std::string> class_names;
  FeatureSpec features;
  // One mixture per class.
  std::vector<HmmMixture> hmms;
  Score hmm_score = Score::kForward;
  // Networks of one shape whose mean probability is the LSTM's answer; empty
  // for HMMs alone.
  std::vector<LstmNetwork> lstms;
  // A network of its own for the object estimate (object_estimate.h), which
  // would cost the others accuracy; sees the same inputs.
  std::optional<LstmNetwork> estimator;
  Calibration calibration;
  // Skin of the training data; an empty name fits any skin.
  SkinLayout layout;
  Provenance provenance;
  WarmUpTrial warm_up;

  int classes() const { return static_cast<int>(class_names.size()); }
};

}  // namespace tactus
