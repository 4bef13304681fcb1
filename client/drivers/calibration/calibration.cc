#include "client/drivers/calibration/calibration.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "client/drivers/calibration/tare.h"
#include "client/drivers/calibration/taxel_noise.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"

namespace tactus::internal::client {
namespace {

// `each` names what has a number.
absl::Status CheckNumbers(absl::string_view name,
                          const std::vector<double>& numbers, int count,
                          absl::string_view each, double least) {
  if (numbers.size() != static_cast<size_t>(count)) {
    return InvalidConfig(absl::StrCat("numbers of ", name), numbers.size(),
                         absl::StrCat(count, ", one per ", each));
  }
  for (const double number : numbers) {
    // Written so that a NaN fails.
    if (!(number >= least && number <= limits::kMaxTaxelValue)) {
      return InvalidConfig(
          name, number,
          absl::StrCat("from ", least, " to ", limits::kMaxTaxelValue));
    }
  }
  return absl::OkStatus();
}

absl::Status CheckTaxels(absl::string_view name, const std::vector<int>& taxels,
                         int count) {
  for (size_t i = 0; i < taxels.size(); ++i) {
    const int least = i == 0 ? 0 : taxels[i - 1] + 1;
    if (taxels[i] < least || taxels[i] >= count) {
      return InvalidConfig(name, taxels[i],
                           absl::StrCat("rising, below ", count));
    }
  }
  return absl::OkStatus();
}

// A skin that is not powered sends one number for ever, and its thresholds
// would lie one step above it.
absl::Status CheckChanges(const std::vector<ValueNoise>& noise,
                          const IdleFrames& idle) {
  size_t valid = 0;
  for (size_t i = 0; i < noise.size(); ++i) {
    if (!idle.valid(idle.TaxelOf(i))) continue;
    if (noise[i].changes > 0) return absl::OkStatus();
    ++valid;
  }
  valid /= idle.axes();
  return InvalidTrainingData(absl::StrCat(
      "no taxel of ", valid, " changed in ", idle.frames(),
      " frames, as of a skin without power: check that the skin has power, "
      "that "
      "its cable is in and that taxels change when pressed (tactus-stream "
      "--monitor shows them). If it always sends the same at rest, calibrate "
      "with --sweep=20 and press it then"));
}

// Curves are a matter of one axis, and matrices of three.
absl::Status CheckLoads(const Calibration& calibration) {
  const SkinLayout& layout = calibration.layout;
  const auto taxels = static_cast<size_t>(layout.taxels());
  if (layout.axes > 1 && !calibration.gains.empty()) {
    return InvalidConfig("gains", "given for three axes",
                         "empty: cross_axis makes their loads");
  }
  if (layout.axes == 1 && !calibration.cross_axis.empty()) {
    return InvalidConfig("cross_axis", "given for one axis",
                         "empty: gains make its loads");
  }
  if (!calibration.gains.empty() && calibration.gains.size() != taxels) {
    return InvalidConfig("gains", calibration.gains.size(),
                         absl::StrCat("none or ", taxels));
  }
  return CheckMatrices(calibration.cross_axis, taxels);
}

// Taxels that count in `layout` have a matrix if others do.
absl::Status CheckNoMatrixLacks(const Calibration& calibration,
                                const SkinLayout& layout) {
  if (calibration.cross_axis.empty()) return absl::OkStatus();
  const std::vector<uint8_t> mask =
      WithMasked(layout, calibration.faults.All()).mask;
  for (int i = 0; i < layout.taxels(); ++i) {
    if ((mask.empty() || mask[i] != 0) &&
        MatrixOf(calibration.cross_axis, i) == nullptr) {
      return InvalidConfig(
          absl::StrCat("cross_axis of taxel ", i), "absent",
          "given, by lines of this taxel or of * in the file of --loads, or "
          "the taxel masked");
    }
  }
  return absl::OkStatus();
}

// "3, signed, normal z".
std::string AxesOf(const SkinLayout& layout) {
  std::string text = absl::StrCat(layout.axes);
  const bool both_ways = layout.axes > 1 || layout.signed_values;
  if (layout.signed_values) absl::StrAppend(&text, ", signed");
  if (both_ways && layout.normal_axis) {
    absl::StrAppend(&text, ", normal ", kAxisNames[*layout.normal_axis]);
  }
  return text;
}

}  // namespace

absl::StatusOr<Calibration> Calibrate(const IdleFrames& idle,
                                      const CalibrateOptions& options) {
  const SkinInfo& info = idle.info();
  if (options.before != nullptr) {
    TACTUS_RETURN_IF_ERROR(
        CheckFits(*options.before, options.device, info.layout));
  }
  Calibration made;
  made.device = options.device;
  made.layout = info.layout;
  made.cross_axis = options.cross_axis;
  TACTUS_RETURN_IF_ERROR(CheckLoads(made));
  made.frames = static_cast<int64_t>(idle.frames());
  made.sample_rate_hz = info.sample_rate_hz;
  TACTUS_ASSIGN_OR_RETURN(made.baseline, Tare(idle, options.before));
  const std::vector<ValueNoise> noise = NoiseOf(idle, made.baseline);
  if (!options.pressed_later) {
    TACTUS_RETURN_IF_ERROR(CheckChanges(noise, idle));
  }
  for (const ValueNoise& value : noise) {
    made.deviation.push_back(value.deviation);
  }
  const TaxelThresholds thresholds =
      ThresholdsOf(idle, made.baseline, AxisLoads(made.layout, made.cross_axis),
                   options.least_margin);
  made.contact_threshold = thresholds.contact;
  made.onset_threshold = thresholds.onset;
  made.faults = FindFaults(idle, made.baseline, noise);
  return made;
}

absl::Status Validate(const Calibration& calibration) {
  TACTUS_RETURN_IF_ERROR(Validate(calibration.layout));
  const int count = calibration.layout.taxels();
  const int values = calibration.layout.values();
  if (const std::string fault =
          TextFault(calibration.device, limits::kMaxTrialTextBytes);
      !fault.empty()) {
    return InvalidConfig("device of the calibration",
                         Quoted(calibration.device), fault);
  }
  if (calibration.frames < 1) {
    return InvalidConfig("frames of the calibration", calibration.frames,
                         "1 or more");
  }
  const char* const per_value =
      calibration.layout.axes == 1 ? "taxel" : "taxel and axis";
  const double lowest = -limits::kMaxTaxelValue;
  TACTUS_RETURN_IF_ERROR(CheckNumbers("baseline", calibration.baseline, values,
                                      per_value, lowest));
  TACTUS_RETURN_IF_ERROR(
      CheckNumbers("deviation", calibration.deviation, values, per_value, 0));
  TACTUS_RETURN_IF_ERROR(CheckNumbers(
      "contact_threshold", calibration.contact_threshold, count, "taxel", 0));
  TACTUS_RETURN_IF_ERROR(CheckNumbers(
      "onset_threshold", calibration.onset_threshold, count, "taxel", 0));
  TACTUS_RETURN_IF_ERROR(CheckLoads(calibration));
  TACTUS_RETURN_IF_ERROR(
      CheckTaxels("dead taxels", calibration.faults.dead, count));
  TACTUS_RETURN_IF_ERROR(
      CheckTaxels("stuck taxels", calibration.faults.stuck, count));
  TACTUS_RETURN_IF_ERROR(
      CheckTaxels("noisy taxels", calibration.faults.noisy, count));
  return CheckNoMatrixLacks(calibration, calibration.layout);
}

absl::Status CheckFits(const Calibration& calibration,
                       const std::string& device, const SkinLayout& layout) {
  if (calibration.device != device) {
    return InvalidConfig(
        "device of the calibration", Quoted(calibration.device),
        absl::StrCat(Quoted(device),
                     ", the one in use; calibrate it, or give --device-id"));
  }
  const SkinLayout& made = calibration.layout;
  const auto text = [](const SkinLayout& skin) {
    return absl::StrCat(Quoted(skin.name), " of ", skin.rows, " x ",
                        skin.columns, " taxels in ",
                        skin.unit == TaxelUnit::kNewton ? "newtons" : "counts");
  };
  if (made.name != layout.name || made.rows != layout.rows ||
      made.columns != layout.columns || made.unit != layout.unit) {
    return InvalidConfig("skin of the calibration", text(made),
                         absl::StrCat(text(layout), ", the one in use"));
  }
  if (AxesOf(made) != AxesOf(layout)) {
    return InvalidConfig(
        "axes of the calibration", AxesOf(made),
        absl::StrCat(AxesOf(layout), ", those of the skin in use"));
  }
  return CheckNoMatrixLacks(calibration, layout);
}

SkinLayout WithMasked(SkinLayout layout, const std::vector<int>& taxels) {
  if (taxels.empty()) return layout;
  if (layout.mask.empty()) layout.mask.assign(layout.taxels(), 1);
  for (const int taxel : taxels) layout.mask[taxel] = 0;
  return layout;
}

LayoutThresholds ThresholdsFor(const Calibration& calibration, double scale) {
  const SkinLayout layout =
      WithMasked(calibration.layout, calibration.faults.All());
  LayoutThresholds found = {limits::kMinThreshold, limits::kMinThreshold};
  const auto load = [&](size_t taxel, double threshold) {
    return MatrixOf(calibration.cross_axis, taxel) != nullptr
               ? threshold
               : LoadOf(calibration, taxel, threshold, scale);
  };
  for (size_t i = 0; i < calibration.contact_threshold.size(); ++i) {
    if (!layout.mask.empty() && layout.mask[i] == 0) continue;
    found.contact_threshold = std::max(
        found.contact_threshold, load(i, calibration.contact_threshold[i]));
    found.onset_threshold = std::max(found.onset_threshold,
                                     load(i, calibration.onset_threshold[i]));
  }
  return found;
}

}  // namespace tactus::internal::client
