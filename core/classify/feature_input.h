// File: feature_input.h
//
// From the three natural features to the inputs of the models, as the
// FeatureSpec says. Used on every frame and when fitting.
//
// Thread-safe: free functions without state. Nothing allocates.
#pragma once

#include <span>

#include "core/classify/model.h"

namespace tactus {

// The used feature number `index` before scaling: x or log(max(x, 0) + c).
double TransformFeature(const FeatureSpec& spec, size_t index,
                        const FeatureVector& features);

// Writes spec.features.size() scaled inputs to `out`.
void MakeInput(const FeatureSpec& spec,
               const std::vector<FeatureScaling>& scaling,
               const FeatureVector& features, std::span<double> out);

// INVALID_MODEL naming what is wrong.
absl::Status Validate(const FeatureSpec& spec, bool has_lstm);

}  // namespace tactus
