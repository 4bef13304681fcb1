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

// Readers take a double and round it to a float. Where the shortest digits of
// the float would then be rounded twice to another one, its digits as a double
// are written.
void AppendFloat(float value, std::string* out) {
  const size_t begin = out->size();
  AppendNumber(value, out);
  double read = 0;
  std::from_chars(out->data() + begin, out->data() + out->size(), read);
  if (static_cast<float>(read) == value) return;
  out->resize(begin);
  AppendNumber(static_cast<double>(value), out);
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
  if (!trial.touches.empty()) {
    return TrialFileInvalid(
        ".csv", absl::StrCat("trial ", trial.id,
                             ": touches: a table has one contact; export npz, "
                             "zarr or hdf5"));
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

std::string TaxelColumn(const TaxelSeries& taxels, size_t place) {
  const size_t taxel = place / taxels.axes;
  return absl::StrCat(
      "r", taxel / taxels.columns, "c", taxel % taxels.columns,
      taxels.axes > 1 ? absl::string_view("xyz").substr(place % taxels.axes, 1)
                      : "");
}

absl::StatusOr<std::string> FramesToCsv(const Trial& trial,
                                        std::span<const size_t> places) {
  TACTUS_RETURN_IF_ERROR(Validate(trial, ".csv"));
  const TaxelSeries& taxels = trial.taxels;
  if (taxels.empty()) {
    return TrialFileInvalid(
        ".csv", absl::StrCat("trial ", trial.id, ": taxels: missing"));
  }
  std::string text = "time";
  for (const size_t place : places) {
    absl::StrAppend(&text, ",", TaxelColumn(taxels, place));
  }
  absl::StrAppend(&text, trial.poses.empty() ? "" : ",x,y,z,qx,qy,qz,qw", "\n");
  std::vector<float> frame(taxels.frame_size());
  for (size_t t = 0; t < trial.time.size(); ++t) {
    AppendNumber(trial.time[t], &text);
    taxels.Decode(t, frame.data());
    for (const size_t place : places) {
      text += ',';
      AppendFloat(frame[place], &text);
    }
    if (!trial.poses.empty()) {
      const Pose& pose = trial.poses[t];
      const Eigen::Quaterniond& q = pose.orientation;
      for (const double value :
           {pose.position.x(), pose.position.y(), pose.position.z(), q.x(),
            q.y(), q.z(), q.w()}) {
        text += ',';
        AppendNumber(value, &text);
      }
    }
    text += '\n';
  }
  return text;
}

}  // namespace tactus::internal
