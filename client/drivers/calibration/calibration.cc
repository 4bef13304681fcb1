#include "client/drivers/calibration/calibration.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "client/drivers/calibration/tare.h"
#include "client/drivers/one_axis.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"

namespace tactus::internal::client {
namespace {

absl::Status CheckNumbers(absl::string_view name,
                          const std::vector<double>& numbers, size_t taxels,
                          double least) {
  if (numbers.size() != taxels) {
    return InvalidConfig(absl::StrCat("numbers of ", name), numbers.size(),
                         absl::StrCat(taxels, ", one per taxel"));
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
absl::Status CheckChanges(const std::vector<TaxelNoise>& noise,
                          const IdleFrames& idle) {
  size_t valid = 0;
  for (size_t i = 0; i < noise.size(); ++i) {
    if (!idle.valid(i)) continue;
    if (noise[i].changes > 0) return absl::OkStatus();
    ++valid;
  }
  return InvalidTrainingData(absl::StrCat(
      "no taxel of ", valid, " changed in ", idle.frames(),
      " frames, as of a skin without power: check that the skin has power, "
      "that "
      "its cable is in and that taxels change when pressed (tactus-stream "
      "--monitor shows them). If it always sends the same at rest, calibrate "
      "with --sweep=20 and press it then"));
}

}  // namespace

absl::StatusOr<Calibration> Calibrate(const IdleFrames& idle,
                                      const CalibrateOptions& options) {
  const SkinInfo& info = idle.info();
  TACTUS_RETURN_IF_ERROR(CheckOneAxis("a calibration", info.layout));
  std::optional<EarlierBaseline> earlier;
  if (options.before != nullptr) {
    TACTUS_RETURN_IF_ERROR(
        CheckFits(*options.before, options.device, info.layout));
    earlier = {options.before->baseline, options.before->contact_threshold};
  }
  Calibration made;
  made.device = options.device;
  made.layout = info.layout;
  made.frames = static_cast<int64_t>(idle.frames());
  made.sample_rate_hz = info.sample_rate_hz;
  TACTUS_ASSIGN_OR_RETURN(made.baseline,
                          Tare(idle, earlier ? &*earlier : nullptr));
  const std::vector<TaxelNoise> noise =
      NoiseOf(idle, made.baseline, options.least_margin);
  if (!options.pressed_later) {
    TACTUS_RETURN_IF_ERROR(CheckChanges(noise, idle));
  }
  for (const TaxelNoise& taxel : noise) {
    made.deviation.push_back(taxel.deviation);
    made.contact_threshold.push_back(taxel.contact_threshold);
    made.onset_threshold.push_back(taxel.onset_threshold);
  }
  made.faults = FindFaults(idle, made.baseline, noise);
  return made;
}

absl::Status Validate(const Calibration& calibration) {
  TACTUS_RETURN_IF_ERROR(Validate(calibration.layout));
  TACTUS_RETURN_IF_ERROR(CheckOneAxis("a calibration", calibration.layout));
  const int count = calibration.layout.taxels();
  const auto taxels = static_cast<size_t>(count);
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
  const double lowest = -limits::kMaxTaxelValue;
  TACTUS_RETURN_IF_ERROR(
      CheckNumbers("baseline", calibration.baseline, taxels, lowest));
  TACTUS_RETURN_IF_ERROR(
      CheckNumbers("deviation", calibration.deviation, taxels, 0));
  TACTUS_RETURN_IF_ERROR(CheckNumbers(
      "contact_threshold", calibration.contact_threshold, taxels, 0));
  TACTUS_RETURN_IF_ERROR(
      CheckNumbers("onset_threshold", calibration.onset_threshold, taxels, 0));
  if (!calibration.gains.empty() && calibration.gains.size() != taxels) {
    return InvalidConfig("gains", calibration.gains.size(),
                         absl::StrCat("none or ", taxels));
  }
  TACTUS_RETURN_IF_ERROR(
      CheckTaxels("dead taxels", calibration.faults.dead, count));
  TACTUS_RETURN_IF_ERROR(
      CheckTaxels("stuck taxels", calibration.faults.stuck, count));
  return CheckTaxels("noisy taxels", calibration.faults.noisy, count);
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
  return absl::OkStatus();
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
  for (size_t i = 0; i < calibration.baseline.size(); ++i) {
    if (!layout.mask.empty() && layout.mask[i] == 0) continue;
    found.contact_threshold = std::max(
        found.contact_threshold,
        LoadOf(calibration, i, calibration.contact_threshold[i], scale));
    found.onset_threshold =
        std::max(found.onset_threshold,
                 LoadOf(calibration, i, calibration.onset_threshold[i], scale));
  }
  return found;
}

}  // namespace tactus::internal::client
