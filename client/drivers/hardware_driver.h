// File: hardware_driver.h
//
// HardwareDriver: a SkinDriver for any SkinDevice. It finds out that frames
// stay away, reconnects, and measures.
//
//   HardwareDriver driver(&device, {});
//   TACTUS_ASSIGN_OR_RETURN(const SkinInfo info, driver.Configure());
//
// Read waits at most `read_timeout_ns`, except while it configures the skin
// anew, which takes a second or two; BufferedDriver keeps that from a stream.
// It never returns a frame that the skin did not send: lost frames are counted
// in SkinFrame::missing_before of the next one.
//
// A device that fails, or a skin that sends no whole frame for `silence_ns`, is
// a break. The driver then opens the device again and starts the skin; if that
// does not bring frames, it also configures the skin, with growing pauses.
// After `give_up_ns` without a frame, or if the skin has come back with other
// taxels, Read fails for good with the reason IO. docs/drivers.md lists what a
// user sees.
//
// With `pose_at`, a frame whose pose is not known is dropped and counted as
// lost. If that goes on for `give_up_ns`, Read fails as well.
//
// Not thread-safe.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "client/drivers/clock.h"
#include "client/drivers/skin_device.h"
#include "client/drivers/skin_driver.h"
#include "client/drivers/stuck_taxels.h"
#include "core/skin/normal_loads.h"

namespace tactus::internal::client {

struct HardwareDriverOptions {
  int64_t read_timeout_ns = 100'000'000;
  // At least five periods of the skin.
  int64_t silence_ns = 1'000'000'000;
  // 0: never.
  int64_t give_up_ns = 30'000'000'000;
  // The pause before the first attempt to reconnect; it doubles.
  int64_t first_pause_ns = 100'000'000;
  int64_t longest_pause_ns = 5'000'000'000;
  // The pose of the skin's link at a capture time; nothing if it is not known,
  // and the frame is lost then. Unset: frames without poses. JointPoses
  // (client/kinematics/joint_poses.h) computes it from joint angles.
  std::function<std::optional<Pose>(int64_t capture_time_ns)> pose_at = {};
  // Why pose_at returned nothing, for users; may be unset.
  std::function<std::string()> pose_problem = {};
};

class HardwareDriver : public SkinDriver {
 public:
  // `device` and `clock` outlive the driver.
  HardwareDriver(SkinDevice* device, const HardwareDriverOptions& options,
                 Clock* clock = &Clock::System());
  // Finalises.
  ~HardwareDriver() override;

  DriverStatistics Statistics() const override;

 protected:
  absl::StatusOr<SkinInfo> OnConfigure() override;
  absl::Status OnActivate() override;
  absl::Status OnDeactivate() override;
  absl::StatusOr<ReadResult> OnRead(SkinFrame& frame) override;
  absl::Status OnFinalise() override;

 private:
  void Break(absl::string_view problem);
  void Reconnect();
  absl::Status TryToReconnect();
  // Waits for the next attempt or until `deadline_ns`, and makes it.
  void WaitForConnection(int64_t deadline_ns);
  // False if the frame must not be handed on.
  bool Finish(SkinFrame& frame);
  // Why there are no poses.
  std::string PoseProblem() const;

  SkinDevice* const device_;
  const HardwareDriverOptions options_;
  Clock* const clock_;
  // Looks for taxels that do not move.
  void CheckStuck(const SkinFrame& frame);

  SkinInfo info_;
  std::optional<FrameMeter> meter_;
  std::optional<StuckTaxels> stuck_;
  // What stuck_ looks at: loads of values, which may be of any type.
  std::optional<NormalLoads> loads_;
  std::vector<float> values_;
  int64_t last_capture_ns_ = 0;
  // The last frame, or when the driver became active.
  int64_t last_frame_ns_ = 0;
  // The last frame or reconnection.
  int64_t quiet_since_ns_ = 0;

  // Frames without a known pose, and since when each frame was one; 0: the
  // last frame had a pose.
  uint64_t without_pose_ = 0;
  int64_t without_pose_since_ns_ = 0;

  bool connected_ = false;
  // The device may be used; frames need not have come yet.
  bool open_ = false;
  int attempts_ = 0;
  int64_t pause_ns_ = 0;
  int64_t next_attempt_ns_ = 0;
  uint64_t reconnects_ = 0;
  std::string problem_;
  absl::Status failed_;
};

}  // namespace tactus::internal::client
