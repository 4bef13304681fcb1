// File: inputs_json.h
//
// What an exported file states about the inputs of its model, as JSON:
//
//   {"sample_rate_hz": 100, "min_interval": 5, "max_interval": 20,
//    "inputs": [{"cue": "log_spring", "log_offset": 0, "offset": 1.5,
//                "gain": 2, "limit": 5}, ...]}
//
// An input is (g(x) - offset) * gain, held within plus and minus `limit`
// (null: no limit); g(x) is x if log_offset is 0, else log(max(x, 0) +
// log_offset).
//
//   OrderedJson json = OrderedJson::object();
//   AddInputs(model.inputs.lstm, model.inputs.lstm_steps, /*rate=*/100, json);
//
// Thread-safe: free functions without state.
#pragma once

#include <vector>

#include "absl/status/status.h"
#include "core/classify/model.h"
#include "core/interchange/model/foreign_model.h"
#include "nlohmann/json.hpp"

namespace tactus::internal {

using OrderedJson = nlohmann::ordered_json;

// Sets the keys above in `out`, which is an object.
void AddInputs(const std::vector<ModelInput>& inputs,
               const StepIntervals& steps, double sample_rate_hz,
               OrderedJson& out);

// Reads those keys of `json`, which is an object, into `model`; a key that is
// absent changes nothing. INVALID_MODEL naming the key.
absl::Status ReadInputs(const OrderedJson& json, ForeignModel* model);

}  // namespace tactus::internal
