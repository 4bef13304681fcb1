// File: triangle_frames.h
//
// The two CAN frames in which a board sends one triangle of an iCub's skin:
// the head with dots 0 to 6, the tail with dots 7 to 11 and the status.
//
//   const auto [head, tail] = icub::EncodeTriangle(1, 0, reading);
//   if (const auto part = icub::DecodePart(head)) Use(*part);
//
// Boards of older firmware leave the status out: their tails have 6 bytes. A
// head has 8 bytes; a frame of any other size, or that begins with another byte
// than 0x40 or 0xC0, is no part of a triangle. Functions without state;
// thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>

#include "client/drivers/icub_skin/board_messages.h"

namespace tactus::internal::client::icub {

struct TriangleStatus {
  // Bit k: dot k is out of the converter's range.
  uint16_t out_of_range = 0;
  // The converter did not answer, or is not there. The dots mean nothing then.
  bool no_answer = false;
  bool not_connected = false;

  bool IsValid() const { return !no_answer && !not_connected; }
  bool operator==(const TriangleStatus&) const = default;
};

struct TriangleReading {
  // As the board sends them: no_load untouched, lower if pressed.
  std::array<uint8_t, kDots> dots = {};
  TriangleStatus status;

  bool operator==(const TriangleReading&) const = default;
};

// One of the two frames.
struct TrianglePart {
  int address = 0;
  int triangle = 0;
  bool tail = false;
  // Dots 0 to 6 of a head, 7 to 11 of a tail; the others are 0.
  std::array<uint8_t, kDots> dots = {};
  // Only in a tail; without faults if the firmware sends none.
  TriangleStatus status;
};

inline constexpr int kHeadDots = 7;

// Head and tail, the latter with a status.
std::pair<CanFrame, CanFrame> EncodeTriangle(int address, int triangle,
                                             const TriangleReading& reading);

// True if its id is that of skin data of a board, whatever its bytes.
bool IsSkinData(const CanFrame& frame);
// Nothing if the frame is no part of a triangle.
std::optional<TrianglePart> DecodePart(const CanFrame& frame);

}  // namespace tactus::internal::client::icub
