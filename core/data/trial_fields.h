// File: trial_fields.h
//
// The fields of a trial by which users select some (trial_filter.h).
//
//   TACTUS_RETURN_IF_ERROR(CheckTrialFields(filter.fields()));
//   const std::string value = TrialField(trial, "condition");
//
// Thread-safe: free functions without state.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "core/data/trial.h"

namespace tactus::internal {

// INVALID_CONFIG if one of them is none of: trial (its id), source, label,
// condition, object, group (the material), stiffness, velocity.
absl::Status CheckTrialFields(const std::vector<std::string>& fields);

// The value of such a field as text.
std::string TrialField(const Trial& trial, const std::string& field);

}  // namespace tactus::internal
