// File: calibrated_driver.h
//
// CalibratedDriver: another driver's frames as loads, by a calibration, a tare
// at the start, or both.
//
//   CalibratedDriver driver(&buffered_driver, {.device = "serial left-palm",
//                                              .calibration = calibration,
//                                              .tare_frames = 100});
//   TACTUS_ASSIGN_OR_RETURN(const SkinInfo info, driver.Configure());
//
// The loads of a taxel, one per axis, are
//
//   reading = number that the skin sent - baseline - drift
//   load = cross-axis matrix * readings, or scale * reading without a matrix,
//          or gain curve (reading) on a skin of one axis that has a curve
//   load = 0 along all axes if the load of the taxel, as
//          core/skin/normal_loads.h makes it, is below its contact threshold
//   load = 0 if it is below 0, unless the layout has signed values
//
// computed in double and rounded once to the float that a stream sends and a
// trial file stores, so the same frames give the same bits. Taxels that the
// calibration found faulty are masked. A skin with light touch keeps loads
// below the threshold, because light touch needs them.
//
// Activate tares the skin: it reads `tare_frames` frames and fails if the skin
// is touched (tare.h) or if the frames do not come in time. The drift is
// followed only if `drift_time_s` is above 0 (drift_tracker.h).
//
// raw() has the frame as the skin sent it, for whoever records. The other
// driver outlives this one and must not be used beside it. Read allocates
// nothing after the first frame. Not thread-safe.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "client/drivers/calibration/axis_loads.h"
#include "client/drivers/calibration/calibration.h"
#include "client/drivers/calibration/calibration_in_use.h"
#include "client/drivers/calibration/drift_tracker.h"
#include "client/drivers/calibration/touch_thresholds.h"
#include "client/drivers/clock.h"
#include "client/drivers/skin_driver.h"

namespace tactus::internal::client {

struct CalibratedDriverOptions {
  // Name of the skin in use; compared with the calibration's.
  std::string device = {};
  std::optional<Calibration> calibration = std::nullopt;
  // 0: no tare; then there must be a calibration. Else kMinTareFrames or more.
  size_t tare_frames = 0;
  // Offsets of an earlier tare of these very frames, not of a new one; empty:
  // none.
  std::vector<double> tare = {};
  // 0: the drift is not followed. Needs a calibration.
  double drift_time_s = 0;
};

class CalibratedDriver : public SkinDriver {
 public:
  // `driver` and `clock` outlive this driver.
  CalibratedDriver(SkinDriver* driver, CalibratedDriverOptions options,
                   Clock* clock = &Clock::System());
  ~CalibratedDriver() override { Finalise().IgnoreError(); }

  // Those of the other driver. Remarks name the faulty taxels; the others may
  // be stuck.
  DriverStatistics Statistics() const override;

  // The last frame of Read as the skin sent it, and what such frames are like.
  const SkinFrame& raw() const { return raw_; }
  const SkinInfo& raw_info() const { return raw_info_; }
  // What loads are made by since Activate.
  CalibrationInUse in_use() const;
  // In use since Activate.
  const std::vector<double>& baseline() const { return baseline_; }
  // The drift is followed, and the last frame left it as it was.
  bool drift_frozen() const { return drift_ && drift_->frozen(); }

 protected:
  absl::StatusOr<SkinInfo> OnConfigure() override;
  absl::Status OnActivate() override;
  absl::Status OnDeactivate() override { return driver_->Deactivate(); }
  absl::StatusOr<ReadResult> OnRead(SkinFrame& frame) override;
  absl::Status OnFinalise() override { return driver_->Finalise(); }

 private:
  absl::Status TareNow();
  void Convert(SkinFrame& frame);
  // The load along one axis, of the taxel's loads of AxisLoads.
  float LoadAlong(size_t taxel, double load) const;

  SkinDriver* const driver_;
  const CalibratedDriverOptions options_;
  Clock* const clock_;
  SkinInfo raw_info_;
  SkinLayout layout_;
  std::optional<AxisLoads> loads_;
  // Per taxel: loads below it are 0; 0 if there is none.
  std::vector<double> gate_;
  std::vector<double> baseline_;
  // The baseline is that of a tare.
  bool tared_ = false;
  std::optional<DriftTracker> drift_;
  // Given if the drift is followed.
  std::optional<TouchThresholds> touch_;
  SkinFrame raw_;
  std::vector<float> numbers_;
  std::vector<double> above_;
};

}  // namespace tactus::internal::client
