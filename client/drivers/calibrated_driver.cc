#include "client/drivers/calibrated_driver.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/drivers/calibration/tare.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"

namespace tactus::internal::client {
namespace {

// The frames of a tare may take this many times as long as at the skin's rate,
// and this much longer.
constexpr double kTareTimes = 2;
constexpr double kTareExtraS = 5;

}  // namespace

CalibratedDriver::CalibratedDriver(SkinDriver* driver,
                                   CalibratedDriverOptions options,
                                   Clock* clock)
    : driver_(driver), options_(std::move(options)), clock_(clock) {}

absl::StatusOr<SkinInfo> CalibratedDriver::OnConfigure() {
  const auto& calibration = options_.calibration;
  if (!calibration && options_.tare_frames == 0 && options_.tare.empty()) {
    return InvalidConfig("calibration", "absent", "given, or a tare");
  }
  if (options_.tare_frames > 0 && options_.tare_frames < kMinTareFrames) {
    return InvalidConfig("frames of a tare", options_.tare_frames,
                         absl::StrCat(kMinTareFrames, " or more"));
  }
  if (options_.drift_time_s > 0 && !calibration) {
    return InvalidConfig("calibration", "absent",
                         "given to follow the drift: it has the thresholds "
                         "that show a contact");
  }
  TACTUS_ASSIGN_OR_RETURN(raw_info_, driver_->Configure());
  layout_ = raw_info_.layout;
  const auto values = static_cast<size_t>(layout_.values());
  gate_.assign(layout_.taxels(), 0);
  baseline_.assign(values, 0);
  numbers_.resize(values);
  above_.resize(values);
  if (calibration) {
    TACTUS_RETURN_IF_ERROR(CheckFits(*calibration, options_.device, layout_));
    layout_ = WithMasked(std::move(layout_), calibration->faults.All());
    baseline_ = calibration->baseline;
    if (!layout_.light_touch) gate_ = calibration->contact_threshold;
  }
  loads_.emplace(layout_, calibration ? calibration->cross_axis : CrossAxes());
  if (!options_.tare.empty()) {
    if (options_.tare.size() != values) {
      return InvalidConfig("numbers of the earlier tare", options_.tare.size(),
                           absl::StrCat(values));
    }
    baseline_ = options_.tare;
    tared_ = true;
  }
  SkinInfo info = raw_info_;
  info.layout = layout_;
  info.taxel_type = v1::TAXEL_TYPE_FLOAT32;
  info.scale = 1;
  return info;
}

absl::Status CalibratedDriver::OnActivate() {
  TACTUS_RETURN_IF_ERROR(driver_->Activate());
  if (options_.drift_time_s > 0) {
    drift_.emplace(
        baseline_.size(),
        DriftTracker::Options{.time_s = options_.drift_time_s,
                              .sample_rate_hz = raw_info_.sample_rate_hz});
    touch_.emplace(*options_.calibration);
  }
  if (options_.tare_frames == 0) return absl::OkStatus();
  const absl::Status tared = TareNow();
  if (!tared.ok()) driver_->Deactivate().IgnoreError();
  return tared;
}

absl::Status CalibratedDriver::TareNow() {
  SkinInfo info = raw_info_;
  info.layout = layout_;
  IdleFrames idle(info, options_.tare_frames);
  const double seconds =
      kTareExtraS + kTareTimes * static_cast<double>(options_.tare_frames) /
                        raw_info_.sample_rate_hz;
  const int64_t end_ns = clock_->NowNs() + std::llround(1e9 * seconds);
  while (!idle.complete()) {
    TACTUS_ASSIGN_OR_RETURN(const ReadResult result, driver_->Read(raw_));
    if (result == ReadResult::kFrame) idle.Add(raw_);
    if (result == ReadResult::kEndOfData || clock_->NowNs() > end_ns) {
      return IoError("tare",
                     absl::StrCat("only ", idle.frames(), " of ",
                                  options_.tare_frames, " frames came"));
    }
  }
  TACTUS_ASSIGN_OR_RETURN(
      baseline_,
      Tare(idle, options_.calibration ? &*options_.calibration : nullptr));
  tared_ = true;
  return absl::OkStatus();
}

CalibrationInUse CalibratedDriver::in_use() const {
  return {.device = options_.device,
          .calibration = options_.calibration,
          .tare = tared_ ? baseline_ : std::vector<double>(),
          .drift_time_s = options_.drift_time_s};
}

absl::StatusOr<ReadResult> CalibratedDriver::OnRead(SkinFrame& frame) {
  TACTUS_ASSIGN_OR_RETURN(const ReadResult result, driver_->Read(raw_));
  if (result == ReadResult::kFrame) Convert(frame);
  return result;
}

void CalibratedDriver::Convert(SkinFrame& frame) {
  RawValues(raw_info_, raw_, numbers_);
  for (size_t i = 0; i < numbers_.size(); ++i) {
    above_[i] = numbers_[i] - baseline_[i];
  }
  if (drift_) {
    drift_->Step(above_, *touch_, layout_.mask);
    for (size_t i = 0; i < above_.size(); ++i) above_[i] -= drift_->drift()[i];
  }
  frame.capture_time_ns = raw_.capture_time_ns;
  frame.missing_before = raw_.missing_before;
  frame.pose = raw_.pose;
  frame.u16.clear();
  frame.i16.clear();
  frame.f32.resize(numbers_.size());
  const size_t axes = loads_->axes();
  for (size_t taxel = 0; taxel < gate_.size(); ++taxel) {
    const AxisVector loads = loads_->Of(taxel, above_);
    const bool felt = loads_->Normal(loads) >= gate_[taxel];
    for (size_t axis = 0; axis < axes; ++axis) {
      frame.f32[axes * taxel + axis] = felt ? LoadAlong(taxel, loads[axis]) : 0;
    }
  }
}

float CalibratedDriver::LoadAlong(size_t taxel, double load) const {
  if (loads_->Matrix(taxel) == nullptr) {
    load = options_.calibration
               ? LoadOf(*options_.calibration, taxel, load, raw_info_.scale)
               : load * raw_info_.scale;
  }
  const double most = limits::kMaxTaxelValue;
  const double least = layout_.signed_values ? -most : 0;
  // The sum has no negative zero.
  return static_cast<float>(std::clamp(load, least, most)) + 0.0F;
}

DriverStatistics CalibratedDriver::Statistics() const {
  DriverStatistics statistics = driver_->Statistics();
  if (!options_.calibration) return statistics;
  const std::vector<int> faulty = options_.calibration->faults.All();
  if (faulty.empty()) return statistics;
  std::erase_if(statistics.stuck_taxels, [&](int taxel) {
    return std::ranges::binary_search(faulty, taxel);
  });
  absl::StrAppend(&statistics.remarks, statistics.remarks.empty() ? "" : "; ",
                  "faulty taxels masked: ", absl::StrJoin(faulty, ", "));
  return statistics;
}

}  // namespace tactus::internal::client
