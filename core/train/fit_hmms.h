// File: fit_hmms.h
//
// The uncalibrated part of a fit: scaling and HMMs from the contacts alone.
//
// Thread-safe: free functions without state.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "core/train/fit.h"

namespace tactus {

// A model with features, scaling and HMMs, a uniform prior and temperature 1;
// `class_names` fixes the order. Each class must have a contact.
absl::StatusOr<Model> FitHmms(const std::vector<const Contact*>& contacts,
                              const std::vector<std::string>& class_names,
                              const FitOptions& options);

}  // namespace tactus
