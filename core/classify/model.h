// File: model.h
//
// Model: everything needed to classify contacts, as plain data. It is what a
// bundle file holds (core/bundle) and what fitting produces (core/eval);
// CompiledModel makes it runnable.
//
// Copyable; safe to share between threads once built.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/features/feature.h"
#include "core/hmm/mixture.h"
#include "core/lstm/network.h"
#include "core/skin/layout.h"

namespace tactus {

// x -> (g(x) - offset) * gain.
struct FeatureScaling {
  double offset = 0;
  double gain = 1;
};

// How the three natural features become model inputs.
struct FeatureSpec {
  // Features used, in the order of the models' inputs; at least one.
  std::vector<Feature> features;
  // Per used feature: 0 keeps x, above 0 takes log(max(x, 0) + log_offset).
  std::vector<double> log_offset;
  // Per used feature. The LSTM's is empty without an LSTM.
  std::vector<FeatureScaling> hmm_scaling;
  std::vector<FeatureScaling> lstm_scaling;
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
  // Best class's log-likelihood per frame over training contacts.
  std::vector<double> evidence_mean;
  std::vector<double> evidence_deviation;
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

// Features of one contact and the answers they must give.
struct WarmUpTrial {
  std::vector<FeatureVector> signals;
  std::vector<double> probability;
  std::vector<double> log_likelihood;
};

struct Model {
  std::vector<std::string> class_names;
  FeatureSpec features;
  // One mixture per class.
  std::vector<HmmMixture> hmms;
  Score hmm_score = Score::kForward;
  std::optional<LstmNetwork> lstm;
  Calibration calibration;
  // Skin of the training data; an empty name fits any skin.
  SkinLayout layout;
  Provenance provenance;
  WarmUpTrial warm_up;

  int classes() const { return static_cast<int>(class_names.size()); }
};

}  // namespace tactus
