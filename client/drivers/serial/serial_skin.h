// File: serial_skin.h
//
// SerialSkin: a skin that sends whole frames on a serial line without being
// asked, as HardwareDriver runs it.
//
//   TACTUS_ASSIGN_OR_RETURN(SkinLayout layout, LayoutPreset("vitac-12x32"));
//   SerialSkin skin("/dev/ttyUSB0", {.format = SerialFormat::kAscii,
//                                    .layout = layout,
//                                    .sample_rate_hz = 30});
//   HardwareDriver driver(&skin, {});
//
// Values are handed on as they come. The line is asked for low latency;
// Remarks() says what came of it. Not thread-safe.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "client/drivers/serial/serial_frames.h"
#include "client/drivers/serial/serial_port.h"
#include "client/drivers/serial/serial_shape.h"
#include "client/drivers/skin_device.h"
#include "core/skin/layout.h"

namespace tactus::internal::client {

struct SerialSkinOptions {
  SerialFormat format = SerialFormat::kAscii;
  int baud = 2'000'000;
  SkinLayout layout = {};
  // The layout's unit for each count of the skin.
  double scale = 1;
  // As the skin sends.
  double sample_rate_hz = 30;
  // Setup waits this long for the first frame, and 8 periods at least.
  int64_t first_frame_ns = 2'000'000'000;
};

class SerialSkin : public SkinDevice {
 public:
  SerialSkin(std::string path, const SerialSkinOptions& options,
             Clock* clock = &Clock::System());

  std::string name() const override { return port_.path(); }
  absl::Status Open() override;
  void Close() override { port_.Close(); }
  // IO if no frame comes.
  absl::StatusOr<SkinInfo> Setup(Clock& clock) override;
  absl::Status Start() override;
  absl::Status Stop() override { return absl::OkStatus(); }
  absl::StatusOr<bool> Poll(SkinFrame& frame, int64_t timeout_ns) override;
  int64_t period_ns() const override;
  uint64_t incomplete() const override { return frames_.counters().spoiled; }
  std::string Remarks() const override { return port_.latency(); }
  std::string Missing() const override;
  std::string Refused() const override { return frames_.OutOfRange(); }

  const SerialCounters& counters() const { return frames_.counters(); }

 private:
  const SerialSkinOptions options_;
  Clock* const clock_;
  SerialPort port_;
  SerialFrames frames_;
  // What comes if it is not what the layout and the format say; until the first
  // frame.
  std::vector<SerialShapeFinder> finders_;
  std::array<uint8_t, 4096> buffer_;
  // Bytes in all, and bytes and blocks at the start or at the last frame.
  uint64_t bytes_ = 0;
  uint64_t bytes_before_ = 0;
  uint64_t blocks_before_ = 0;
};

}  // namespace tactus::internal::client
