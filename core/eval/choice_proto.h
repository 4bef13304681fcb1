// File: choice_proto.h
//
// A PresetChoice as a message of the contract, and the request for one.
//
//   *result.mutable_preset_choice() = ToProto(choice);
//   const PresetChoice same = FromProto(result.preset_choice());
//
// Thread-safe: free functions without state.
#pragma once

#include "core/eval/auto_preset.h"
#include "core/eval/chosen_options.h"
#include "tactus/v1/operations.pb.h"

namespace tactus::internal {

v1::PresetChoice ToProto(const PresetChoice& choice);

// Only learner and networks of the options are known.
PresetChoice FromProto(const v1::PresetChoice& proto);

// What a training asks for. `spec` outlives the request.
OptionsRequest RequestOf(const v1::TrainSpec& spec);

}  // namespace tactus::internal
