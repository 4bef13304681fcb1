// File: evaluate_nearest.h
//
// The paper's baseline: features of the first frames, concatenated, PCA to
// 95 % of the variance, one nearest neighbour (Section "Implementation").
//
// Thread-safe: folds write to different places of the result.
#pragma once

#include <vector>

#include "absl/status/status.h"
#include "core/eval/evaluate.h"

namespace tactus {

// Fits to the contacts outside `fold` and writes outcomes of those in it. The
// probability of the neighbour's class is 1, for lack of better.
absl::Status EvaluateNearestFold(
    const std::vector<const LabelledContact*>& contacts,
    const std::vector<int>& fold, const std::vector<Feature>& features,
    Evaluation& result);

}  // namespace tactus
