#include "client/drivers/calibration/calibration_json.h"

#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/types/span.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/skin/layout_json.h"
#include "nlohmann/json.hpp"

namespace tactus::internal::client {
namespace {

using Json = nlohmann::json;

constexpr char kFormat[] = "tactus-calibration";
constexpr int kVersion = 1;

// JSON of text without control characters.
std::string TextJson(const std::string& text) {
  std::string json = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') json.push_back('\\');
    json.push_back(c);
  }
  return json + "\"";
}

// With all its bits: JSON's -0 is an integer, which has no sign.
void AppendExact(std::string* out, double number) {
  if (number == 0 && std::signbit(number)) {
    absl::StrAppend(out, "-0.0");
  } else {
    absl::StrAppendFormat(out, "%.17g", number);
  }
}

std::string NumbersJson(absl::Span<const double> numbers) {
  return absl::StrCat("[", absl::StrJoin(numbers, ",", AppendExact), "]");
}

std::string CurveJson(const std::optional<GainCurve>& curve) {
  if (!curve) return "null";
  const auto point = [](std::string* out, const GainPoint& p) {
    absl::StrAppendFormat(out, "[%.17g,%.17g]", p.reading, p.load);
  };
  return absl::StrCat("[", absl::StrJoin(curve->points(), ",", point), "]");
}

std::string MatrixJson(const std::optional<CrossAxis>& matrix) {
  if (!matrix) return "null";
  const auto row = [](std::string* out, const AxisVector& axes) {
    absl::StrAppend(out, NumbersJson(axes));
  };
  return absl::StrCat("[", absl::StrJoin(matrix->rows, ",", row), "]");
}

// Nothing without matrices, as before there were any.
std::string CrossAxisJson(const CrossAxes& matrices) {
  if (matrices.empty()) return "";
  const auto matrix = [](std::string* out,
                         const std::optional<CrossAxis>& one) {
    absl::StrAppend(out, MatrixJson(one));
  };
  return absl::StrCat("\n\"cross_axis\": [",
                      absl::StrJoin(matrices, ",", matrix), "],");
}

// Takes the parts out of an object. The first fault is kept.
class Parts {
 public:
  explicit Parts(const Json& object) : object_(object) {}

  const Json* Find(const char* name) {
    const auto found = object_.find(name);
    if (found != object_.end()) return &*found;
    Complain(name, "absent", "given");
    return nullptr;
  }
  double Number(const char* name) {
    const Json* json = Find(name);
    if (json == nullptr) return 0;
    if (!json->is_number()) Complain(name, json->type_name(), "a number");
    return json->is_number() ? json->get<double>() : 0;
  }
  int64_t Whole(const char* name) {
    const Json* json = Find(name);
    if (json == nullptr) return 0;
    const bool whole = json->is_number_integer();
    if (!whole) Complain(name, json->type_name(), "a whole number");
    return whole ? json->get<int64_t>() : 0;
  }
  std::string Text(const char* name) {
    const Json* json = Find(name);
    if (json == nullptr) return "";
    if (!json->is_string()) Complain(name, json->type_name(), "text");
    return json->is_string() ? json->get<std::string>() : "";
  }
  std::vector<double> Numbers(const char* name) {
    std::vector<double> numbers;
    const Json* json = Find(name);
    if (json == nullptr) return numbers;
    for (const Json& number : Elements(name, *json)) {
      if (!number.is_number()) {
        Complain(name, number.type_name(), "numbers");
        break;
      }
      numbers.push_back(number.get<double>());
    }
    return numbers;
  }
  std::vector<int> Taxels(const char* name) {
    std::vector<int> taxels;
    const Json* json = Find(name);
    if (json == nullptr) return taxels;
    for (const Json& taxel : Elements(name, *json)) {
      // Wider numbers would wrap around.
      if (!taxel.is_number_unsigned() ||
          taxel.get<uint64_t>() > (uint64_t{1} << 30)) {
        Complain(name, taxel.type_name(), "indices of taxels");
        break;
      }
      taxels.push_back(taxel.get<int>());
    }
    return taxels;
  }
  std::vector<std::optional<GainCurve>> Gains(const char* name) {
    std::vector<std::optional<GainCurve>> gains;
    const Json* json = Find(name);
    if (json == nullptr) return gains;
    for (const Json& curve : Elements(name, *json)) {
      if (curve.is_null()) {
        gains.emplace_back();
        continue;
      }
      auto made = GainCurve::Make(Points(name, curve));
      if (!made.ok()) {
        if (fault_.ok()) fault_ = made.status();
        break;
      }
      gains.push_back(*std::move(made));
    }
    return gains;
  }

  // Empty if absent, as in files of one axis.
  CrossAxes Matrices(const char* name) {
    CrossAxes matrices;
    if (!object_.contains(name)) return matrices;
    for (const Json& matrix : Elements(name, object_.at(name))) {
      matrices.emplace_back();
      if (!matrix.is_null()) matrices.back() = Matrix(name, matrix);
    }
    return matrices;
  }

  const absl::Status& fault() const { return fault_; }
  void Complain(const char* name, absl::string_view got,
                absl::string_view want) {
    if (fault_.ok()) fault_ = InvalidConfig(name, got, want);
  }

 private:
  // No elements, and a fault, unless `json` is a list.
  Json::array_t Elements(const char* name, const Json& json) {
    if (json.is_array()) return json.get<Json::array_t>();
    Complain(name, json.type_name(), "a list");
    return {};
  }
  std::vector<GainPoint> Points(const char* name, const Json& curve) {
    std::vector<GainPoint> points;
    for (const Json& point : Elements(name, curve)) {
      if (!point.is_array() || point.size() != 2 || !point[0].is_number() ||
          !point[1].is_number()) {
        Complain(name, point.type_name(), "pairs of reading and load");
        break;
      }
      points.push_back({point[0].get<double>(), point[1].get<double>()});
    }
    return points;
  }

  CrossAxis Matrix(const char* name, const Json& json) {
    CrossAxis matrix;
    const Json::array_t rows = Elements(name, json);
    bool fits = rows.size() == kMostAxes;
    for (size_t i = 0; i < kMostAxes && fits; ++i) {
      fits = rows[i].is_array() && rows[i].size() == kMostAxes;
      for (size_t j = 0; j < kMostAxes && fits; ++j) {
        fits = rows[i][j].is_number();
        if (fits) matrix.rows[i][j] = rows[i][j].get<double>();
      }
    }
    if (!fits) Complain(name, "another list", "3 rows of 3 numbers per taxel");
    return matrix;
  }

  const Json& object_;
  absl::Status fault_;
};

}  // namespace

std::string CalibrationToJson(const Calibration& calibration) {
  const auto taxels = [](const std::vector<int>& list) {
    return absl::StrCat("[", absl::StrJoin(list, ","), "]");
  };
  const auto curve = [](std::string* out,
                        const std::optional<GainCurve>& gain) {
    absl::StrAppend(out, CurveJson(gain));
  };
  return absl::StrCat(
      "{\n\"format\": \"", kFormat, "\",\n\"version\": ", kVersion,
      ",\n\"device\": ", TextJson(calibration.device),
      ",\n\"layout\": ", LayoutToJson(calibration.layout),
      ",\n\"created_ms\": ", calibration.created_ms,
      ",\n\"frames\": ", calibration.frames, ",\n\"sample_rate_hz\": ",
      absl::StrFormat("%.17g", calibration.sample_rate_hz),
      ",\n\"baseline\": ", NumbersJson(calibration.baseline),
      ",\n\"deviation\": ", NumbersJson(calibration.deviation),
      ",\n\"contact_threshold\": ", NumbersJson(calibration.contact_threshold),
      ",\n\"onset_threshold\": ", NumbersJson(calibration.onset_threshold),
      ",\n\"gains\": [", absl::StrJoin(calibration.gains, ",", curve), "],",
      CrossAxisJson(calibration.cross_axis),
      "\n\"dead\": ", taxels(calibration.faults.dead),
      ",\n\"stuck\": ", taxels(calibration.faults.stuck),
      ",\n\"noisy\": ", taxels(calibration.faults.noisy), "\n}\n");
}

absl::Status CheckDepth(absl::string_view json) {
  constexpr int kMostDepth = 32;
  int depth = 0;
  bool in_text = false;
  for (size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (in_text && c == '\\') ++i;
    if (c == '"') in_text = !in_text;
    if (in_text) continue;
    depth += c == '[' || c == '{';
    depth -= c == ']' || c == '}';
    if (depth > kMostDepth) {
      return InvalidConfig("depth of brackets", absl::StrCat(depth, " or more"),
                           absl::StrCat("at most ", kMostDepth));
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<Calibration> CalibrationFromJson(absl::string_view json) {
  TACTUS_RETURN_IF_ERROR(CheckDepth(json));
  const Json object = Json::parse(json.begin(), json.end(), nullptr,
                                  /*allow_exceptions=*/false);
  if (!object.is_object()) {
    return InvalidConfig("calibration", "no JSON", "an object in JSON");
  }
  Parts parts(object);
  if (parts.Text("format") != kFormat) {
    parts.Complain("format", "another", kFormat);
  }
  if (parts.Whole("version") != kVersion) {
    parts.Complain("version", "another", absl::StrCat(kVersion));
  }
  Calibration made;
  made.device = parts.Text("device");
  const Json* layout = parts.Find("layout");
  made.created_ms = parts.Whole("created_ms");
  made.frames = parts.Whole("frames");
  made.sample_rate_hz = parts.Number("sample_rate_hz");
  made.baseline = parts.Numbers("baseline");
  made.deviation = parts.Numbers("deviation");
  made.contact_threshold = parts.Numbers("contact_threshold");
  made.onset_threshold = parts.Numbers("onset_threshold");
  made.gains = parts.Gains("gains");
  made.cross_axis = parts.Matrices("cross_axis");
  made.faults = {parts.Taxels("dead"), parts.Taxels("stuck"),
                 parts.Taxels("noisy")};
  TACTUS_RETURN_IF_ERROR(parts.fault());
  // Text that is not UTF-8 is not JSON, so this cannot throw.
  TACTUS_ASSIGN_OR_RETURN(made.layout,
                          LayoutFromJson(layout->dump(
                              -1, ' ', false, Json::error_handler_t::replace)));
  TACTUS_RETURN_IF_ERROR(Validate(made));
  return made;
}

}  // namespace tactus::internal::client
