// File: board_messages.h
//
// Messages between a host and the skin boards of an iCub (CAN protocol of the
// sensor boards, version 1.12): the id of a message, discovery, configuration,
// start and stop. Each message has a function that makes it and one that reads
// it, so that a host and a simulated board speak the same.
//
//   const CanFrame discover = icub::Discover();
//   const CanFrame rate = icub::MakeMessage(
//       1, icub::BoardConfig{.period_ms = 50, .no_load = 245});
//
// An id is CLASS(3) | SOURCE(4) | DESTINATION or TYPE(4). The host is address
// 0, boards have 1 to 14. Boards do not answer a configuration, start or stop.
//
// A board must get its messages in this order, because BoardConfig switches
// all triangles off, and TriangleConfig stops it and takes what it reads now
// for an untouched skin: BoardConfig, TriangleConfig for each range of
// triangles, half a second of waiting, Start.
//
// Plain data and functions without state; thread-safe.
#pragma once

#include <cstdint>
#include <optional>

#include "client/drivers/can/can_frame.h"

namespace tactus::internal::client::icub {

inline constexpr int kFirstBoard = 1;
inline constexpr int kLastBoard = 14;
inline constexpr int kTriangles = 16;
inline constexpr int kDots = 12;
// Values of one board on a port: 192.
inline constexpr int kBoardValues = kTriangles * kDots;

enum class MessageClass : uint8_t {
  kPollAnalog = 2,
  kPeriodicSkin = 4,
  kManagement = 7,
};

// The id of a message; the arguments have 3, 4 and 4 bits.
constexpr uint32_t MessageId(MessageClass message_class, int source,
                             int destination_or_type) {
  return static_cast<uint32_t>(message_class) << 8 |
         static_cast<uint32_t>(source & 0xF) << 4 |
         static_cast<uint32_t>(destination_or_type & 0xF);
}

// How a board computes and when it sends.
struct BoardConfig {
  // 0 for compensated by temperature, 2 for not compensated.
  uint8_t compensation = 0;
  // From one scan to the next, ms.
  uint8_t period_ms = 50;
  // What an untouched dot reads. Pressing lowers it.
  uint8_t no_load = 245;

  bool operator==(const BoardConfig&) const = default;
};

// The same settings for triangles `first` to `last`, 0 to 15.
struct TriangleConfig {
  uint8_t first = 0;
  uint8_t last = kTriangles - 1;
  // Readings are divided by 2^shift.
  uint8_t shift = 2;
  bool enabled = true;
  // Offset of the capacitance-to-digital converter.
  uint16_t converter_offset = 0x2200;

  bool operator==(const TriangleConfig&) const = default;
};

enum class BoardType : uint8_t {
  kMtb = 5,
  kMtb4 = 11,
  kMtb4w = 16,
  kMtb4c = 20,
};

// What a board answers to a discovery.
struct BoardReply {
  int address = 0;
  // False: it runs its bootloader, and there is no skin.
  bool application = false;
  // A BoardType, or a board of another kind.
  uint8_t type = 0;
  uint8_t major = 0;
  uint8_t minor = 0;
  // 0 from a bootloader.
  uint8_t build = 0;

  // True if it is a skin board.
  bool HasSkin() const;
  bool operator==(const BoardReply&) const = default;
};

// Asks all boards who they are.
CanFrame Discover();
bool IsDiscover(const CanFrame& frame);
CanFrame MakeReply(const BoardReply& reply);
// Nothing if it is no reply to a discovery.
std::optional<BoardReply> ReadReply(const CanFrame& frame);

CanFrame MakeMessage(int address, const BoardConfig& config);
CanFrame MakeMessage(int address, const TriangleConfig& config);
// Starts or stops the sending of scans.
CanFrame MakeTransmit(int address, bool start);

// Messages of the host to board `address`; nothing if it is another message.
std::optional<BoardConfig> ReadBoardConfig(const CanFrame& frame, int address);
std::optional<TriangleConfig> ReadTriangleConfig(const CanFrame& frame,
                                                 int address);
// True for start, false for stop.
std::optional<bool> ReadTransmit(const CanFrame& frame, int address);

}  // namespace tactus::internal::client::icub
