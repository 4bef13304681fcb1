// File: train_spec.h
//
// Training as a request describes it (proto/tactus/v1/operations.proto).
//
//   TACTUS_RETURN_IF_ERROR(CheckOptions(spec));
//   TACTUS_ASSIGN_OR_RETURN(FitOptions options, OptionsOf(spec, "tuned"));
//
// Thread-safe: free functions without state.
#pragma once

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/train/fit_options.h"
#include "tactus/v1/operations.pb.h"

namespace tactus::internal {

// The options of `preset`, with what else the spec asks for. INVALID_CONFIG,
// which names the field.
absl::StatusOr<FitOptions> OptionsOf(const v1::TrainSpec& spec,
                                     absl::string_view preset);
// The same on top of other options than a preset's.
absl::StatusOr<FitOptions> ApplySpec(const v1::TrainSpec& spec,
                                     FitOptions options);

// OK if there are such options for the preset that the spec names, or leaves to
// be chosen.
absl::Status CheckOptions(const v1::TrainSpec& spec);

}  // namespace tactus::internal
