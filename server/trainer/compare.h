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

#include "core/eval/evaluation.h"
#include "tactus/v1/operations.pb.h"
#include "tactus/v1/storage.pb.h"

namespace tactus::server {

// `never_felt`: trials without a contact.
v1::EvaluationReport ReportOf(const Evaluation& evaluation,
                              uint32_t never_felt);

// Both evaluations are of the same contacts in the same order, at least one.
// The candidate passes if none of accuracy, log-loss and calibration error is
// worse by more than the gate allows.
v1::Comparison Compare(const Evaluation& current, const Evaluation& candidate,
                       uint32_t never_felt, const v1::JobGate& gate);

// Two-sided p-value of the exact McNemar test: the probability that, of
// `first` + `second` fair coins, at least max(first, second) fall on one side.
// 1 if both are 0.
double McNemar(uint32_t first, uint32_t second);

}  // namespace tactus::server
