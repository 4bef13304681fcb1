#include "core/data/trial_csv.h"

#include <charconv>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::internal {
namespace {

template <typename Number>
void AppendNumber(Number value, std::string* out) {
  char digits[32];
  const std::to_chars_result end =
      std::to_chars(digits, digits + sizeof digits, value);
  out->append(digits, end.ptr);
}

std::string Attributes(const Trial& trial) {
  std::string text;
  const std::pair<const char*, const std::string*> texts[] = {
      {"source", &trial.source},       {"label", &trial.label},
      {"condition", &trial.condition}, {"object", &trial.object},
      {"material", &trial.material},   {"unit", &trial.unit}};
  for (const auto& [key, value] : texts) {
    if (!value->empty()) absl::StrAppend(&text, "# ", key, "=", *value, "\n");
  }
  const std::pair<const char*, double> numbers[] = {
      {"stiffness", trial.stiffness},
      {"velocity", trial.velocity},
      {"sample_rate_hz", trial.sample_rate_hz}};
  for (const auto& [key, value] : numbers) {
    absl::StrAppend(&text, "# ", key, "=");
    AppendNumber(value, &text);
    text += '\n';
  }
  return text;
}

}  // namespace

absl::StatusOr<std::string> SignalsToCsv(const Trial& trial) {
  TACTUS_RETURN_IF_ERROR(Validate(trial, ".csv"));
  if (trial.signals.empty()) {
    return TrialFileInvalid(".csv",
                            absl::StrCat("trial ", trial.id,
                                         ": signals: "
                                         "missing; taxels are another table"));
  }
  std::string text = Attributes(trial) + "time,force,area,motion\n";
  for (size_t t = 0; t < trial.time.size(); ++t) {
    AppendNumber(trial.time[t], &text);
    for (const double value : trial.signals[t]) {
      text += ',';
      AppendNumber(value, &text);
    }
    text += '\n';
  }
  return text;
}

absl::StatusOr<std::string> TaxelsToCsv(const Trial& trial) {
  TACTUS_RETURN_IF_ERROR(Validate(trial, ".csv"));
  const TaxelSeries& taxels = trial.taxels;
  if (taxels.empty()) {
    return TrialFileInvalid(
        ".csv", absl::StrCat("trial ", trial.id, ": taxels: missing"));
  }
  std::string text = Attributes(trial) + "time";
  for (int row = 0; row < taxels.rows; ++row) {
    for (int column = 0; column < taxels.columns; ++column) {
      for (int axis = 0; axis < taxels.axes; ++axis) {
        absl::StrAppend(&text, ",r", row, "c", column);
        if (taxels.axes > 1) text += "xyz"[axis];
      }
    }
  }
  text += '\n';
  std::vector<float> frame(taxels.frame_size());
  for (size_t t = 0; t < trial.time.size(); ++t) {
    AppendNumber(trial.time[t], &text);
    taxels.Decode(t, frame.data());
    for (const float value : frame) {
      text += ',';
      AppendNumber(value, &text);
    }
    text += '\n';
  }
  return text;
}

}  // namespace tactus::internal
