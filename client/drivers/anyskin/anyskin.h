// File: anyskin.h
//
// AnySkin: an AnySkin or ReSkin magnetic skin on a serial line, as
// HardwareDriver runs it.
//
//   AnySkin skin("/dev/ttyACM0", {.sample_rate_hz = 100});
//   HardwareDriver driver(&skin, {});
//
// The board sends the fields of its magnetometers without being asked
// (magnet_frames.h). A taxel is a magnetometer; its values x, y and z are how
// far its field is from that of the untouched skin, in microtesla, signed, as
// float32.
//
// Untouched is the mean of the frames of one second in the first Setup, and of
// kMinTareFrames at least. It is refused if the skin is touched meanwhile
// (tare.h). From then on it follows slow changes over about `rezero_s`, and
// none while some taxel is at the layout's contact threshold or was within a
// second (drift_tracker.h). So a touch is not taken for a change, however long
// it lasts, unless it stays below the threshold. A skin that is plugged in
// again keeps it, because it may be touched then.
//
// The board's wires, format and order of chips are those of public code
// (raunaqbhirangi/anyskin); they were not verified with a skin. Not
// thread-safe.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "client/drivers/anyskin/magnet_frames.h"
#include "client/drivers/calibration/drift_tracker.h"
#include "client/drivers/calibration/idle_frames.h"
#include "client/drivers/calibration/touch_thresholds.h"
#include "client/drivers/serial/serial_port.h"
#include "client/drivers/skin_device.h"
#include "core/skin/layout.h"

namespace tactus::internal::client {

// A skin of so many magnetometers, in microtesla, whose load is the distance
// from the untouched skin. Lengths and thresholds are nominal. Five are a cross
// on 3 x 3 taxels, of which the corners are masked; any other number is a row.
SkinLayout AnySkinLayout(int magnets);

struct AnySkinOptions {
  // 1 to limits::kMaxMagnetometers.
  int magnets = 5;
  // Boards with a USB port of their own ignore it.
  int baud = 115'200;
  // Three signed axes; a taxel for each magnetometer in the order of the
  // frames, or for five the cross of AnySkinLayout. Unset: AnySkinLayout.
  std::optional<SkinLayout> layout = std::nullopt;
  // The layout's unit for each microtesla.
  double scale = 1;
  // As the board sends.
  double sample_rate_hz = 100;
  // The time over which the untouched skin is followed, 1 to 1e6; 0: it is not.
  double rezero_s = 60;
  // Setup waits this long for the first frame, and 8 periods at least.
  int64_t first_frame_ns = 2'000'000'000;
};

class AnySkin : public SkinDevice {
 public:
  // `clock` outlives the skin.
  AnySkin(std::string path, const AnySkinOptions& options,
          Clock* clock = &Clock::System());

  std::string name() const override { return port_.path(); }
  // INVALID_CONFIG for options that cannot be right; IO if the line cannot be
  // opened.
  absl::Status Open() override;
  void Close() override { port_.Close(); }
  // IO if too few frames come; INVALID_TRAINING_DATA if the skin is touched.
  absl::StatusOr<SkinInfo> Setup(Clock& clock) override;
  absl::Status Start() override;
  absl::Status Stop() override { return absl::OkStatus(); }
  absl::StatusOr<bool> Poll(SkinFrame& frame, int64_t timeout_ns) override;
  int64_t period_ns() const override { return period_ns_; }
  uint64_t incomplete() const override { return frames_.counters().spoiled; }
  // What came of the wish for low latency, and magnetometers that send the same
  // numbers all the time.
  std::string Remarks() const override;
  std::string Missing() const override;
  std::string Refused() const override { return frames_.Refused(); }

  const MagnetCounters& counters() const { return frames_.counters(); }
  // The untouched skin, x, y and z of each taxel; empty before the first Setup.
  std::vector<double> Untouched() const;

 private:
  static constexpr size_t kAxes = 3;

  absl::Status CheckOptions() const;
  // Which taxel of the layout each magnetometer is; empty if the layout has
  // another number of taxels.
  std::vector<size_t> Places() const;
  // True if a frame came, which is in field_ut_.
  absl::StatusOr<bool> PollField(int64_t& time_ns, int64_t timeout_ns);
  // field_ut_ as the values of the layout.
  void Arrange(std::vector<float>& values) const;
  // Takes the untouched skin.
  absl::Status TakeRest(Clock& clock);
  // Remarks on magnetometers that never change.
  void FindStill(const IdleFrames& idle);

  const AnySkinOptions options_;
  const SkinLayout layout_;
  const int64_t period_ns_;
  Clock* const clock_;
  SerialPort port_;
  MagnetFrames frames_;
  std::vector<size_t> places_;
  SkinInfo info_;
  // Empty before the first Setup.
  std::vector<double> rest_;
  std::optional<DriftTracker> drift_;
  std::optional<TouchThresholds> touch_;
  std::string still_;

  std::vector<float> field_ut_;
  std::vector<float> values_;
  std::vector<double> above_;
  std::array<uint8_t, 4096> buffer_;
  // Bytes in all, and at the start or at the last frame.
  uint64_t bytes_ = 0;
  uint64_t bytes_before_ = 0;
};

}  // namespace tactus::internal::client
