// File: skin_driver.h
//
// SkinDriver: where skin frames come from, be it hardware, a simulation or a
// recording. A driver lives through three states, as ros2_control's hardware
// components do:
//
//   UNCONFIGURED --Configure--> INACTIVE --Activate--> ACTIVE
//                               INACTIVE <-Deactivate- ACTIVE
//
//   TACTUS_ASSIGN_OR_RETURN(SkinInfo info, driver.Configure());
//   TACTUS_RETURN_IF_ERROR(driver.Activate());
//   SkinFrame frame;
//   while (true) {
//     TACTUS_ASSIGN_OR_RETURN(ReadResult result, driver.Read(frame));
//     if (result == ReadResult::kEndOfData) break;
//     ...
//   }
//
// A call in the wrong state fails and changes nothing; so does a driver's own
// failure. Not thread-safe: one thread a driver.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/skin/frame.h"
#include "tactus/v1/common.pb.h"

namespace tactus::client {

enum class DriverState { kUnconfigured, kInactive, kActive };

// What frames of a driver look like; fixed from Configure on.
struct SkinInfo {
  // Name of a preset layout.
  std::string layout;
  v1::TaxelType taxel_type = v1::TAXEL_TYPE_UINT16;
  // From values to the layout's unit.
  double scale = 1;
  double sample_rate_hz = 100;
  bool with_poses = false;

  bool operator==(const SkinInfo&) const = default;
};

struct SkinFrame {
  int64_t capture_time_ns = 0;
  // rows x columns values, row-major; the one of the driver's taxel type.
  std::vector<uint16_t> u16;
  std::vector<float> f32;
  // Of the skin's link, if the driver has poses.
  Pose pose;
};

enum class ReadResult {
  // A frame was read.
  kFrame,
  // No frame: the trial is over, the next frame begins another.
  kEndOfTrial,
  // No frame: nothing will follow.
  kEndOfData,
};

class SkinDriver {
 public:
  virtual ~SkinDriver() = default;

  absl::StatusOr<SkinInfo> Configure();
  absl::Status Activate();
  absl::Status Deactivate();
  // Overwrites `frame`, whose memory is used again.
  absl::StatusOr<ReadResult> Read(SkinFrame& frame);

  DriverState state() const { return state_; }

 protected:
  virtual absl::StatusOr<SkinInfo> OnConfigure() = 0;
  virtual absl::Status OnActivate() { return absl::OkStatus(); }
  virtual absl::Status OnDeactivate() { return absl::OkStatus(); }
  virtual absl::StatusOr<ReadResult> OnRead(SkinFrame& frame) = 0;

 private:
  absl::Status Expect(DriverState state) const;

  DriverState state_ = DriverState::kUnconfigured;
};

}  // namespace tactus::client
