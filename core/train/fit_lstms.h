// File: fit_lstms.h
//
// Training the LSTMs of a model: scaling, sequences and networks from the
// contacts alone.
//
// Thread-safe: free functions without state.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "core/classify/model.h"
#include "core/train/contact.h"
#include "core/train/fit.h"

namespace tactus {

// Adds `networks` LSTMs as `options.lstm` says to `model`, whose class names
// and rate are set, and a calibration that trusts them as they are.
absl::Status FitLstms(const std::vector<const Contact*>& contacts,
                      const FitOptions& options, int networks,
                      const ParallelFor& parallel, Model& model);

}  // namespace tactus
