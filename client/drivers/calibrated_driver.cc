#include "client/drivers/calibrated_driver.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/drivers/calibration/tare.h"
#include "client/drivers/one_axis.h"
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
  TACTUS_RETURN_IF_ERROR(CheckOneAxis("a calibrated skin", layout_));
  const auto taxels = static_cast<size_t>(layout_.taxels());
  gate_.assign(taxels, 0);
  baseline_.assign(taxels, 0);
  numbers_.resize(taxels);
  above_.resize(taxels);
  if (calibration) {
    TACTUS_RETURN_IF_ERROR(CheckFits(*calibration, options_.device, layout_));
    layout_ = WithMasked(std::move(layout_), calibration->faults.All());
    baseline_ = calibration->baseline;
    if (!layout_.light_touch) gate_ = calibration->contact_threshold;
  }
  if (!options_.tare.empty()) {
    if (options_.tare.size() != taxels) {
      return InvalidConfig("numbers of the earlier tare", options_.tare.size(),
                           absl::StrCat(taxels));
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
  std::optional<EarlierBaseline> before;
  if (options_.calibration) {
    before = {options_.calibration->baseline,
              options_.calibration->contact_threshold};
  }
  TACTUS_ASSIGN_OR_RETURN(baseline_, Tare(idle, before ? &*before : nullptr));
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
    drift_->Step(above_, options_.calibration->contact_threshold, layout_.mask);
  }
  frame.capture_time_ns = raw_.capture_time_ns;
  frame.missing_before = raw_.missing_before;
  frame.pose = raw_.pose;
  frame.u16.clear();
  frame.f32.resize(numbers_.size());
  for (size_t i = 0; i < numbers_.size(); ++i) {
    const double reading = above_[i] - (drift_ ? drift_->drift()[i] : 0);
    double load = 0;
    if (reading > 0 && reading >= gate_[i]) {
      load = options_.calibration
                 ? LoadOf(*options_.calibration, i, reading, raw_info_.scale)
                 : reading * raw_info_.scale;
    }
    frame.f32[i] = std::min(static_cast<float>(load), limits::kMaxTaxelValue);
  }
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
