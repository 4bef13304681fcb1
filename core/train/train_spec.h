// File: train_spec.h
//
// Training as a request describes it (proto/tactus/v1/operations.proto).
//
//   TACTUS_ASSIGN_OR_RETURN(FitOptions options, OptionsOf(spec));
//
// Thread-safe: a free function without state.
#pragma once

#include "absl/status/statusor.h"
#include "core/train/fit_options.h"
#include "tactus/v1/operations.pb.h"

namespace tactus {

// INVALID_CONFIG, which names the field.
absl::StatusOr<FitOptions> OptionsOf(const v1::TrainSpec& spec);

}  // namespace tactus
