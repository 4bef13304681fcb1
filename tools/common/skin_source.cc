#include "tools/common/skin_source.h"

#include <filesystem>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/drivers/calibration/calibration_json.h"
#include "client/drivers/calibration/tare.h"
#include "client/drivers/can/socket_can.h"
#include "client/drivers/replay_driver.h"
#include "client/drivers/sim_driver.h"
#include "client/front/wrapped_driver.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/limits_skin.h"
#include "core/base/status_macros.h"
#include "core/data/trial_layout.h"
#include "core/files/file_bytes.h"

namespace tactus::internal::client {
namespace {

namespace fs = std::filesystem;

constexpr char kAutoPort[] = "auto";

SerialFormat FormatOf(const SkinSourceOptions& options) {
  return options.format == "ascii" ? SerialFormat::kAscii : SerialFormat::kAa55;
}

// The name under /dev/serial/by-id of the adapter behind `port`, or `port`.
std::string SerialName(const std::string& port) {
  std::error_code error;
  const fs::path target = fs::canonical(port, error);
  if (error) return port;
  for (const auto& entry : fs::directory_iterator("/dev/serial/by-id", error)) {
    std::error_code broken;
    if (fs::canonical(entry.path(), broken) == target && !broken) {
      return entry.path().filename();
    }
  }
  return port;
}

absl::StatusOr<std::unique_ptr<TrialDriver>> MakePlayedTrials(
    const SkinSourceOptions& options, const Shard& shard) {
  if (options.driver == "replay") {
    std::optional<SkinLayout> layout;
    if (!options.layout.empty()) {
      TACTUS_ASSIGN_OR_RETURN(layout, ReadLayoutFile(options.layout));
    }
    return std::make_unique<ReplayDriver>(
        options.data, shard,
        ReplayDriver::Options{.max_trials = options.trials, .layout = layout});
  }
  return std::make_unique<SimDriver>(
      SimDriver::Options{.seed = options.seed,
                         .skin = options.skin,
                         .objects = options.objects},
      options.trials == 0 ? kSimulatedTrials : options.trials, shard);
}

absl::Status CheckPoseFlags(const SkinSourceOptions& options) {
  const ArmSourceOptions& arm = options.arm;
  const int given =
      !arm.urdf.empty() + !arm.skin_link.empty() + !arm.joints.empty();
  if (given == 0) return absl::OkStatus();
  if (given < 3) {
    return InvalidConfig("number of --urdf, --skin-link and --joints", given,
                         "3, or 0: they belong together");
  }
  if (!options.IsLive()) {
    return InvalidConfig("--urdf",
                         absl::StrCat("given with --driver=", options.driver),
                         "absent without a real skin");
  }
  if (!options.icub.positions.empty()) {
    return InvalidConfig(
        "--urdf", "given with --positions",
        "given with a skin that is flat in the x-y plane of its link, or a "
        "cylinder around z: a position file's patch is curved otherwise");
  }
  return absl::OkStatus();
}

}  // namespace

void AddSkinFlags(CLI::App& app, SkinSourceOptions& options) {
  const CLI::Validator known = CLI::IsMember(
      std::vector<std::string>{"sim", "replay", "icub-can", "icub-usb",
                               "xela-can", "serial", "anyskin"});
  app.add_option("--driver", options.driver,
                 "sim, replay, icub-can, icub-usb, xela-can, serial, anyskin, "
                 "or a driver of your own, such as ./my_skin.so "
                 "(docs/drivers.md)")
      ->check([known](const std::string& driver) {
        return IsDriverLibrary(driver) ? "" : known(driver);
      })
      ->capture_default_str();
  app.add_option_function<std::vector<std::string>>(
      "--driver-option",
      [&options](const std::vector<std::string>& pairs) {
        for (const std::string& pair : pairs) {
          const size_t equals = pair.find('=');
          if (equals == 0 || equals == pair.npos) {
            throw CLI::ValidationError("--driver-option",
                                       pair + " is not NAME=VALUE");
          }
          options.driver_options[pair.substr(0, equals)] =
              pair.substr(equals + 1);
        }
      },
      "NAME=VALUE for a driver of your own; may be repeated");
  app.add_option("--skin", options.skin,
                 "Skin of --driver=sim: paper, good or measured")
      ->capture_default_str();
  app.add_option("--objects", options.objects,
                 "Objects at once in each trial of --driver=sim")
      ->check(CLI::Range(1, limits::kMaxSceneObjects))
      ->capture_default_str();
  app.add_option("--data", options.data, "Trial file for --driver=replay")
      ->check(CLI::ExistingFile);
  app.add_option("--layout", options.layout,
                 "JSON file with the skin of trials that carry none, or whose "
                 "cells are a real skin's values in their order")
      ->check(CLI::ExistingFile);
  app.add_option("--interface", options.icub.interface,
                 "CAN interface for icub-can and xela-can, such as can0");
  app.add_option("--port", options.port,
                 "Serial line for serial and anyskin, such as /dev/ttyUSB0; "
                 "auto: the one on which such a skin sends");
  app.add_option("--format", options.format,
                 "What a serial skin sends: ascii (3D-ViTac) or aa55 "
                 "(FlexiTac)")
      ->check(CLI::IsMember({"ascii", "aa55"}))
      ->capture_default_str();
  app.add_option("--baud", options.baud,
                 "Rate of the serial line; if absent 2000000, or 115200 for "
                 "anyskin");
  app.add_option("--rate-hz", options.rate_hz,
                 "Frames per second of the skin; if absent 30, or 100 for "
                 "anyskin")
      ->check(CLI::PositiveNumber);
  app.add_option("--magnets", options.magnets,
                 "Magnetometers of --driver=anyskin")
      ->check(CLI::Range(1, limits::kMaxMagnetometers))
      ->capture_default_str();
  app.add_option("--rezero-s", options.rezero_s,
                 "Seconds over which --driver=anyskin follows the skin while "
                 "nothing touches it; 0: it does not")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
  app.add_option("--usb-serial", options.icub.usb_serial,
                 "Serial number of the adapter for --driver=icub-usb");
  app.add_option("--boards", options.icub.boards,
                 "Skin boards in the order of the port: forearm-v1, "
                 "forearm-v2, or addresses and triangles, as in 13,12:0-1+3")
      ->capture_default_str();
  app.add_option("--positions", options.icub.positions,
                 "Position file of the skin, as icub-main has them")
      ->check(CLI::ExistingFile);
  app.add_option("--period-ms", options.icub.period_ms,
                 "From one scan of the skin to the next")
      ->check(CLI::Range(1, 255))
      ->capture_default_str();
  app.add_option("--scale", options.icub.scale,
                 "The layout's unit for each count of the skin")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--mask", options.icub.mask,
                 "Taxels of a real skin to ignore, row-major, as in 17,203")
      ->delimiter(',');
}

void AddPoseFlags(CLI::App& app, SkinSourceOptions& options) {
  app.add_option("--urdf", options.arm.urdf,
                 "URDF file of the arm that carries a real skin; frames have "
                 "poses then")
      ->check(CLI::ExistingFile);
  app.add_option("--skin-link", options.arm.skin_link,
                 "Link of the URDF in whose frame the skin's layout is");
  app.add_option("--joints", options.arm.joints,
                 "host:port to receive the joint values at, one line in each "
                 "UDP datagram: time_ns q1 q2 ... (docs/drivers.md)");
}

absl::Status CheckSkinFlags(const SkinSourceOptions& options) {
  TACTUS_RETURN_IF_ERROR(CheckPoseFlags(options));
  const std::string& driver = options.driver;
  if (!options.driver_options.empty() && !IsDriverLibrary(driver)) {
    return InvalidConfig("--driver-option",
                         absl::StrCat("given with --driver=", driver),
                         "absent without a driver of your own");
  }
  if (IsDriverLibrary(driver) && !options.arm.urdf.empty()) {
    return InvalidConfig("--urdf", "given with a driver of your own",
                         "absent: such a driver gives poses itself");
  }
  const auto needs = [&](const std::string& flag) {
    return InvalidConfig(flag, "absent",
                         absl::StrCat("given with --driver=", driver));
  };
  if (driver == "replay" && options.data.empty()) return needs("--data");
  if ((driver == "icub-can" || driver == "xela-can") &&
      options.icub.interface.empty()) {
    return needs("--interface");
  }
  if ((driver == "serial" || driver == "anyskin") && options.port.empty()) {
    return needs("--port");
  }
  if (driver == "sim" && !options.layout.empty()) {
    return InvalidConfig("--layout", "given", "absent with --driver=sim");
  }
  if (!options.layout.empty() && !options.icub.positions.empty()) {
    return InvalidConfig("--layout and --positions", "both given",
                         "one of the two");
  }
  if (options.drift_time_s > 0 && options.calibration.empty()) {
    return InvalidConfig("--drift-s", "given without --calibration",
                         "given with it");
  }
  return absl::OkStatus();
}

void AddDeviceFlag(CLI::App& app, SkinSourceOptions& options) {
  app.add_option("--device-id", options.device_id,
                 "Name of the skin in its calibration, instead of that of its "
                 "adapter or line");
}

void AddCalibrationFlags(CLI::App& app, SkinSourceOptions& options) {
  app.add_option("--calibration", options.calibration,
                 "Calibration of a real skin, from trainctl skin calibrate")
      ->check(CLI::ExistingFile);
  app.add_option("--tare", options.tare_frames,
                 "Take the mean of so many frames at the start for untouched")
      ->check(CLI::Range(kMinTareFrames, size_t{100'000}));
  app.add_option("--drift-s", options.drift_time_s,
                 "Follow the drift of untouched taxels over so many seconds; "
                 "needs --calibration")
      ->check(CLI::Range(1.0, 1e6));
  AddDeviceFlag(app, options);
}

std::string DeviceId(const SkinSourceOptions& options) {
  if (!options.device_id.empty()) return options.device_id;
  if (options.driver == "sim") return "sim " + options.skin;
  if (options.driver == "replay") return "replay";
  if (IsDriverLibrary(options.driver)) {
    return fs::path(options.driver).filename();
  }
  if (options.driver == "serial" || options.driver == "anyskin") {
    return absl::StrCat(options.driver, " ", SerialName(options.port));
  }
  if (options.driver == "xela-can") return "xela-can " + options.icub.interface;
  const std::string& adapter = options.driver == "icub-usb"
                                   ? options.icub.usb_serial
                                   : options.icub.interface;
  return absl::StrCat(options.driver, " ", adapter, adapter.empty() ? "" : " ",
                      options.icub.boards);
}

absl::StatusOr<std::string> FindPort(SkinSourceOptions& options,
                                     SerialSearch search) {
  if (options.port != kAutoPort) return "";
  absl::StatusOr<SerialFound> found;
  if (options.driver == "serial") {
    search.baud = options.baud.value_or(SerialSkinOptions().baud);
    found = FindSerialSkin(FormatOf(options), search);
  } else if (options.driver == "anyskin") {
    search.baud = options.baud.value_or(AnySkinOptions().baud);
    found = FindMagneticSkin(static_cast<size_t>(options.magnets), search);
  } else {
    return "";
  }
  if (!found.ok()) return found.status();
  options.port = found->path;
  return ToText(*found);
}

absl::StatusOr<std::unique_ptr<TrialDriver>> MakeTrialDriver(
    const SkinSourceOptions& options, const Shard& shard) {
  if (options.IsCalibrated()) {
    return InvalidConfig("--calibration or --tare",
                         absl::StrCat("given with --driver=", options.driver),
                         "absent without a real skin");
  }
  return MakePlayedTrials(options, shard);
}

HardwareDriverOptions SkinSource::Poses() {
  return arm_ == nullptr ? HardwareDriverOptions{} : arm_->DriverOptions();
}

absl::Status SkinSource::MakeSerial(const SkinSourceOptions& options) {
  SerialSkinOptions skin = {.format = FormatOf(options),
                            .scale = options.icub.scale};
  skin.baud = options.baud.value_or(skin.baud);
  skin.sample_rate_hz = options.rate_hz.value_or(skin.sample_rate_hz);
  TACTUS_ASSIGN_OR_RETURN(skin.layout, options.layout.empty()
                                           ? LayoutPreset("vitac-12x32")
                                           : ReadLayoutFile(options.layout));
  TACTUS_RETURN_IF_ERROR(AddMask(options.icub.mask, skin.layout));
  serial_ = std::make_unique<SerialSkin>(options.port, skin);
  hardware_ = std::make_unique<HardwareDriver>(serial_.get(), Poses());
  return absl::OkStatus();
}

absl::Status SkinSource::MakeAnySkin(const SkinSourceOptions& options) {
  AnySkinOptions skin = {.magnets = options.magnets,
                         .scale = options.icub.scale,
                         .rezero_s = options.rezero_s};
  // CalibratedDriver follows it then.
  if (options.drift_time_s > 0) skin.rezero_s = 0;
  skin.baud = options.baud.value_or(skin.baud);
  skin.sample_rate_hz = options.rate_hz.value_or(skin.sample_rate_hz);
  skin.layout = AnySkinLayout(skin.magnets);
  if (!options.layout.empty()) {
    TACTUS_ASSIGN_OR_RETURN(skin.layout, ReadLayoutFile(options.layout));
  }
  TACTUS_RETURN_IF_ERROR(AddMask(options.icub.mask, *skin.layout));
  anyskin_ = std::make_unique<AnySkin>(options.port, skin);
  hardware_ = std::make_unique<HardwareDriver>(anyskin_.get(), Poses());
  return absl::OkStatus();
}

absl::Status SkinSource::MakeXela(const SkinSourceOptions& options) {
  XelaSkinOptions skin = {.scale = options.icub.scale};
  if (!options.layout.empty()) {
    TACTUS_ASSIGN_OR_RETURN(skin.layout, ReadLayoutFile(options.layout));
  }
  TACTUS_RETURN_IF_ERROR(AddMask(options.icub.mask, skin.layout));
  bus_ = std::make_unique<SocketCan>(options.icub.interface);
  xela_ = std::make_unique<XelaSkin>(skin);
  hardware_ = std::make_unique<CanSkinDriver>(bus_.get(), xela_.get(), Poses());
  return absl::OkStatus();
}

absl::Status SkinSource::MakeHardware(const SkinSourceOptions& options) {
  if (options.driver == "serial") return MakeSerial(options);
  if (options.driver == "anyskin") return MakeAnySkin(options);
  if (options.driver == "xela-can") return MakeXela(options);
  return absl::OkStatus();
}

absl::Status SkinSource::MakeDriver(const SkinSourceOptions& options) {
  if (!options.IsLive()) {
    TACTUS_ASSIGN_OR_RETURN(trials_, MakePlayedTrials(options, {}));
    paced_ = std::make_unique<PacedDriver>(trials_.get());
    driver_ = paced_.get();
    return absl::OkStatus();
  }
  if (IsDriverLibrary(options.driver)) {
    TACTUS_ASSIGN_OR_RETURN(std::unique_ptr<Driver> plugin,
                            LoadDriver(options.driver, options.driver_options));
    plugin_ = WrapDriver(std::move(plugin));
    driver_ = plugin_.get();
    return absl::OkStatus();
  }
  if (!options.arm.urdf.empty()) {
    TACTUS_ASSIGN_OR_RETURN(arm_, ArmSource::Make(options.arm));
  }
  TACTUS_RETURN_IF_ERROR(MakeHardware(options));
  if (hardware_ != nullptr) {
    buffered_ = std::make_unique<BufferedDriver>(hardware_.get(),
                                                 BufferedDriverOptions{});
    driver_ = buffered_.get();
    return absl::OkStatus();
  }
  IcubSourceOptions icub = options.icub;
  icub.usb = options.driver == "icub-usb";
  icub.layout = options.layout;
  TACTUS_ASSIGN_OR_RETURN(icub_, IcubSource::Make(icub, Poses()));
  driver_ = &icub_->driver();
  return absl::OkStatus();
}

absl::StatusOr<Calibration> ReadCalibration(const std::string& path) {
  TACTUS_ASSIGN_OR_RETURN(const std::string text,
                          ReadFileBytes(path, kMaxCalibrationBytes));
  auto calibration = CalibrationFromJson(text);
  if (!calibration.ok()) return Annotate(calibration.status(), path);
  return calibration;
}

absl::StatusOr<CalibratedDriverOptions> CalibratedOptions(
    const SkinSourceOptions& options, const std::string& device) {
  CalibratedDriverOptions calibrated = {.device = device,
                                        .tare_frames = options.tare_frames,
                                        .drift_time_s = options.drift_time_s};
  if (!options.calibration.empty()) {
    TACTUS_ASSIGN_OR_RETURN(calibrated.calibration,
                            ReadCalibration(options.calibration));
  }
  return calibrated;
}

absl::StatusOr<std::unique_ptr<SkinSource>> SkinSource::Make(
    const SkinSourceOptions& options) {
  std::unique_ptr<SkinSource> source(new SkinSource());
  TACTUS_RETURN_IF_ERROR(source->MakeDriver(options));
  if (!options.IsCalibrated()) return source;
  TACTUS_ASSIGN_OR_RETURN(CalibratedDriverOptions calibrated,
                          CalibratedOptions(options, DeviceId(options)));
  source->calibrated_ = std::make_unique<CalibratedDriver>(
      source->driver_, std::move(calibrated));
  source->driver_ = source->calibrated_.get();
  return source;
}

}  // namespace tactus::internal::client
