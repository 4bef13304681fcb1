// File: evaluate_nearest.h
//
// The paper's baseline within a protocol: principal components and one nearest
// neighbour, on fixed windows of the raw features (core/nearest). Each of
// kAnytimeSeconds has its own window, so an early answer uses early frames
// only.
//
//   TACTUS_RETURN_IF_ERROR(
//       EvaluateNearestFold(contacts, folds[f], features, result));
//
// EvaluateProtocol calls this once per fold. Writes only the outcomes of the
// fold's contacts, so folds may run on several threads at once.
#pragma once

#include <vector>

#include "absl/status/status.h"
#include "core/contacts/labelled_contact.h"
#include "core/eval/evaluation.h"
#include "core/features/feature.h"

namespace tactus::internal {

// Writes result.final and result.anytime of the contacts in `fold`, as answered
// by all contacts that are not in it. `result` holds the labels of all
// contacts. The class of the neighbour has probability 1, because one neighbour
// gives no better estimate.
absl::Status EvaluateNearestFold(
    const std::vector<const LabelledContact*>& contacts,
    const std::vector<int>& fold, const std::vector<Feature>& features,
    Evaluation& result);

}  // namespace tactus::internal
