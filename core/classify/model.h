// File: model.h
//
// Model: everything that is needed to classify contacts, as plain data. A
// bundle file holds a Model (core/bundle), fitting returns one (core/train),
// and CompiledModel makes it runnable.
//
//   TACTUS_RETURN_IF_ERROR(Validate(model));
//   TACTUS_ASSIGN_OR_RETURN(auto compiled, CompiledModel::Create(model));
//
// Words used throughout: a feature is force, area or motion of a contact; a cue
// is a number derived from the features so far (core/cues/cue.h), or a
// feature itself; an input is a scaled cue as a model takes it.
//
// Copyable. Threads may share a Model that no longer changes.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "core/classify/step_clock.h"
#include "core/cues/cue.h"
#include "core/features/feature.h"
#include "core/hmm/mixture.h"
#include "core/lstm/network.h"
#include "core/nearest/nearest.h"
#include "core/questions/question.h"
#include "core/ridge/ridge.h"
#include "core/skin/layout.h"
#include "core/taxels/skin_range.h"
#include "core/taxels/taxel_embedding.h"
#include "core/trees/trees.h"

namespace tactus::internal {

// One input of a model: cue x -> (g(x) - offset) * gain, clamped to plus and
// minus `limit`. g(x) is x if log_offset is 0, else log(max(x, 0) +
// log_offset). Several inputs may be made from one cue, each from another
// stretch of it.
struct ModelInput {
  Cue cue = Cue::kForce;
  double log_offset = 0;
  double offset = 0;
  double gain = 1;
  double limit = std::numeric_limits<double>::infinity();
};

// How the frames of a contact become model inputs.
struct InputSpec {
  // At least one, or none for a model with a ridge.
  std::vector<ModelInput> hmm;
  StepIntervals hmm_steps;
  // Empty without an LSTM.
  std::vector<ModelInput> lstm;
  StepIntervals lstm_steps;
  // Frames per second the models were trained at.
  double sample_rate_hz = 100;
  // Has no taxels unless an input is made from them.
  TaxelEmbedding embedding;
};

// What a posterior is about: the class that the contact has in the end, or
// its class so far, in which an object is unmoved until it moves.
enum class Truth { kFinal, kSoFar };

// What a model takes the motion from. A model that was fitted with poses reads
// the wandering of a centroid as if the arm had not moved.
enum class PoseNeed {
  kEither,   // the motion is not used, or it is not known
  kNeeded,   // from poses; streams without poses are refused
  kIgnored,  // from the centroid; poses of a stream are ignored
};

// Maps scores to probabilities. The tables are functions of the frames since
// onset (CalibrationAt).
struct Calibration {
  // True if the tables are read when a model is stepped, so that probabilities
  // stay as they are between two steps; false if at every frame.
  bool held = false;
  std::vector<double> frames;
  // Factors on the log-scores before the softmax, above 0; and a bias of each
  // class, entries x classes, because a score may prefer a class.
  std::vector<double> hmm_inverse_temperature;
  std::vector<double> hmm_bias;
  std::vector<double> lstm_inverse_temperature;
  std::vector<double> lstm_bias;
  // The fused answer: a log-linear model of the log-probabilities of HMMs and
  // LSTMs, with weights of at least 0 and a bias of each class. Empty without
  // an LSTM.
  std::vector<double> hmm_weight;
  std::vector<double> lstm_weight;
  std::vector<double> fused_bias;
  // What UnknownProbability() compares a contact with: the median, over
  // held-out contacts, of the best class's log-likelihood per HMM step, and how
  // far below it one deviation is.
  std::vector<double> evidence_median;
  std::vector<double> evidence_deviation;
  // Objects with a lower estimated stiffness are unknown, log10 N/m. One in a
  // hundred held-out contacts lies below. Empty if no stiffness is too low:
  // without an estimator, or if training had too few estimates.
  std::vector<double> softest;
  // Factors on the standard deviations of the object estimate.
  double stiffness_deviation_scale = 1;
  double moved_deviation_scale = 1;
  // Frames since onset after which the models take no more steps, so that the
  // answer stays; 0 if they always do. For data in which later frames mislead.
  uint32_t hold_after_frames = 0;
  // One probability per class; they sum to 1.
  std::vector<double> prior;
  // A decision is a probability >= threshold for this many frames.
  double decision_threshold = 0.9;
  uint32_t decision_frames = 10;
  // The same for each of Model::questions; empty for the two values above.
  std::vector<double> question_threshold;
  std::vector<uint32_t> question_frames;
};

struct Provenance {
  std::string command;
  std::string version;
  uint32_t trials = 0;
  uint64_t seed = 0;
  std::string data;
  std::string note;
  // The first 64 bits of the fingerprint of each trial's frames, rising; empty
  // if they are not known, or above limits::kMaxProvenanceTrials.
  std::vector<uint64_t> trial_fingerprints;
  // SHA-256 of the data as a whole, in hexadecimal digits; empty if unknown.
  std::string data_sha256;
  // Groups (LabelledContact::material) and conditions of the trials; a model of
  // one of each has seen one session at most. 0 if unknown.
  uint32_t groups = 0;
  uint32_t conditions = 0;
};

// Touched frames of one contact and the answers that they must give.
struct WarmUpTrial {
  // Without their taxels.
  std::vector<ContactSample> samples;
  // The taxels of all samples, and where those of each sample end; empty if no
  // input is made from taxels.
  std::vector<TaxelLoad> loads;
  std::vector<uint32_t> load_ends;
  std::vector<double> probability;
  std::vector<double> log_likelihood;

  // The sample number `i` with its taxels, which refer to this trial.
  ContactSample Sample(size_t i) const;
};

inline constexpr double kDefaultReleaseAfterS = 0.5;

struct Model {
  std::vector<std::string> class_names;
  // What the classes answer; empty for DefaultQuestions(class_names).
  // CompiledModel::questions() returns either.
  std::vector<Question> questions;
  InputSpec inputs;
  // One mixture per class; none for a model with one of the three below.
  std::vector<HmmMixture> hmms;
  // Instead of HMMs, at most one of them: its scores are what log-likelihoods
  // are of HMMs, at the steps of HMMs.
  std::optional<Ridge> ridge;
  std::optional<Nearest> nearest;
  std::optional<Trees> trees;
  // What the taxels read in training; nothing if the model does not see them.
  std::optional<SkinRange> skin_range;
  Score hmm_score = Score::kForward;
  // Networks of one shape. Their mean probability is the LSTMs' answer. Empty
  // for HMMs alone.
  std::vector<LstmNetwork> lstms;
  // A separate network for the object estimate (object_estimate.h), because a
  // network that does both classifies less well. It takes the same inputs.
  std::optional<LstmNetwork> estimator;
  Calibration calibration;
  Truth truth = Truth::kFinal;
  // Skin of the training data; an empty name fits any skin. Further skins of
  // the same name and shape, with other thresholds.
  SkinLayout layout;
  std::vector<SkinLayout> more_layouts;
  PoseNeed poses = PoseNeed::kEither;
  // Seconds without touch that end a contact, unless a stream says otherwise.
  // At most limits::kMaxReleaseAfterMs; below 0, only the end of a trial ends
  // it. Not 0.
  double release_after_s = kDefaultReleaseAfterS;
  Provenance provenance;
  WarmUpTrial warm_up;

  int classes() const { return static_cast<int>(class_names.size()); }
};

// OK if every part is valid and every size agrees with every other: the one
// place where the parts of a model are compared. INVALID_MODEL naming what is
// wrong, or INVALID_CONFIG for the layout.
absl::Status Validate(const Model& model);

// False if a ridge, nearest neighbours or trees answer in their place.
bool HasHmms(const Model& model);

// Taxels of the skin that the model looks at; 0 if it looks at none.
int TaxelsNeeded(const Model& model);

// True if it also looks at components (core/taxels/components.h).
bool NeedsComponents(const Model& model);

// True if it looks at more of the skin than the features, so that ideal signals
// cannot be classified.
bool NeedsSkin(const Model& model);

// Removes the estimator with the borders that are its estimates'. Without
// estimates no object is unknown for being soft.
void RemoveEstimator(Model& model);

// The first difference between a skin and those of the model's training data;
// empty if it is one of them. A skin without light touch is one of them if it
// differs in nothing else: it feels a part of what they feel.
std::string SkinMisfit(const Model& model, const SkinLayout& layout);

}  // namespace tactus::internal
