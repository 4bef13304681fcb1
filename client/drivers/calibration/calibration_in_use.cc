#include "client/drivers/calibration/calibration_in_use.h"

#include <cmath>

#include "client/drivers/calibration/calibration_json.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "nlohmann/json.hpp"

namespace tactus::internal::client {
namespace {

using InUseJson = nlohmann::json;

constexpr char kInUseFormat[] = "tactus-calibration-in-use";
constexpr int kInUseVersion = 1;

std::string TextOf(const InUseJson* json) {
  return json->dump(-1, ' ', false, InUseJson::error_handler_t::replace);
}

// A list of finite numbers.
bool IsTare(const InUseJson& list) {
  if (!list.is_array()) return false;
  for (const InUseJson& number : list) {
    if (!number.is_number() || !std::isfinite(number.get<double>())) {
      return false;
    }
  }
  return true;
}

}  // namespace

std::string ToJson(const CalibrationInUse& in_use) {
  InUseJson json = {
      {"format", kInUseFormat},  {"version", kInUseVersion},
      {"device", in_use.device}, {"calibration", nullptr},
      {"tare", in_use.tare},     {"drift_s", in_use.drift_time_s}};
  if (in_use.calibration) {
    json["calibration"] =
        InUseJson::parse(CalibrationToJson(*in_use.calibration));
  }
  return TextOf(&json);
}

absl::StatusOr<CalibrationInUse> CalibrationInUseFromJson(
    absl::string_view json) {
  TACTUS_RETURN_IF_ERROR(CheckDepth(json));
  const InUseJson object = InUseJson::parse(json.begin(), json.end(), nullptr,
                                            /*allow_exceptions=*/false);
  const auto part = [&](const char* name) -> const InUseJson& {
    static const auto* const none = new InUseJson();
    const auto found = object.find(name);
    return found == object.end() ? *none : *found;
  };
  if (!object.is_object()) {
    return InvalidConfig("calibration in use", "no JSON", "an object in JSON");
  }
  if (part("format") != kInUseFormat || part("version") != kInUseVersion) {
    return InvalidConfig("format and version", "others",
                         absl::StrCat(kInUseFormat, ", ", kInUseVersion));
  }
  if (!part("device").is_string()) {
    return InvalidConfig("device", part("device").type_name(), "text");
  }
  if (!IsTare(part("tare"))) {
    return InvalidConfig("tare", part("tare").type_name(), "a list of numbers");
  }
  const InUseJson& drift = part("drift_s");
  // Written so that NaN is refused.
  if (!drift.is_number() || !(drift.get<double>() >= 0)) {
    return InvalidConfig("drift_s", drift.type_name(), "a number from 0 on");
  }
  CalibrationInUse in_use;
  in_use.device = part("device").get<std::string>();
  in_use.tare = part("tare").get<std::vector<double>>();
  in_use.drift_time_s = drift.get<double>();
  const InUseJson& calibration = part("calibration");
  if (!calibration.is_null()) {
    TACTUS_ASSIGN_OR_RETURN(in_use.calibration,
                            CalibrationFromJson(TextOf(&calibration)));
    const size_t taxels = in_use.calibration->baseline.size();
    if (!in_use.tare.empty() && in_use.tare.size() != taxels) {
      return InvalidConfig("numbers of tare", in_use.tare.size(),
                           absl::StrCat(taxels));
    }
  }
  return in_use;
}

}  // namespace tactus::internal::client
