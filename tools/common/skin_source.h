// File: skin_source.h
//
// SkinSource: the driver that a program's flags ask for, and all that it needs.
//
//   SkinSourceOptions options;
//   AddSkinFlags(app, options);
//   CLI11_PARSE(app, argc, argv);
//   TACTUS_ASSIGN_OR_RETURN(const auto source, SkinSource::Make(options));
//   LivePlayer player(channel, &source->driver(), ...);
//
// The flags write to the options. Not thread-safe.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "CLI/CLI.hpp"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/drivers/anyskin/anyskin.h"
#include "client/drivers/calibrated_driver.h"
#include "client/drivers/serial/serial_search.h"
#include "client/drivers/serial/serial_skin.h"
#include "client/drivers/trial_driver.h"
#include "client/drivers/xela/xela_skin.h"
#include "client/front/plugin_driver.h"
#include "tools/common/arm_source.h"
#include "tools/common/icub_source.h"
#include "tools/common/paced_driver.h"

namespace tactus::internal::client {

struct SkinSourceOptions {
  // "sim", "replay", "icub-can", "icub-usb", "xela-can", "serial", "anyskin",
  // or a library (client/front/plugin_driver.h).
  std::string driver = "sim";
  DriverOptions driver_options = {};
  // JSON file with the skin.
  std::string layout = {};
  // Simulated contacts.
  std::string skin = "good";
  uint64_t seed = 1;
  // In each of their trials, at once.
  int objects = 1;
  // Recorded ones.
  std::string data = {};
  // Contacts to play; 0: all recorded ones, or kSimulatedTrials.
  size_t trials = 0;
  // Skins on CAN; scale and mask are those of all real skins.
  IcubSourceOptions icub = {};
  // A serial skin or a magnetic one; "auto" until FindPort has found the line.
  // Absent rates are those of the driver's options.
  std::string port = {};
  std::string format = "ascii";
  std::optional<int> baud = std::nullopt;
  std::optional<double> rate_hz = std::nullopt;
  int magnets = AnySkinOptions().magnets;
  double rezero_s = AnySkinOptions().rezero_s;
  // Where a real skin is; without a URDF, frames have no poses.
  ArmSourceOptions arm = {};
  // A file that `trainctl skin calibrate` wrote; frames of a tare at the start,
  // 0: none; seconds over which the drift is followed, 0: not followed.
  std::string calibration = {};
  size_t tare_frames = 0;
  double drift_time_s = 0;
  // Replaces what DeviceId finds.
  std::string device_id = {};

  // Frames are converted to loads.
  bool IsCalibrated() const { return !calibration.empty() || tare_frames > 0; }
  // The skin is a real one.
  bool IsLive() const { return driver != "sim" && driver != "replay"; }
};

// Contacts of --driver=sim unless the user gives a number.
inline constexpr size_t kSimulatedTrials = 40;

// The flags of all drivers but --seed and --trials.
void AddSkinFlags(CLI::App& app, SkinSourceOptions& options);

// --calibration, --tare, --drift-s and --device-id.
void AddCalibrationFlags(CLI::App& app, SkinSourceOptions& options);
// --urdf, --skin-link and --joints.
void AddPoseFlags(CLI::App& app, SkinSourceOptions& options);
// --device-id alone.
void AddDeviceFlag(CLI::App& app, SkinSourceOptions& options);

// Names the skin and how it is connected, for its calibration: the name of a
// USB adapter of a serial line if it has one, as that stays when the adapter is
// plugged in elsewhere; else the line or the interface.
std::string DeviceId(const SkinSourceOptions& options);

// With --port=auto listens to the serial lines of the machine and puts the one
// line of a skin in its place; else does nothing. Returns a text for people,
// empty if it did nothing. The errors are those of FindSerialSkin.
absl::StatusOr<std::string> FindPort(SkinSourceOptions& options,
                                     SerialSearch search = {});

// INVALID_CONFIG, which begins with a flag, if flags are absent that the driver
// needs, or if flags exclude each other.
absl::Status CheckSkinFlags(const SkinSourceOptions& options);

// Simulated or recorded trials: every `shard.shards`-th of them. INVALID_CONFIG
// if they are to be calibrated, which only a SkinSource does.
absl::StatusOr<std::unique_ptr<TrialDriver>> MakeTrialDriver(
    const SkinSourceOptions& options, const Shard& shard);

// The calibration in a file; errors name it.
absl::StatusOr<Calibration> ReadCalibration(const std::string& path);

// What --calibration, --tare and --drift-s say, for the skin `device`.
absl::StatusOr<CalibratedDriverOptions> CalibratedOptions(
    const SkinSourceOptions& options, const std::string& device);

class SkinSource {
 public:
  // INVALID_CONFIG or IO; opens no device, but the socket for joint values if
  // there is a URDF. Simulated and recorded contacts are
  // played at the rate of their skin.
  static absl::StatusOr<std::unique_ptr<SkinSource>> Make(
      const SkinSourceOptions& options);

  // Lives as long as the source.
  SkinDriver& driver() { return *driver_; }
  // The same driver if it is calibrated; it has the raw frames. Else null.
  CalibratedDriver* calibrated() { return calibrated_.get(); }
  // Null if frames have no poses, or have them from elsewhere.
  ArmSource* arm() { return arm_.get(); }

 private:
  SkinSource() = default;

  absl::Status MakeDriver(const SkinSourceOptions& options);
  // The skin on a serial line or a bus of XELA's, if it is one.
  absl::Status MakeHardware(const SkinSourceOptions& options);
  absl::Status MakeSerial(const SkinSourceOptions& options);
  absl::Status MakeAnySkin(const SkinSourceOptions& options);
  absl::Status MakeXela(const SkinSourceOptions& options);
  // How the driver gets its poses.
  HardwareDriverOptions Poses();

  // In the order of their use; the last ends first. Most are null.
  std::unique_ptr<ArmSource> arm_;
  std::unique_ptr<CanBus> bus_;
  std::unique_ptr<XelaSkin> xela_;
  std::unique_ptr<SerialSkin> serial_;
  std::unique_ptr<AnySkin> anyskin_;
  std::unique_ptr<HardwareDriver> hardware_;
  std::unique_ptr<BufferedDriver> buffered_;
  std::unique_ptr<IcubSource> icub_;
  std::unique_ptr<TrialDriver> trials_;
  std::unique_ptr<PacedDriver> paced_;
  std::unique_ptr<SkinDriver> plugin_;
  std::unique_ptr<CalibratedDriver> calibrated_;
  SkinDriver* driver_ = nullptr;
};

}  // namespace tactus::internal::client
