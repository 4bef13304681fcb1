// File: evaluate.h
//
// Measures how well contacts are classified: by a given model, or by a protocol
// that fits models to some folds and tests them on the others.
//
//   auto result = EvaluateProtocol(contacts, Protocol::kLeaveOneConditionOut,
//                                  Algorithm::kFused, options, RunSerially);
//   Accuracy(result->final);
//
// Contacts must outlive the call. Thread-safe: free functions without state.
#pragma once

#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/work.h"
#include "core/classify/compiled_model.h"
#include "core/contacts/folds.h"
#include "core/contacts/labelled_contact.h"
#include "core/eval/evaluation.h"
#include "core/train/fit.h"

namespace tactus::internal {

// The algorithm that a server answers with by default.
inline Algorithm ServedAlgorithm(bool has_lstms) {
  return has_lstms ? Algorithm::kFused : Algorithm::kHmm;
}

// Classifies every contact with one model. kFused runs kHmm if the model has
// no LSTMs. INVALID_CONFIG for kNearest, for kLstm without LSTMs, for labels
// that are no class of the model, and for ideal signals if the model needs the
// load profile.
absl::StatusOr<Evaluation> EvaluateModel(
    const std::shared_ptr<const CompiledModel>& model,
    const std::vector<const LabelledContact*>& contacts, Algorithm algorithm,
    const ParallelFor& parallel, const Progress& progress = {});

// Classifies every contact with a model fitted to the other folds. kFused runs
// kHmm if options.lstm.networks is 0. kHmm trains no LSTMs.
absl::StatusOr<Evaluation> EvaluateProtocol(
    const std::vector<const LabelledContact*>& contacts, Protocol protocol,
    Algorithm algorithm, const FitOptions& options, const ParallelFor& parallel,
    const Progress& progress = {});

}  // namespace tactus::internal
