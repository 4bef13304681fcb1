// File: can_frame.h
//
// CanFrame: one classic CAN frame, and CanFilter, which frames are wanted.
//
//   const CanFrame start = MakeCanFrame(0x201, {0x07, 0x00});
//   if (CanFilter{.id = 0x400, .mask = 0x700}.Passes(start)) Use(start);
//
// Plain data; thread-safe.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>

namespace tactus::internal::client {

struct CanFrame {
  // 11 bits, or 29 if `extended`.
  uint32_t id = 0;
  bool extended = false;
  // A request for data, which carries none.
  bool remote = false;
  // Number of bytes in use, 0 to 8.
  uint8_t size = 0;
  std::array<uint8_t, 8> data = {};
  // When it was received, on the driver's clock.
  int64_t time_ns = 0;

  std::span<const uint8_t> bytes() const { return {data.data(), size}; }
  // The same frame on the wire, whenever it was received.
  bool SameAs(const CanFrame& other) const {
    return id == other.id && extended == other.extended &&
           remote == other.remote && size == other.size && data == other.data;
  }
};

// At most 8 bytes are used.
inline CanFrame MakeCanFrame(uint32_t id,
                             std::initializer_list<uint8_t> bytes) {
  CanFrame frame;
  frame.id = id;
  frame.size = static_cast<uint8_t>(std::min(bytes.size(), size_t{8}));
  std::copy_n(bytes.begin(), frame.size, frame.data.begin());
  return frame;
}

struct CanFilter {
  // 11-bit ids whose bits under `mask` equal those of `id`.
  uint32_t id = 0;
  uint32_t mask = 0;

  bool Passes(const CanFrame& frame) const {
    return !frame.extended && !frame.remote && (frame.id & mask) == (id & mask);
  }
};

// True if some filter passes the frame. Without filters, all data frames pass.
inline bool PassesAny(std::span<const CanFilter> filters,
                      const CanFrame& frame) {
  if (filters.empty()) return !frame.remote;
  return std::any_of(filters.begin(), filters.end(),
                     [&](const CanFilter& f) { return f.Passes(frame); });
}

}  // namespace tactus::internal::client
