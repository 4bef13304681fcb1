// File: evaluate.h
//
// Measuring how well contacts are told apart: by a fixed model, or by a
// protocol that fits on some folds and tests on the others.
//
//   auto result = EvaluateProtocol(contacts, options, parallel);
//   Accuracy(result->final);
//
// Thread-safe: free functions without state.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/classify/compiled_model.h"
#include "core/eval/metrics.h"
#include "core/train/fit.h"
#include "core/train/folds.h"
#include "core/train/labelled_contact.h"
#include "core/train/parallel.h"

namespace tactus {

enum class Algorithm { kHmm, kLstm, kNearest, kFused };

// "hmm", "lstm", "1nn" or "fused".
absl::StatusOr<Algorithm> ParseAlgorithm(absl::string_view name);

// Seconds since onset at which answers are taken, beside the last.
inline constexpr double kAnytimeSeconds[] = {0.1, 0.25, 0.5, 1.2, 2.5, 5.0};
inline constexpr int kAnytimeCount = 6;

// What was said of an object and what is true of it.
struct EstimateOutcome {
  ObjectEstimate said;
  double log10_stiffness = 0;
  double moved_m = 0;
};

struct Evaluation {
  std::vector<std::string> class_names;
  // One per contact, in the order given, after its last frame.
  std::vector<Outcome> final;
  // The same after each of kAnytimeSeconds; a shorter contact's last.
  std::vector<std::vector<Outcome>> anytime;
  // What the HMMs and the LSTMs alone said at each of kAnytimeSeconds, if
  // fused was asked for and there is an LSTM; else empty.
  std::vector<std::vector<Outcome>> anytime_hmm;
  std::vector<std::vector<Outcome>> anytime_lstm;
  // Nothing where the truth or the estimate is missing; as above.
  std::vector<std::optional<EstimateOutcome>> final_estimates;
  std::vector<std::vector<std::optional<EstimateOutcome>>> anytime_estimates;
  // Seconds since onset at which each contact was decided, and whether rightly.
  struct DecisionOutcome {
    double seconds = 0;
    bool right = false;
  };
  std::vector<std::optional<DecisionOutcome>> decisions;
  // Probability that no class explains the contact, after its last frame.
  std::vector<double> unknown;
};

// Every contact by one model. INVALID_CONFIG for 1nn, for lstm without one,
// for labels that the model does not know, and for ideal signals where the
// model sees the load profile.
absl::StatusOr<Evaluation> EvaluateModel(
    const std::shared_ptr<const CompiledModel>& model,
    const std::vector<const LabelledContact*>& contacts, Algorithm algorithm,
    const ParallelFor& parallel);

// Every contact by models fitted to the other folds. LSTMs are trained only
// where they are asked for; fused is hmm if options.lstm.networks is 0.
absl::StatusOr<Evaluation> EvaluateProtocol(
    const std::vector<const LabelledContact*>& contacts, Protocol protocol,
    Algorithm algorithm, const FitOptions& options,
    const ParallelFor& parallel);

}  // namespace tactus
