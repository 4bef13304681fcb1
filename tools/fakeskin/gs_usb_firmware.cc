#include "tools/fakeskin/gs_usb_firmware.h"

namespace tactus::internal::client {
namespace {

using gs_usb::Request;

constexpr size_t kModeSize = 8;

uint32_t LittleEndian(std::span<const uint8_t> bytes, size_t at) {
  uint32_t number = 0;
  for (size_t i = 4; i-- > 0;) number = number << 8 | bytes[at + i];
  return number;
}

}  // namespace

GsUsbFirmware::GsUsbFirmware(const GsUsbFirmwareOptions& options,
                             int64_t begin_ns)
    : options_(options), begin_ns_(begin_ns) {}

uint32_t GsUsbFirmware::StampUs(int64_t time_ns) const {
  return static_cast<uint32_t>(options_.first_stamp_us +
                               (time_ns - begin_ns_) / 1'000);
}

bool GsUsbFirmware::Write(uint8_t request, std::span<const uint8_t> bytes) {
  switch (static_cast<Request>(request)) {
    case Request::kHostFormat:
      return true;
    case Request::kBitTiming:
      bit_timing_.assign(bytes.begin(), bytes.end());
      return true;
    case Request::kMode:
      if (bytes.size() != kModeSize) return false;
      flags_ = LittleEndian(bytes, 4);
      // The real one refuses flags that it does not have, and a start without
      // a bit timing.
      started_ = LittleEndian(bytes, 0) == gs_usb::kModeStart &&
                 (flags_ & ~options_.features) == 0 && !bit_timing_.empty();
      return started_ || LittleEndian(bytes, 0) == gs_usb::kModeReset;
    default:
      return false;
  }
}

std::optional<std::vector<uint8_t>> GsUsbFirmware::Read(uint8_t request,
                                                        int64_t now_ns) const {
  switch (static_cast<Request>(request)) {
    case Request::kBitConstants:
      return gs_usb::Bytes(gs_usb::BitConstants{.features = options_.features,
                                                .clock_hz = options_.clock_hz,
                                                .tseg1_min = 1,
                                                .tseg1_max = 16,
                                                .tseg2_min = 1,
                                                .tseg2_max = 8,
                                                .sjw_max = 4,
                                                .brp_min = 1,
                                                .brp_max = 1024,
                                                .brp_increment = 1});
    case Request::kDeviceConfig: {
      std::vector<uint8_t> config(gs_usb::kDeviceConfigSize, 0);
      // The version of the software.
      config[4] = 2;
      return config;
    }
    case Request::kTimestamp:
      return gs_usb::Bytes({StampUs(now_ns)});
    default:
      return std::nullopt;
  }
}

std::optional<GsUsbFirmware::Sent> GsUsbFirmware::TakeSent(
    std::span<const uint8_t> bytes, int64_t now_ns) const {
  const auto frame = gs_usb::ReadHostFrame(bytes, false);
  if (!frame || !started_) return std::nullopt;
  gs_usb::HostFrame echo = *frame;
  bool stamp = (flags_ & gs_usb::kHardwareStamps) != 0;
  if (options_.old_echoes) {
    echo.flags = gs_usb::kOverflowFlag;
    stamp = false;
  }
  echo.stamp_us = StampUs(now_ns);
  return Sent{.frame = gs_usb::ToCanFrame(*frame),
              .echo = gs_usb::Bytes(echo, stamp)};
}

std::vector<uint8_t> GsUsbFirmware::FromBus(const CanFrame& frame) const {
  gs_usb::HostFrame host = gs_usb::ToHostFrame(frame, gs_usb::kNoEcho);
  host.stamp_us = StampUs(frame.time_ns);
  auto bytes = gs_usb::Bytes(host, (flags_ & gs_usb::kHardwareStamps) != 0);
  if ((flags_ & gs_usb::kPadded) != 0) bytes.resize(kPacketBytes, 0);
  return bytes;
}

}  // namespace tactus::internal::client
