// File: choice_proto.h
//
// A PresetChoice as a message of the contract.
//
//   *result.mutable_preset_choice() = ToProto(choice);
//   const PresetChoice same = FromProto(result.preset_choice());
//
// Thread-safe: free functions without state.
#pragma once

#include "core/eval/auto_preset.h"
#include "tactus/v1/operations.pb.h"

namespace tactus::internal {

v1::PresetChoice ToProto(const PresetChoice& choice);

// Only learner and networks of the options are known.
PresetChoice FromProto(const v1::PresetChoice& proto);

}  // namespace tactus::internal
