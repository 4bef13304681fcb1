#include "client/drivers/can/gs_usb_protocol.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "absl/strings/str_cat.h"
#include "client/drivers/can/can_error.h"
#include "core/base/errors.h"

namespace tactus::internal::client::gs_usb {
namespace {

void AppendNumber(uint32_t number, std::vector<uint8_t>& bytes) {
  for (int shift = 0; shift < 32; shift += 8) {
    bytes.push_back(static_cast<uint8_t>(number >> shift & 0xFF));
  }
}

uint32_t NumberAt(std::span<const uint8_t> bytes, size_t at) {
  uint32_t number = 0;
  for (int i = 3; i >= 0; --i) number = number << 8 | bytes[at + i];
  return number;
}

}  // namespace

std::vector<uint8_t> Bytes(std::initializer_list<uint32_t> numbers) {
  std::vector<uint8_t> bytes;
  for (const uint32_t number : numbers) AppendNumber(number, bytes);
  return bytes;
}

std::vector<uint8_t> Bytes(const BitTiming& t) {
  return Bytes({t.prop_seg, t.phase_seg1, t.phase_seg2, t.sjw, t.brp});
}

std::vector<uint8_t> Bytes(const BitConstants& c) {
  return Bytes({c.features, c.clock_hz, c.tseg1_min, c.tseg1_max, c.tseg2_min,
                c.tseg2_max, c.sjw_max, c.brp_min, c.brp_max, c.brp_increment});
}

std::optional<BitConstants> ReadBitConstants(std::span<const uint8_t> bytes) {
  if (bytes.size() != kBitConstantsSize) return std::nullopt;
  const auto number = [&](size_t i) { return NumberAt(bytes, 4 * i); };
  return BitConstants{.features = number(0),
                      .clock_hz = number(1),
                      .tseg1_min = number(2),
                      .tseg1_max = number(3),
                      .tseg2_min = number(4),
                      .tseg2_max = number(5),
                      .sjw_max = number(6),
                      .brp_min = number(7),
                      .brp_max = number(8),
                      .brp_increment = number(9)};
}

absl::StatusOr<BitTiming> ChooseBitTiming(const BitConstants& constants,
                                          uint32_t bit_rate) {
  constexpr double kSamplePoint = 0.875;
  constexpr int64_t kUsualQuanta = 16;
  // No device has more; bounds the search whatever the device says.
  constexpr uint64_t kMaxQuanta = 1'000;
  constexpr uint64_t kMaxPrescaler = 4'096;
  std::optional<BitTiming> best;
  double best_error = 0;
  int64_t best_distance = 0;
  // In 64 bits, because sums of the device's numbers may exceed 32.
  const uint64_t step = std::max(constants.brp_increment, 1U);
  const uint64_t last = std::min<uint64_t>(constants.brp_max, kMaxPrescaler);
  for (uint64_t brp = constants.brp_min; brp <= last; brp += step) {
    const uint64_t divisor = brp * bit_rate;
    if (divisor == 0 || constants.clock_hz % divisor != 0) continue;
    const uint64_t quanta = constants.clock_hz / divisor;
    if (quanta > kMaxQuanta) continue;
    // One quantum synchronises, and tseg1 has two parts.
    for (uint64_t tseg2 = std::max(constants.tseg2_min, 1U);
         tseg2 <= constants.tseg2_max && tseg2 + 3 <= quanta; ++tseg2) {
      const uint64_t tseg1 = quanta - 1 - tseg2;
      if (tseg1 < constants.tseg1_min || tseg1 > constants.tseg1_max) continue;
      const double error = std::abs(static_cast<double>(1 + tseg1) /
                                        static_cast<double>(quanta) -
                                    kSamplePoint);
      const int64_t distance =
          std::abs(static_cast<int64_t>(quanta) - kUsualQuanta);
      constexpr double kEqual = 1e-9;
      if (best &&
          (error > best_error + kEqual ||
           (error > best_error - kEqual && distance >= best_distance))) {
        continue;
      }
      best = BitTiming{.prop_seg = 1,
                       .phase_seg1 = static_cast<uint32_t>(tseg1 - 1),
                       .phase_seg2 = static_cast<uint32_t>(tseg2),
                       .sjw = 1,
                       .brp = static_cast<uint32_t>(brp)};
      best_error = error;
      best_distance = distance;
    }
  }
  // A sample point far from the usual one works on the shortest cables only.
  constexpr double kMaxError = 0.15;
  if (!best || best_error > kMaxError) {
    return InvalidConfig("CAN bit rate", bit_rate,
                         absl::StrCat("one that the adapter's clock of ",
                                      constants.clock_hz, " Hz can make"));
  }
  return *best;
}

std::optional<HostFrame> ReadHostFrame(std::span<const uint8_t> bytes,
                                       bool with_stamp) {
  if (bytes.size() < (with_stamp ? kStampedFrameSize : kFrameSize)) {
    return std::nullopt;
  }
  HostFrame frame;
  frame.echo_id = NumberAt(bytes, 0);
  frame.can_id = NumberAt(bytes, 4);
  frame.size = bytes[8];
  frame.channel = bytes[9];
  frame.flags = bytes[10];
  if (frame.size > frame.data.size()) return std::nullopt;
  std::copy_n(bytes.begin() + 12, frame.data.size(), frame.data.begin());
  if (with_stamp) frame.stamp_us = NumberAt(bytes, kFrameSize);
  return frame;
}

std::vector<uint8_t> Bytes(const HostFrame& frame, bool with_stamp) {
  std::vector<uint8_t> bytes = Bytes({frame.echo_id, frame.can_id});
  bytes.insert(bytes.end(), {frame.size, frame.channel, frame.flags, 0});
  bytes.insert(bytes.end(), frame.data.begin(), frame.data.end());
  if (with_stamp) AppendNumber(frame.stamp_us, bytes);
  return bytes;
}

HostFrame ToHostFrame(const CanFrame& frame, uint32_t echo_id) {
  HostFrame host;
  host.echo_id = echo_id;
  host.can_id = frame.id | (frame.extended ? kCanExtendedBit : 0) |
                (frame.remote ? kCanRemoteBit : 0);
  host.size = std::min<uint8_t>(frame.size, 8);
  host.data = frame.data;
  return host;
}

CanFrame ToCanFrame(const HostFrame& frame) {
  constexpr uint32_t kStandardMask = 0x7FF;
  constexpr uint32_t kExtendedMask = 0x1FFFFFFF;
  CanFrame can;
  can.extended = (frame.can_id & kCanExtendedBit) != 0;
  can.remote = (frame.can_id & kCanRemoteBit) != 0;
  can.id = frame.can_id & (can.extended ? kExtendedMask : kStandardMask);
  can.size = frame.size;
  can.data = frame.data;
  return can;
}

int64_t StampClock::HostTimeNs(uint32_t stamp_us, int64_t now_ns) {
  // After a longer silence a stamp may have wrapped around more than once.
  constexpr int64_t kLongestSilenceNs = 1'000'000'000'000;
  if (!started_ || now_ns - last_now_ns_ > kLongestSilenceNs) {
    started_ = true;
    device_ns_ = int64_t{stamp_us} * 1'000;
    offset_ns_ = now_ns - device_ns_;
  } else {
    // Signed, so that a stamp out of order goes back by little.
    const auto step = static_cast<int32_t>(stamp_us - last_stamp_us_);
    device_ns_ += int64_t{step} * 1'000;
    const int64_t faded = (now_ns - last_now_ns_) / 5'000;
    offset_ns_ = std::min(offset_ns_ + faded, now_ns - device_ns_);
  }
  last_stamp_us_ = stamp_us;
  last_now_ns_ = now_ns;
  last_host_ns_ = std::max(last_host_ns_, device_ns_ + offset_ns_);
  return last_host_ns_;
}

}  // namespace tactus::internal::client::gs_usb
