#include "client/drivers/icub_skin/board_messages.h"

namespace tactus::internal::client::icub {
namespace {

constexpr uint8_t kDiscover = 0xFF;
constexpr uint8_t kTransmit = 0x07;
constexpr uint8_t kBoardConfig = 0x4D;
constexpr uint8_t kTriangleConfig = 0x50;
constexpr int kHost = 0;
constexpr int kEveryone = 15;

uint32_t CommandId(int address) {
  return MessageId(MessageClass::kPollAnalog, kHost, address);
}

// A command of `size` bytes or more to this board.
bool IsCommand(const CanFrame& frame, int address, uint8_t command,
               size_t size) {
  return !frame.extended && !frame.remote && frame.id == CommandId(address) &&
         frame.size >= size && frame.data[0] == command;
}

}  // namespace

bool BoardReply::HasSkin() const {
  return type == static_cast<uint8_t>(BoardType::kMtb) ||
         type == static_cast<uint8_t>(BoardType::kMtb4) ||
         type == static_cast<uint8_t>(BoardType::kMtb4w) ||
         type == static_cast<uint8_t>(BoardType::kMtb4c);
}

CanFrame Discover() {
  return MakeCanFrame(MessageId(MessageClass::kManagement, kHost, kEveryone),
                      {kDiscover});
}

bool IsDiscover(const CanFrame& frame) { return frame.SameAs(Discover()); }

CanFrame MakeReply(const BoardReply& reply) {
  const uint32_t id =
      MessageId(MessageClass::kManagement, reply.address, kHost);
  if (reply.application) {
    return MakeCanFrame(
        id, {kDiscover, reply.type, reply.major, reply.minor, reply.build});
  }
  return MakeCanFrame(id, {kDiscover, reply.type, reply.major, reply.minor});
}

std::optional<BoardReply> ReadReply(const CanFrame& frame) {
  const int address = static_cast<int>(frame.id >> 4 & 0xF);
  if (frame.extended || frame.remote || address < kFirstBoard ||
      address > kLastBoard ||
      frame.id != MessageId(MessageClass::kManagement, address, kHost) ||
      (frame.size != 4 && frame.size != 5) || frame.data[0] != kDiscover) {
    return std::nullopt;
  }
  return BoardReply{.address = address,
                    .application = frame.size == 5,
                    .type = frame.data[1],
                    .major = frame.data[2],
                    .minor = frame.data[3],
                    .build = frame.size == 5 ? frame.data[4] : uint8_t{0}};
}

CanFrame MakeMessage(int address, const BoardConfig& config) {
  return MakeCanFrame(CommandId(address), {kBoardConfig, config.compensation,
                                           config.period_ms, config.no_load});
}

CanFrame MakeMessage(int address, const TriangleConfig& config) {
  return MakeCanFrame(CommandId(address),
                      {kTriangleConfig, config.first, config.last, config.shift,
                       static_cast<uint8_t>(config.enabled),
                       static_cast<uint8_t>(config.converter_offset & 0xFF),
                       static_cast<uint8_t>(config.converter_offset >> 8)});
}

CanFrame MakeTransmit(int address, bool start) {
  return MakeCanFrame(CommandId(address),
                      {kTransmit, static_cast<uint8_t>(start ? 0 : 1)});
}

std::optional<BoardConfig> ReadBoardConfig(const CanFrame& frame, int address) {
  if (!IsCommand(frame, address, kBoardConfig, 4)) return std::nullopt;
  // Older hosts leave other bits in the upper half.
  return BoardConfig{.compensation = static_cast<uint8_t>(frame.data[1] & 0x0F),
                     .period_ms = frame.data[2],
                     .no_load = frame.data[3]};
}

std::optional<TriangleConfig> ReadTriangleConfig(const CanFrame& frame,
                                                 int address) {
  if (!IsCommand(frame, address, kTriangleConfig, 7) ||
      frame.data[1] >= kTriangles || frame.data[2] >= kTriangles) {
    return std::nullopt;
  }
  return TriangleConfig{.first = frame.data[1],
                        .last = frame.data[2],
                        .shift = frame.data[3],
                        .enabled = (frame.data[4] & 1) != 0,
                        .converter_offset = static_cast<uint16_t>(
                            frame.data[5] | frame.data[6] << 8)};
}

std::optional<bool> ReadTransmit(const CanFrame& frame, int address) {
  if (!IsCommand(frame, address, kTransmit, 2) || frame.data[1] > 1) {
    return std::nullopt;
  }
  return frame.data[1] == 0;
}

}  // namespace tactus::internal::client::icub
