// Any bytes on the serial line of a skin, and from a USB adapter. What comes
// out must keep its promises.
#include "client/drivers/can/can_error.h"
#include "client/drivers/can/gs_usb_protocol.h"
#include "client/drivers/serial/serial_frames.h"
#include "tests/fuzz/damaged.h"

namespace {

using namespace tactus::internal;
using namespace tactus::internal::client;

std::vector<std::string> GoodBytes(SerialFormat format) {
  std::string bytes;
  for (int frame = 0; frame < 4; ++frame) {
    if (format == SerialFormat::kAscii) {
      bytes += "1 2 3 4\n5,6,7,255\n0 0 0 0\n\n";
    } else {
      bytes += "\xAA\x55";
      bytes += std::string(12, static_cast<char>(frame));
    }
  }
  return {bytes};
}

void Serial(FuzzedDataProvider& data) {
  const auto format =
      data.ConsumeBool() ? SerialFormat::kAscii : SerialFormat::kAa55;
  const size_t piece = data.ConsumeIntegralInRange<size_t>(1, 64);
  SerialFrames frames(format, 3, 4);
  static const auto* const lines =
      new std::vector<std::string>(GoodBytes(SerialFormat::kAscii));
  static const auto* const packets =
      new std::vector<std::string>(GoodBytes(SerialFormat::kAa55));
  const std::string bytes =
      fuzz::Damaged(format == SerialFormat::kAscii ? *lines : *packets, data);
  int64_t now_ns = 0;
  uint64_t taken = 0;
  for (size_t i = 0; i < bytes.size(); i += piece) {
    const std::string part = bytes.substr(i, piece);
    ++now_ns;
    frames.Add({reinterpret_cast<const uint8_t*>(part.data()), part.size()},
               now_ns);
    std::vector<uint16_t> taxels;
    int64_t time_ns = 0;
    while (frames.Next(taxels, time_ns)) {
      ++taken;
      REQUIRE(taxels.size() == 12 && time_ns >= 1 && time_ns <= now_ns);
      for (const uint16_t taxel : taxels) {
        REQUIRE(format == SerialFormat::kAscii || taxel <= 255);
      }
    }
  }
  REQUIRE(frames.counters().frames == taken);
  REQUIRE(frames.counters().skipped_bytes <= bytes.size());
}

void Adapter(FuzzedDataProvider& data) {
  gs_usb::StampClock clock;
  int64_t now_ns = 0;
  int64_t last_ns = 0;
  while (data.remaining_bytes() > 0) {
    const auto bytes =
        data.ConsumeBytes<uint8_t>(data.ConsumeIntegralInRange<size_t>(0, 64));
    const bool with_stamp = data.ConsumeBool();
    const auto frame = gs_usb::ReadHostFrame(bytes, with_stamp);
    if (frame) {
      REQUIRE(frame->size <= 8);
      const CanFrame can = gs_usb::ToCanFrame(*frame);
      REQUIRE(can.id < 1U << 29 && can.bytes().size() == frame->size);
      ReadCanError(frame->can_id, can.bytes());
      now_ns += data.ConsumeIntegralInRange<int64_t>(0, 4'000'000'000'000);
      const int64_t host_ns = clock.HostTimeNs(frame->stamp_us, now_ns);
      REQUIRE(host_ns >= last_ns && host_ns <= now_ns);
      last_ns = host_ns;
    }
    const auto constants = gs_usb::ReadBitConstants(bytes);
    if (!constants) continue;
    const auto rate = data.ConsumeIntegral<uint32_t>();
    const auto timing = gs_usb::ChooseBitTiming(*constants, rate);
    fuzz::RequireReason(timing.status());
    if (!timing.ok()) continue;
    const uint64_t tseg1 = uint64_t{timing->prop_seg} + timing->phase_seg1;
    const uint64_t quanta = 1 + tseg1 + timing->phase_seg2;
    REQUIRE(quanta * timing->brp * rate == constants->clock_hz);
    REQUIRE(tseg1 >= constants->tseg1_min && tseg1 <= constants->tseg1_max);
    REQUIRE(timing->phase_seg2 >= constants->tseg2_min &&
            timing->phase_seg2 <= constants->tseg2_max);
    REQUIRE(timing->brp >= constants->brp_min &&
            timing->brp <= constants->brp_max);
    const uint32_t step = std::max(constants->brp_increment, 1U);
    REQUIRE((timing->brp - constants->brp_min) % step == 0);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  FuzzedDataProvider data(bytes, size);
  if (data.ConsumeBool()) {
    Serial(data);
  } else {
    Adapter(data);
  }
  return 0;
}
