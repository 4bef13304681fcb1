// File: evaluation.h
//
// Evaluation: the outcomes of classifying labelled contacts, contact by
// contact. metrics.h sums them up.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       Evaluation result,
//       EvaluateModel(model, contacts, Algorithm::kFused, RunSerially));
//   AlgorithmName(result.algorithm);  // "hmm" if the model has no LSTMs
//   Accuracy(result.final);
//
// Plain data and free functions without state; thread-safe.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/classify/model.h"
#include "core/classify/object_estimate.h"
#include "core/contacts/anytime.h"
#include "core/eval/metrics.h"
#include "core/eval/question_outcome.h"
#include "core/questions/question.h"

namespace tactus::internal {

enum class Algorithm { kHmm, kLstm, kNearest, kFused };

// Parses "hmm", "lstm", "1nn" or "fused".
absl::StatusOr<Algorithm> ParseAlgorithm(absl::string_view name);

// The inverse of ParseAlgorithm.
absl::string_view AlgorithmName(Algorithm algorithm);

// An estimate of the object and the truth.
struct EstimateOutcome {
  ObjectEstimate estimate;
  double log10_stiffness = 0;
  double moved_m = 0;
};

// When a contact was decided, and whether the decision was true: in the end or
// at that time, as the model's truth is.
struct DecisionOutcome {
  double seconds = 0;  // since onset
  bool right = false;
};

struct Evaluation {
  // What ran: kHmm if kFused was asked for and there is no LSTM.
  Algorithm algorithm = Algorithm::kHmm;
  std::vector<std::string> class_names;
  // What the model's answers are about.
  Truth truth = Truth::kFinal;
  // One outcome per contact, in the order given, after its last frame.
  std::vector<Outcome> final;
  // [kAnytimeCount][contacts]: the outcomes at each of kAnytimeSeconds. A
  // contact that ends earlier has its last outcome.
  std::vector<std::vector<Outcome>> anytime;
  // The same of the HMMs alone and of the LSTMs alone; empty unless
  // `algorithm` is kFused.
  std::vector<std::vector<Outcome>> anytime_hmm;
  std::vector<std::vector<Outcome>> anytime_lstm;
  // [kAnytimeCount][contacts]: the class so far at each of these times. Empty
  // if the objects' motion is unknown.
  std::vector<std::vector<int>> so_far;
  // As `final` and `anytime`; nothing where the truth or the estimate is
  // missing.
  std::vector<std::optional<EstimateOutcome>> final_estimates;
  std::vector<std::vector<std::optional<EstimateOutcome>>> anytime_estimates;
  // The decisions of `algorithm`; nothing for contacts that it did not decide.
  std::vector<std::optional<DecisionOutcome>> decisions;
  // What the models are asked, and [questions][contacts] how the answers went.
  // Empty for kNearest, whose answers are no probabilities.
  std::vector<Question> questions;
  std::vector<std::vector<QuestionOutcome>> question_outcomes;
  // Probability that training had nothing like the contact, after its last
  // frame (UnknownProbability).
  std::vector<double> unknown;
};

}  // namespace tactus::internal
