#include "core/interchange/model/inputs_json.h"

#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"

namespace tactus::internal {
namespace {

// A number of the object `json`; `absent` if there is no such key.
absl::StatusOr<double> Number(const OrderedJson& json, const char* key,
                              double absent) {
  const auto found = json.find(key);
  if (found == json.end()) return absent;
  if (found->is_number()) return found->get<double>();
  return InvalidModel(key, found->type_name(), "a number");
}

absl::StatusOr<ModelInput> ReadInput(const OrderedJson& json) {
  if (!json.is_object() || !json.contains("cue") || !json["cue"].is_string()) {
    return InvalidModel("inputs", json.type_name(), "objects with a cue");
  }
  const std::string name = json["cue"].get<std::string>();
  const std::optional<Cue> cue = ParseCue(name);
  if (!cue) return InvalidModel("inputs cue", name, "a known cue");
  ModelInput input{*cue};
  TACTUS_ASSIGN_OR_RETURN(input.log_offset, Number(json, "log_offset", 0));
  TACTUS_ASSIGN_OR_RETURN(input.offset, Number(json, "offset", 0));
  TACTUS_ASSIGN_OR_RETURN(input.gain, Number(json, "gain", 1));
  if (json.contains("limit") && !json["limit"].is_null()) {
    TACTUS_ASSIGN_OR_RETURN(input.limit, Number(json, "limit", 0));
  }
  return input;
}

absl::StatusOr<uint32_t> ReadInterval(const OrderedJson& json,
                                      const char* key) {
  TACTUS_ASSIGN_OR_RETURN(const double value, Number(json, key, 1));
  if (value >= 1 && value <= limits::kMaxResultIntervalFrames &&
      value == std::floor(value)) {
    return static_cast<uint32_t>(value);
  }
  return InvalidModel(
      key, value,
      absl::StrCat("a whole number, 1 to ", limits::kMaxResultIntervalFrames));
}

}  // namespace

void AddInputs(const std::vector<ModelInput>& inputs,
               const StepIntervals& steps, double sample_rate_hz,
               OrderedJson& out) {
  out["sample_rate_hz"] = sample_rate_hz;
  out["min_interval"] = steps.min;
  out["max_interval"] = steps.max;
  if (steps.first > 0) out["first_step"] = steps.first;
  if (steps.divisor != StepIntervals().divisor) {
    out["interval_divisor"] = steps.divisor;
  }
  OrderedJson& rows = out["inputs"] = OrderedJson::array();
  for (const ModelInput& input : inputs) {
    OrderedJson row = {{"cue", std::string(CueName(input.cue))},
                       {"log_offset", input.log_offset},
                       {"offset", input.offset},
                       {"gain", input.gain}};
    row["limit"] = std::isfinite(input.limit) ? OrderedJson(input.limit)
                                              : OrderedJson(nullptr);
    rows.push_back(std::move(row));
  }
}

absl::Status ReadInputs(const OrderedJson& json, ForeignModel* model) {
  TACTUS_ASSIGN_OR_RETURN(model->sample_rate_hz, Number(json, "sample_rate_hz",
                                                        model->sample_rate_hz));
  if (json.contains("min_interval") || json.contains("max_interval")) {
    StepIntervals steps;
    TACTUS_ASSIGN_OR_RETURN(steps.min, ReadInterval(json, "min_interval"));
    TACTUS_ASSIGN_OR_RETURN(steps.max, ReadInterval(json, "max_interval"));
    if (json.contains("first_step")) {
      TACTUS_ASSIGN_OR_RETURN(steps.first, ReadInterval(json, "first_step"));
    }
    if (json.contains("interval_divisor")) {
      TACTUS_ASSIGN_OR_RETURN(steps.divisor,
                              ReadInterval(json, "interval_divisor"));
    }
    model->steps = steps;
  }
  const auto inputs = json.find("inputs");
  if (inputs == json.end()) return absl::OkStatus();
  if (!inputs->is_array()) {
    return InvalidModel("inputs", inputs->type_name(), "a list");
  }
  for (const OrderedJson& row : *inputs) {
    TACTUS_ASSIGN_OR_RETURN(const ModelInput input, ReadInput(row));
    model->inputs.push_back(input);
  }
  return absl::OkStatus();
}

}  // namespace tactus::internal
