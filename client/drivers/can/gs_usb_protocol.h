// File: gs_usb_protocol.h
//
// What gs_usb adapters (candleLight, CANable and others) and a host say to each
// other: the structures of control requests, host frames, bit timing, and time
// stamps. All numbers are little-endian.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       const gs_usb::BitTiming timing,
//       gs_usb::ChooseBitTiming(constants, /*bit_rate=*/1'000'000));
//   const auto frame = gs_usb::ReadHostFrame(bytes, /*with_stamp=*/true);
//
// Plain data and functions without state, but for StampClock. Thread-safe
// but for StampClock, which belongs to one thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "client/drivers/can/can_frame.h"

namespace tactus::internal::client::gs_usb {

enum class Request : uint8_t {
  kHostFormat = 0,
  kBitTiming = 1,
  kMode = 2,
  kBitConstants = 4,
  kDeviceConfig = 5,
  kTimestamp = 6,
};

// Features of a device, and flags of the mode that starts it.
inline constexpr uint32_t kHardwareStamps = 1U << 4;
inline constexpr uint32_t kPadded = 1U << 7;
// Devices that need one more byte in each frame to send.
inline constexpr uint32_t kExtraByte = 1U << 9;

inline constexpr uint32_t kHostFormat = 0x0000beef;
inline constexpr uint32_t kModeReset = 0;
inline constexpr uint32_t kModeStart = 1;
// The echo id of frames that another node has sent.
inline constexpr uint32_t kNoEcho = 0xFFFFFFFF;
inline constexpr uint8_t kOverflowFlag = 1U << 0;

inline constexpr size_t kDeviceConfigSize = 12;
inline constexpr size_t kBitConstantsSize = 40;
inline constexpr size_t kFrameSize = 20;
inline constexpr size_t kStampedFrameSize = 24;

struct BitConstants {
  uint32_t features = 0;
  uint32_t clock_hz = 0;
  uint32_t tseg1_min = 0;
  uint32_t tseg1_max = 0;
  uint32_t tseg2_min = 0;
  uint32_t tseg2_max = 0;
  uint32_t sjw_max = 0;
  uint32_t brp_min = 0;
  uint32_t brp_max = 0;
  uint32_t brp_increment = 0;
};

struct BitTiming {
  uint32_t prop_seg = 0;
  uint32_t phase_seg1 = 0;
  uint32_t phase_seg2 = 0;
  uint32_t sjw = 0;
  uint32_t brp = 0;

  bool operator==(const BitTiming&) const = default;
};

struct HostFrame {
  uint32_t echo_id = kNoEcho;
  // With the bits of can_error.h.
  uint32_t can_id = 0;
  uint8_t size = 0;
  uint8_t channel = 0;
  uint8_t flags = 0;
  std::array<uint8_t, 8> data = {};
  // Microseconds; 0 if the frame has none.
  uint32_t stamp_us = 0;
};

std::vector<uint8_t> Bytes(const BitTiming& timing);
// HOST_FORMAT, MODE and others: numbers one after another.
std::vector<uint8_t> Bytes(std::initializer_list<uint32_t> numbers);
// Nothing if the size is not kBitConstantsSize.
std::optional<BitConstants> ReadBitConstants(std::span<const uint8_t> bytes);
std::vector<uint8_t> Bytes(const BitConstants& constants);

// The timing whose sample point is nearest to 87.5 % of a bit; of several the
// one with about 16 quanta per bit. INVALID_CONFIG if the device's clock cannot
// make this rate.
absl::StatusOr<BitTiming> ChooseBitTiming(const BitConstants& constants,
                                          uint32_t bit_rate);

// `bytes` may be longer than a frame: adapters pad. Nothing if it is shorter,
// or its number of data bytes is above 8.
std::optional<HostFrame> ReadHostFrame(std::span<const uint8_t> bytes,
                                       bool with_stamp);
// kFrameSize bytes, or kStampedFrameSize.
std::vector<uint8_t> Bytes(const HostFrame& frame, bool with_stamp);

HostFrame ToHostFrame(const CanFrame& frame, uint32_t echo_id);
// For frames that are no error frames.
CanFrame ToCanFrame(const HostFrame& frame);

// Turns a device's stamps, 32 bits of microseconds that wrap around every 71.6
// minutes, into the host's time. The shortest delay seen so far counts as none;
// so that a drifting device is followed, that memory fades by 200 ppm.
class StampClock {
 public:
  // `now_ns` is when the host got the stamp; both rise from call to call.
  int64_t HostTimeNs(uint32_t stamp_us, int64_t now_ns);

 private:
  bool started_ = false;
  uint32_t last_stamp_us_ = 0;
  int64_t last_now_ns_ = 0;
  // The device's time without wrap-around.
  int64_t device_ns_ = 0;
  // Host time minus device time, for the shortest delay.
  int64_t offset_ns_ = 0;
  int64_t last_host_ns_ = 0;
};

}  // namespace tactus::internal::client::gs_usb
