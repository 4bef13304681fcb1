#include "client/drivers/icub_skin/triangle_frames.h"

#include <algorithm>

namespace tactus::internal::client::icub {
namespace {

constexpr uint8_t kHead = 0x40;
constexpr uint8_t kTail = 0xC0;
constexpr size_t kHeadSize = 8;
constexpr size_t kTailSize = 8;
constexpr size_t kTailSizeWithoutStatus = 6;
constexpr uint8_t kNoAnswer = 1;
constexpr uint8_t kNotConnected = 2;

}  // namespace

std::pair<CanFrame, CanFrame> EncodeTriangle(int address, int triangle,
                                             const TriangleReading& reading) {
  CanFrame head;
  head.id = MessageId(MessageClass::kPeriodicSkin, address, triangle);
  head.size = kHeadSize;
  head.data[0] = kHead;
  std::copy_n(reading.dots.begin(), kHeadDots, head.data.begin() + 1);
  CanFrame tail;
  tail.id = head.id;
  tail.size = kTailSize;
  tail.data[0] = kTail;
  std::copy(reading.dots.begin() + kHeadDots, reading.dots.end(),
            tail.data.begin() + 1);
  const TriangleStatus& status = reading.status;
  const int word = (status.out_of_range & 0xFFF) << 4 |
                   (status.no_answer ? kNoAnswer : 0) |
                   (status.not_connected ? kNotConnected : 0);
  tail.data[6] = static_cast<uint8_t>(word >> 8);
  tail.data[7] = static_cast<uint8_t>(word & 0xFF);
  return {head, tail};
}

bool IsSkinData(const CanFrame& frame) {
  const int address = static_cast<int>(frame.id >> 4 & 0xF);
  return !frame.extended && !frame.remote &&
         frame.id >> 8 == static_cast<uint32_t>(MessageClass::kPeriodicSkin) &&
         address >= kFirstBoard && address <= kLastBoard;
}

std::optional<TrianglePart> DecodePart(const CanFrame& frame) {
  if (!IsSkinData(frame)) return std::nullopt;
  TrianglePart part;
  part.address = static_cast<int>(frame.id >> 4 & 0xF);
  part.triangle = static_cast<int>(frame.id & 0xF);
  if (frame.size == kHeadSize && frame.data[0] == kHead) {
    std::copy_n(frame.data.begin() + 1, kHeadDots, part.dots.begin());
    return part;
  }
  const bool with_status = frame.size == kTailSize;
  if ((!with_status && frame.size != kTailSizeWithoutStatus) ||
      frame.data[0] != kTail) {
    return std::nullopt;
  }
  part.tail = true;
  std::copy_n(frame.data.begin() + 1, kDots - kHeadDots,
              part.dots.begin() + kHeadDots);
  if (with_status) {
    const int word = frame.data[6] << 8 | frame.data[7];
    part.status.out_of_range = static_cast<uint16_t>(word >> 4);
    part.status.no_answer = (word & kNoAnswer) != 0;
    part.status.not_connected = (word & kNotConnected) != 0;
  }
  return part;
}

}  // namespace tactus::internal::client::icub
