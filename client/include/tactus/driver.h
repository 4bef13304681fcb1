// File: driver.h
//
// Driver: where frames come from, be it hardware, a simulation or a recording.
// Tactus has some (MakeDriver); this is one of a user's own:
//
//   class MySkin : public Driver {
//    public:
//     absl::StatusOr<Skin> Configure() override {
//       return Skin{.name = "cody-forearm", .scale = 0.001};
//     }
//     absl::StatusOr<ReadResult> Read(Frame& frame) override {
//       frame.values.assign(16 * 24, 0.0F);
//       return ReadResult::kFrame;
//     }
//   };
//
// In a shared library, `tactus-stream --driver=./my_skin.so` and MakeDriver
// load it; write this at namespace scope, once in a library:
//
//   TACTUS_DRIVER([](const DriverOptions&) {
//     return std::make_unique<MySkin>();
//   })
//
// Such a library needs the headers of Tactus and links none of its libraries.
// It must be built with the headers of the program's release and the same
// compiler, because objects are handed over; kDriverAbi is compared before
// anything is called.
//
// The order of calls is Configure, Activate, Read as often as there are frames,
// Deactivate, and again from Activate on; Finalise is the last. Not
// thread-safe: each driver belongs to one thread.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "tactus/skin.h"

namespace tactus {

enum class ReadResult {
  // A frame was read.
  kFrame,
  // No frame: the trial is over, the next frame begins another.
  kEndOfTrial,
  // No frame: nothing will follow.
  kEndOfData,
  // No frame yet: the hardware sends none at the moment. Statistics() may say
  // why. Read again.
  kNoFrame,
};

// How well frames come from a skin.
struct DriverStatistics {
  // Whole frames that the skin delivered, and frames that should have come
  // between them.
  uint64_t frames = 0;
  uint64_t lost = 0;
  // Whole frames that were dropped because their pose was not known; the next
  // frame's gap counts them in `lost`.
  uint64_t without_pose = 0;
  // Parts of lost frames came: boards' scans that were not complete.
  uint64_t incomplete = 0;
  // Frames that nobody read in time; they are not in `lost`.
  uint64_t overwritten = 0;
  // Breaks in the connection after which frames came again.
  uint64_t reconnects = 0;
  // Frames per second, and the standard deviation of the time between frames.
  double rate_hz = 0;
  double jitter_ms = 0;
  // From capture to Read, of the last frame, and the longest so far.
  double age_ms = 0;
  double longest_age_ms = 0;
  // False between a break and the next frame.
  bool connected = false;
  // The last reason for a break; stays after it.
  std::string problem = {};
  // Why frames have no pose and are dropped; empty while they have one.
  std::string pose_problem = {};
  // Why frames that came whole were refused; empty if none were.
  std::string refused = {};
  // What was found when the skin was configured, e.g. masked triangles.
  std::string remarks = {};
  // Taxels, row-major, that have read the same value above 0 for 10 s.
  std::vector<int> stuck_taxels = {};
};

class Driver {
 public:
  virtual ~Driver() = default;

  // What all frames are like.
  virtual absl::StatusOr<Skin> Configure() = 0;
  virtual absl::Status Activate() { return absl::OkStatus(); }
  // Overwrites `frame`, whose memory is used again.
  virtual absl::StatusOr<ReadResult> Read(Frame& frame) = 0;
  virtual absl::Status Deactivate() { return absl::OkStatus(); }
  // Gives up the hardware, whatever was called before.
  virtual absl::Status Finalise() { return absl::OkStatus(); }

  // Zeros for drivers without hardware.
  virtual DriverStatistics Statistics() const { return {}; }
};

// By name; numbers are written as text.
using DriverOptions = std::map<std::string, std::string>;

// Makes a driver of Tactus (library Tactus::drivers), or of a shared library:
//
//   "sim"       simulated contacts; skin (good), seed (1), trials (40)
//   "replay"    recorded ones; data (a trial file), trials (all)
//   "serial"    a skin on a serial line; port, format (ascii), baud (2000000),
//               rate_hz (30), scale (1)
//   "anyskin"   an AnySkin or ReSkin magnetic skin; port, magnets (5), rate_hz
//               (100), scale (1), baud (115200), rezero_s (60: seconds over
//               which it is followed while untouched; 0: it is not)
//   "xela-can"  XELA's patches; interface (can0), scale (1)
//   "icub-can"  the iCub's boards; interface (can0), boards (forearm-v2),
//               positions (a file of icub-main), period_ms (20), scale (1)
//   "icub-usb"  the same behind a USB adapter; usb_serial instead of interface
//               of these five also: calibration (a file of trainctl skin
//               calibrate), device (the name in that file), tare (frames at the
//               start whose mean is an untouched skin)
//   "./x.so"    a library with TACTUS_DRIVER; its own options
//
// In parentheses stands what an absent option means. INVALID_CONFIG for an
// unknown name, an unknown or missing option, or a wrong value.
absl::StatusOr<std::unique_ptr<Driver>> MakeDriver(
    const std::string& name, const DriverOptions& options = {});

// Changes with each change of Driver, Skin, Frame or what they refer to.
inline constexpr int kDriverAbi = 2;

}  // namespace tactus

// `make`: DriverOptions -> std::unique_ptr<Driver>, or a StatusOr of it.
#define TACTUS_DRIVER(make)                                           \
  extern "C" int tactus_driver_abi() { return ::tactus::kDriverAbi; } \
  extern "C" void tactus_make_driver(                                 \
      const ::tactus::DriverOptions& options,                         \
      ::absl::StatusOr<std::unique_ptr<::tactus::Driver>>* driver) {  \
    *driver = (make)(options);                                        \
  }
