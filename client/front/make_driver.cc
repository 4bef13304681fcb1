#include <cmath>
#include <limits>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "client/drivers/anyskin/anyskin.h"
#include "client/drivers/buffered_driver.h"
#include "client/drivers/calibrated_driver.h"
#include "client/drivers/calibration/calibration_json.h"
#include "client/drivers/can/gs_usb.h"
#include "client/drivers/can/socket_can.h"
#include "client/drivers/can_skin_driver.h"
#include "client/drivers/icub_skin/icub_skin.h"
#include "client/drivers/icub_skin/position_file.h"
#include "client/drivers/replay_driver.h"
#include "client/drivers/serial/serial_skin.h"
#include "client/drivers/sim_driver.h"
#include "client/drivers/xela/xela_skin.h"
#include "client/front/plugin_driver.h"
#include "client/front/wrapped_driver.h"
#include "core/base/errors.h"
#include "core/base/limits_skin.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/files/file_bytes.h"
#include "tactus/driver.h"

namespace tactus {
namespace internal::client {
namespace {

constexpr char kDriverNames[] =
    "sim, replay, serial, anyskin, xela-can, icub-can, icub-usb or a library "
    "such as ./my_skin.so";
constexpr size_t kMaxPositionFileBytes = 4 * 1024 * 1024;
constexpr uint64_t kSimulatedContacts = 40;
constexpr uint64_t kMaxBaud = 100'000'000;
constexpr uint64_t kMaxPeriodMs = 255;
constexpr uint64_t kMaxTareFrames = 100'000;
constexpr uint64_t kMaxRezeroS = 1'000'000;

// The options of a driver; what was not asked for is unknown.
class Options {
 public:
  explicit Options(const DriverOptions& given) : left_(given) {}

  std::string Text(const std::string& name, const std::string& absent) {
    const auto found = left_.find(name);
    if (found == left_.end()) return absent;
    const std::string text = found->second;
    left_.erase(found);
    return text;
  }
  uint64_t Count(const std::string& name, uint64_t absent,
                 uint64_t most = std::numeric_limits<uint64_t>::max()) {
    const std::string text = Text(name, absl::StrCat(absent));
    uint64_t count = 0;
    if (absl::SimpleAtoi(text, &count) && count <= most) return count;
    Fail(name, text, absl::StrCat("a whole number from 0 to ", most));
    return absent;
  }
  double Positive(const std::string& name, double absent) {
    const std::string text = Text(name, absl::StrCat(absent));
    double number = 0;
    if (absl::SimpleAtod(text, &number) && number > 0 &&
        std::isfinite(number)) {
      return number;
    }
    Fail(name, text, "a number above 0");
    return absent;
  }
  std::string Needed(const std::string& name) {
    std::string text = Text(name, "");
    if (text.empty()) Fail(name, "", "given");
    return text;
  }
  void Fail(const std::string& name, const std::string& text,
            const std::string& want) {
    if (!status_.ok()) return;
    status_ = InvalidConfig(absl::StrCat("option ", name),
                            text.empty() ? "absent" : Quoted(text), want);
  }
  // The first mistake.
  absl::Status Check() const {
    if (!status_.ok() || left_.empty()) return status_;
    return InvalidConfig("option", Quoted(left_.begin()->first),
                         "one that tactus/driver.h names for this driver");
  }

 private:
  DriverOptions left_;
  absl::Status status_;
};

absl::StatusOr<std::unique_ptr<Driver>> MakeSim(Options options) {
  const SimDriver::Options sim = {.seed = options.Count("seed", 1),
                                  .skin = options.Text("skin", "good")};
  const uint64_t trials = options.Count("trials", kSimulatedContacts);
  TACTUS_RETURN_IF_ERROR(options.Check());
  return ExposeDriver(std::make_shared<SimDriver>(sim, trials, Shard{}));
}

absl::StatusOr<std::unique_ptr<Driver>> MakeReplay(Options options) {
  const std::string data = options.Needed("data");
  const ReplayDriver::Options replay = {.max_trials =
                                            options.Count("trials", 0)};
  TACTUS_RETURN_IF_ERROR(options.Check());
  return ExposeDriver(std::make_shared<ReplayDriver>(data, Shard{}, replay));
}

// What a real skin's numbers become loads by.
struct Loads {
  std::string calibration;
  std::string device;
  size_t tare_frames = 0;
};

Loads TakeLoads(Options& options) {
  Loads loads;
  loads.calibration = options.Text("calibration", "");
  loads.device = options.Text("device", "");
  loads.tare_frames = options.Count("tare", 0, kMaxTareFrames);
  return loads;
}

struct CalibratedParts {
  CalibratedParts(std::shared_ptr<SkinDriver> raw,
                  CalibratedDriverOptions options)
      : driver(std::move(raw)), calibrated(driver.get(), std::move(options)) {}

  const std::shared_ptr<SkinDriver> driver;
  CalibratedDriver calibrated;
};

absl::StatusOr<std::unique_ptr<Driver>> ExposeHardware(
    std::shared_ptr<SkinDriver> driver, const Loads& loads) {
  if (loads.calibration.empty() && loads.tare_frames == 0) {
    return ExposeDriver(std::move(driver));
  }
  CalibratedDriverOptions options;
  options.device = loads.device;
  options.tare_frames = loads.tare_frames;
  if (!loads.calibration.empty()) {
    TACTUS_ASSIGN_OR_RETURN(
        const std::string text,
        ReadFileBytes(loads.calibration, kMaxCalibrationBytes));
    auto calibration = CalibrationFromJson(text);
    if (!calibration.ok()) {
      return Annotate(calibration.status(), loads.calibration);
    }
    options.calibration = *std::move(calibration);
  }
  const auto parts =
      std::make_shared<CalibratedParts>(std::move(driver), std::move(options));
  return ExposeDriver(std::shared_ptr<SkinDriver>(parts, &parts->calibrated));
}

// A real skin is read by a thread.
struct SerialParts {
  SerialParts(const std::string& port, const SerialSkinOptions& options)
      : skin(port, options) {}

  SerialSkin skin;
  HardwareDriver hardware{&skin, HardwareDriverOptions{}};
  BufferedDriver buffered{&hardware, BufferedDriverOptions{}};
};

absl::StatusOr<std::unique_ptr<Driver>> MakeSerial(Options options) {
  const std::string port = options.Needed("port");
  SerialSkinOptions skin;
  const std::string format = options.Text("format", "ascii");
  if (format != "ascii" && format != "aa55") {
    options.Fail("format", format, "ascii or aa55");
  }
  skin.format = format == "ascii" ? SerialFormat::kAscii : SerialFormat::kAa55;
  skin.baud = static_cast<int>(options.Count("baud", skin.baud, kMaxBaud));
  skin.sample_rate_hz = options.Positive("rate_hz", skin.sample_rate_hz);
  skin.scale = options.Positive("scale", skin.scale);
  const Loads loads = TakeLoads(options);
  TACTUS_RETURN_IF_ERROR(options.Check());
  TACTUS_ASSIGN_OR_RETURN(skin.layout, LayoutPreset("vitac-12x32"));
  const auto parts = std::make_shared<SerialParts>(port, skin);
  return ExposeHardware(std::shared_ptr<SkinDriver>(parts, &parts->buffered),
                        loads);
}

struct AnySkinParts {
  AnySkinParts(const std::string& port, const AnySkinOptions& options)
      : skin(port, options) {}

  AnySkin skin;
  HardwareDriver hardware{&skin, HardwareDriverOptions{}};
  BufferedDriver buffered{&hardware, BufferedDriverOptions{}};
};

absl::StatusOr<std::unique_ptr<Driver>> MakeAnySkin(Options options) {
  const std::string port = options.Needed("port");
  AnySkinOptions skin;
  skin.magnets = static_cast<int>(
      options.Count("magnets", skin.magnets, limits::kMaxMagnetometers));
  skin.baud = static_cast<int>(options.Count("baud", skin.baud, kMaxBaud));
  skin.sample_rate_hz = options.Positive("rate_hz", skin.sample_rate_hz);
  skin.scale = options.Positive("scale", skin.scale);
  skin.rezero_s = static_cast<double>(options.Count(
      "rezero_s", static_cast<uint64_t>(skin.rezero_s), kMaxRezeroS));
  const Loads loads = TakeLoads(options);
  TACTUS_RETURN_IF_ERROR(options.Check());
  const auto parts = std::make_shared<AnySkinParts>(port, skin);
  return ExposeHardware(std::shared_ptr<SkinDriver>(parts, &parts->buffered),
                        loads);
}

struct XelaParts {
  XelaParts(const std::string& interface, const XelaSkinOptions& options)
      : bus(interface), skin(options) {}

  SocketCan bus;
  XelaSkin skin;
  CanSkinDriver hardware{&bus, &skin, HardwareDriverOptions{}};
  BufferedDriver buffered{&hardware, BufferedDriverOptions{}};
};

absl::StatusOr<std::unique_ptr<Driver>> MakeXela(Options options) {
  const std::string interface = options.Text("interface", "can0");
  XelaSkinOptions skin;
  skin.scale = options.Positive("scale", skin.scale);
  const Loads loads = TakeLoads(options);
  TACTUS_RETURN_IF_ERROR(options.Check());
  const auto parts = std::make_shared<XelaParts>(interface, skin);
  return ExposeHardware(std::shared_ptr<SkinDriver>(parts, &parts->buffered),
                        loads);
}

struct IcubParts {
  IcubParts(std::unique_ptr<CanBus> can, icub::SkinPatch patch,
            const icub::IcubSkinOptions& options)
      : bus(std::move(can)), skin(std::move(patch), options) {}

  const std::unique_ptr<CanBus> bus;
  icub::IcubSkin skin;
  CanSkinDriver hardware{bus.get(), &skin, HardwareDriverOptions{}};
  BufferedDriver buffered{&hardware, BufferedDriverOptions{}};
};

absl::StatusOr<icub::SkinPatch> MakePatch(const std::string& names,
                                          const std::string& positions) {
  TACTUS_ASSIGN_OR_RETURN(const std::vector<icub::SkinBoard> boards,
                          icub::ParseBoards(names));
  if (positions.empty()) return icub::PortPatch(boards);
  TACTUS_ASSIGN_OR_RETURN(const std::string text,
                          ReadFileBytes(positions, kMaxPositionFileBytes));
  const auto places = icub::ParsePositions(text);
  if (!places.ok()) return Annotate(places.status(), positions);
  return icub::PlacedPatch(boards, *places);
}

absl::StatusOr<std::unique_ptr<Driver>> MakeIcub(Options options, bool is_usb) {
  const std::string boards = options.Text("boards", "forearm-v2");
  const std::string positions = options.Text("positions", "");
  icub::IcubSkinOptions skin;
  skin.period_ms = static_cast<int>(
      options.Count("period_ms", skin.period_ms, kMaxPeriodMs));
  skin.scale = options.Positive("scale", skin.scale);
  std::unique_ptr<CanBus> bus;
  if (is_usb) {
    bus = std::make_unique<GsUsb>(
        GsUsbOptions{.serial = options.Text("usb_serial", "")});
  } else {
    bus = std::make_unique<SocketCan>(options.Text("interface", "can0"));
  }
  const Loads loads = TakeLoads(options);
  TACTUS_RETURN_IF_ERROR(options.Check());
  TACTUS_ASSIGN_OR_RETURN(icub::SkinPatch patch, MakePatch(boards, positions));
  const auto parts =
      std::make_shared<IcubParts>(std::move(bus), std::move(patch), skin);
  return ExposeHardware(std::shared_ptr<SkinDriver>(parts, &parts->buffered),
                        loads);
}

}  // namespace
}  // namespace internal::client

absl::StatusOr<std::unique_ptr<Driver>> MakeDriver(
    const std::string& name, const DriverOptions& options) {
  const internal::client::Options given(options);
  if (internal::client::IsDriverLibrary(name)) {
    return internal::client::LoadDriver(name, options);
  }
  if (name == "sim") return internal::client::MakeSim(given);
  if (name == "replay") return internal::client::MakeReplay(given);
  if (name == "serial") return internal::client::MakeSerial(given);
  if (name == "anyskin") return internal::client::MakeAnySkin(given);
  if (name == "xela-can") return internal::client::MakeXela(given);
  if (name == "icub-can") {
    return internal::client::MakeIcub(given, /*is_usb=*/false);
  }
  if (name == "icub-usb") {
    return internal::client::MakeIcub(given, /*is_usb=*/true);
  }
  return internal::InvalidConfig("driver", internal::Quoted(name),
                                 internal::client::kDriverNames);
}

}  // namespace tactus
