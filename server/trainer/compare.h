// File: compare.h
//
// Reports of evaluations, and the comparison of two models on the same
// contacts.
//
//   const v1::EvaluationReport report = ReportOf(evaluation, never_felt);
//   const v1::Comparison comparison =
//       Compare(current, candidate, never_felt, gate);
//
// Thread-safe: free functions without state.
#pragma once

#include <cstdint>
#include <vector>

#include "core/contacts/trained_on.h"
#include "core/eval/evaluation.h"
#include "tactus/v1/operations.pb.h"
#include "tactus/v1/storage.pb.h"

namespace tactus::internal::server {

// `never_felt`: trials without a contact.
v1::EvaluationReport ReportOf(const Evaluation& evaluation,
                              uint32_t never_felt);

// Adds the contacts that were classified wrongly, the first
// limits::kMaxNamedTrials. `contacts` are those of the evaluation.
void AddWrongAnswers(const Evaluation& evaluation,
                     const std::vector<const LabelledContact*>& contacts,
                     v1::EvaluationReport& report);

// Adds which of the contacts the model was trained on, if that is known.
void AddTrainedOn(const TrainedOn& trained, v1::EvaluationReport& report);

// Both evaluations are of the same contacts in the same order, at least one.
// The candidate passes if none of accuracy, log-loss and calibration error is
// worse by more than the gate allows.
v1::Comparison Compare(const Evaluation& current, const Evaluation& candidate,
                       uint32_t never_felt, const v1::JobGate& gate);

// Two-sided p-value of the exact McNemar test: the probability that, of
// `first` + `second` fair coins, at least max(first, second) fall on one side.
// 1 if both are 0.
double McNemar(uint32_t first, uint32_t second);

}  // namespace tactus::internal::server
