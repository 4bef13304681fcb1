// File: can_error.h
//
// CanError: what a controller reports about its bus in an error frame. The
// kernel and gs_usb adapters use the same layout (linux/can/error.h).
//
//   const CanError error = ReadCanError(id, data);
//   if (error.bus_off) Restart();
//
// Plain data and a function without state; thread-safe.
#pragma once

#include <cstdint>
#include <span>

namespace tactus::internal::client {

struct CanError {
  // The controller has left the bus after too many errors, until a restart.
  bool bus_off = false;
  // Frames were lost because nobody took them in time.
  bool overflow = false;
};

// Bits of an id that is more than a number.
inline constexpr uint32_t kCanExtendedBit = 0x80000000;
inline constexpr uint32_t kCanRemoteBit = 0x40000000;
inline constexpr uint32_t kCanErrorBit = 0x20000000;

// `id` with its kCanErrorBit; `data` as it came, of any size.
inline CanError ReadCanError(uint32_t id, std::span<const uint8_t> data) {
  constexpr uint32_t kController = 0x04;
  constexpr uint32_t kBusOff = 0x40;
  constexpr uint8_t kReceiveOverflow = 0x01;
  CanError error;
  error.bus_off = (id & kBusOff) != 0;
  error.overflow = (id & kController) != 0 && data.size() > 1 &&
                   (data[1] & kReceiveOverflow) != 0;
  return error;
}

}  // namespace tactus::internal::client
