// File: calibration.h
//
// Calibration: what was measured of the taxels of one skin: baselines, noise,
// thresholds, gain curves or cross-axis matrices, and faults. All numbers but
// loads are those that the skin sends.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       const Calibration calibration,
//       Calibrate(idle, {.device = "serial usb-Arduino_7523-if00"}));
//   TACTUS_RETURN_IF_ERROR(CheckFits(calibration, device, info.layout));
//
// Plain data and free functions without state; thread-safe.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/drivers/calibration/cross_axis.h"
#include "client/drivers/calibration/gain_curve.h"
#include "client/drivers/calibration/idle_frames.h"
#include "client/drivers/calibration/taxel_faults.h"
#include "core/skin/layout.h"

namespace tactus::internal::client {

struct Calibration {
  // Names the skin and how it is connected.
  std::string device;
  // The skin as it was configured.
  SkinLayout layout;
  // Milliseconds since the beginning of 1970; 0 if unknown.
  int64_t created_ms = 0;
  // Frames that were measured, and their rate.
  int64_t frames = 0;
  double sample_rate_hz = 0;
  // One number per value of a frame, in its order: per taxel and axis.
  std::vector<double> baseline;
  std::vector<double> deviation;
  // One number per taxel, above the baseline: its load as AxisLoads makes it,
  // in the layout's unit if there are cross-axis matrices.
  std::vector<double> contact_threshold;
  std::vector<double> onset_threshold;
  // Empty: a load is the layout's scale times the reading. Else one per taxel;
  // nothing for taxels without a curve. Empty for three axes.
  std::vector<std::optional<GainCurve>> gains;
  // Empty: a load is the layout's scale times the reading along the same axis.
  // Else taxels without a matrix are masked or faulty. Empty for one axis.
  CrossAxes cross_axis;
  TaxelFaults faults;

  bool operator==(const Calibration&) const = default;
};

struct CalibrateOptions {
  std::string device = {};
  // A calibration of the same skin, with which a touch is known more surely.
  // May be null.
  const Calibration* before = nullptr;
  // The skin may read one number at rest, because the caller sees that it
  // changes when pressed. Else that is refused.
  bool pressed_later = false;
  // Thresholds lie at least so far above the noise, in the skin's numbers.
  double least_margin = 0;
  // Those of the calibration.
  CrossAxes cross_axis = {};
};

// The calibration of a skin that nothing touches. INVALID_CONFIG if `before`
// does not fit or there are not as many matrices as the skin takes;
// INVALID_TRAINING_DATA if no taxel that the layout does not mask ever changed
// and `pressed_later` is not set; else the errors of Tare.
absl::StatusOr<Calibration> Calibrate(const IdleFrames& idle,
                                      const CalibrateOptions& options);

// OK if every part is in range and has as many elements as it must; else
// INVALID_CONFIG.
absl::Status Validate(const Calibration& calibration);

// OK if the calibration is one of this device and of a skin of this name,
// shape, axes and unit, and has a matrix, if any, for each taxel that counts;
// else INVALID_CONFIG. Thresholds, lengths and masks of the layout may differ.
absl::Status CheckFits(const Calibration& calibration,
                       const std::string& device, const SkinLayout& layout);

// The layout with the taxels of `taxels` masked, and those it masks already.
SkinLayout WithMasked(SkinLayout layout, const std::vector<int>& taxels);

// The calibrated layout's contact and onset thresholds, in its unit: the
// largest ones of its taxels without faults. `scale` is that of the skin's
// numbers.
struct LayoutThresholds {
  double contact_threshold = 0;
  double onset_threshold = 0;
};
LayoutThresholds ThresholdsFor(const Calibration& calibration, double scale);

// The load of a reading above the baseline of taxel `taxel`, which has no
// matrix.
inline double LoadOf(const Calibration& calibration, size_t taxel,
                     double reading, double scale) {
  if (calibration.gains.empty() || !calibration.gains[taxel]) {
    return reading * scale;
  }
  return calibration.gains[taxel]->Load(reading);
}

}  // namespace tactus::internal::client
