#include "client/drivers/can/gs_usb.h"

#include <libusb.h>

#include <algorithm>
#include <array>
#include <bitset>
#include <deque>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/drivers/can/can_error.h"
#include "client/drivers/can/gs_usb_protocol.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::internal::client {
namespace {

struct UsbId {
  uint16_t vendor;
  uint16_t product;
};
constexpr UsbId kAdapters[] = {
    {0x1d50, 0x606f}, {0x1209, 0x2323}, {0x1cd2, 0x606f}, {0x16d0, 0x10b8}};

constexpr int kInterface = 0;
constexpr uint8_t kInEndpoint = 0x81;
constexpr uint8_t kOutEndpoint = 0x02;
constexpr unsigned kControlTimeoutMs = 1'000;
constexpr size_t kTransferBytes = 64;
// What the kernel's driver allows in flight; adapters expect no more.
constexpr size_t kMaxSends = 10;
constexpr int64_t kSendWaitNs = 50'000'000;
constexpr int64_t kCloseWaitNs = 500'000'000;
// Transfers that fail one after another before the adapter counts as gone.
constexpr int kMaxFailures = 100;

absl::Status UsbError(const std::string& name, absl::string_view what,
                      int error) {
  std::string advice;
  if (error == LIBUSB_ERROR_ACCESS) {
    advice = ": this user may not use the device (udev rule)";
  } else if (error == LIBUSB_ERROR_BUSY) {
    advice = ": another program uses it";
  }
  return IoError(name,
                 absl::StrCat(what, ": ", libusb_strerror(error), advice));
}

bool IsAdapter(const libusb_device_descriptor& descriptor) {
  return std::any_of(std::begin(kAdapters), std::end(kAdapters),
                     [&](const UsbId& id) {
                       return id.vendor == descriptor.idVendor &&
                              id.product == descriptor.idProduct;
                     });
}

std::string SerialOf(libusb_device_handle* handle,
                     const libusb_device_descriptor& descriptor) {
  unsigned char text[128];
  const int size = libusb_get_string_descriptor_ascii(
      handle, descriptor.iSerialNumber, text, sizeof(text));
  return size > 0 ? std::string(text, text + size) : "";
}

}  // namespace

// One adapter from Open to Close. Its callbacks run in libusb's event handling,
// which only this object's methods call.
class GsUsb::Device {
 public:
  Device(std::string name, const GsUsbOptions& options, Clock* clock,
         CanCounters* counters, std::span<const CanFilter> filters)
      : name_(std::move(name)),
        options_(options),
        clock_(clock),
        counters_(counters),
        filters_(filters.begin(), filters.end()) {}
  ~Device() { Stop(); }

  absl::Status Start();
  absl::Status Send(const CanFrame& frame);
  absl::StatusOr<bool> Receive(CanFrame& frame, int64_t timeout_ns);

 private:
  struct Transfer {
    Device* device = nullptr;
    libusb_transfer* usb = nullptr;
    std::array<uint8_t, kTransferBytes> bytes = {};
    bool in_flight = false;
  };

  absl::Status Find();
  absl::Status Prepare();
  void Stop();
  int Control(uint8_t direction, gs_usb::Request request, uint16_t value,
              std::span<uint8_t> bytes);
  absl::Status Out(const char* what, gs_usb::Request request, uint16_t value,
                   std::vector<uint8_t> bytes);
  absl::Status In(const char* what, gs_usb::Request request, uint16_t value,
                  std::span<uint8_t> bytes);
  void HandleEvents(int64_t timeout_ns);
  void Submit(Transfer& transfer);
  static void OnReceived(libusb_transfer* usb);
  static void OnSent(libusb_transfer* usb);
  void Use(std::span<const uint8_t> bytes);
  void AwaitEchoes();
  bool AnyInFlight() const;
  absl::Status Gone() const;

  const std::string name_;
  const GsUsbOptions options_;
  Clock* const clock_;
  CanCounters* const counters_;
  const std::vector<CanFilter> filters_;

  libusb_context* context_ = nullptr;
  libusb_device_handle* handle_ = nullptr;
  bool claimed_ = false;
  bool had_driver_ = false;
  bool running_ = false;
  bool stopping_ = false;
  bool stamps_ = false;
  // Bytes of a frame to send.
  size_t send_size_ = gs_usb::kFrameSize;
  gs_usb::StampClock stamp_clock_;
  std::vector<std::unique_ptr<Transfer>> receives_;
  std::array<Transfer, kMaxSends> sends_;
  // Echo ids whose frame has not been on the wire.
  std::bitset<kMaxSends> waiting_echoes_;
  std::deque<CanFrame> received_;
  int failures_ = 0;
  bool bus_off_ = false;
  // Why the adapter cannot be used any more; 0: it can.
  int gone_ = 0;
};

absl::Status GsUsb::Device::Start() {
  int error = libusb_init(&context_);
  if (error < 0) return UsbError(name_, "libusb", error);
  TACTUS_RETURN_IF_ERROR(Find());
  if (libusb_kernel_driver_active(handle_, kInterface) == 1) {
    error = libusb_detach_kernel_driver(handle_, kInterface);
    if (error < 0) return UsbError(name_, "detach the kernel's driver", error);
    had_driver_ = true;
  }
  error = libusb_claim_interface(handle_, kInterface);
  if (error < 0) return UsbError(name_, "claim", error);
  claimed_ = true;
  return Prepare();
}

absl::Status GsUsb::Device::Find() {
  libusb_device** devices = nullptr;
  const ssize_t count = libusb_get_device_list(context_, &devices);
  if (count < 0) return UsbError(name_, "list", static_cast<int>(count));
  absl::Status status =
      IoError(name_, options_.serial.empty()
                         ? "there is no gs_usb adapter (1d50:606f, 1209:2323, "
                           "1cd2:606f or 16d0:10b8)"
                         : "there is no gs_usb adapter of this serial number");
  for (ssize_t i = 0; i < count && handle_ == nullptr; ++i) {
    libusb_device_descriptor descriptor;
    if (libusb_get_device_descriptor(devices[i], &descriptor) < 0 ||
        !IsAdapter(descriptor)) {
      continue;
    }
    libusb_device_handle* handle = nullptr;
    if (const int error = libusb_open(devices[i], &handle); error < 0) {
      status = UsbError(name_, "open", error);
      continue;
    }
    if (options_.serial.empty() ||
        SerialOf(handle, descriptor) == options_.serial) {
      handle_ = handle;
    } else {
      libusb_close(handle);
    }
  }
  libusb_free_device_list(devices, 1);
  return handle_ != nullptr ? absl::OkStatus() : status;
}

int GsUsb::Device::Control(uint8_t direction, gs_usb::Request request,
                           uint16_t value, std::span<uint8_t> bytes) {
  return libusb_control_transfer(
      handle_,
      static_cast<uint8_t>(direction | LIBUSB_REQUEST_TYPE_VENDOR |
                           LIBUSB_RECIPIENT_INTERFACE),
      static_cast<uint8_t>(request), value, 0, bytes.data(),
      static_cast<uint16_t>(bytes.size()), kControlTimeoutMs);
}

absl::Status GsUsb::Device::Out(const char* what, gs_usb::Request request,
                                uint16_t value, std::vector<uint8_t> bytes) {
  const int sent = Control(LIBUSB_ENDPOINT_OUT, request, value, bytes);
  return sent < 0 ? UsbError(name_, what, sent) : absl::OkStatus();
}

absl::Status GsUsb::Device::In(const char* what, gs_usb::Request request,
                               uint16_t value, std::span<uint8_t> bytes) {
  const int got = Control(LIBUSB_ENDPOINT_IN, request, value, bytes);
  if (got < 0) return UsbError(name_, what, got);
  if (static_cast<size_t>(got) == bytes.size()) return absl::OkStatus();
  return IoError(name_,
                 absl::StrCat(what, ": ", got, " bytes, not ", bytes.size()));
}

absl::Status GsUsb::Device::Prepare() {
  using gs_usb::Request;
  const auto channel = static_cast<uint16_t>(options_.channel);
  TACTUS_RETURN_IF_ERROR(Out("reset", Request::kMode, channel,
                             gs_usb::Bytes({gs_usb::kModeReset, 0})));
  TACTUS_RETURN_IF_ERROR(Out("byte order", Request::kHostFormat, 1,
                             gs_usb::Bytes({gs_usb::kHostFormat})));
  std::array<uint8_t, gs_usb::kDeviceConfigSize> config;
  TACTUS_RETURN_IF_ERROR(
      In("configuration", Request::kDeviceConfig, 1, config));
  const int last_channel = config[3];
  if (options_.channel < 0 || options_.channel > last_channel) {
    return InvalidConfig("channel of the adapter", options_.channel,
                         absl::StrCat("0 to ", last_channel));
  }
  std::array<uint8_t, gs_usb::kBitConstantsSize> constant_bytes;
  TACTUS_RETURN_IF_ERROR(
      In("bit constants", Request::kBitConstants, channel, constant_bytes));
  const auto constants = gs_usb::ReadBitConstants(constant_bytes);
  TACTUS_ASSIGN_OR_RETURN(
      const gs_usb::BitTiming timing,
      gs_usb::ChooseBitTiming(*constants, options_.bit_rate));
  TACTUS_RETURN_IF_ERROR(
      Out("bit timing", Request::kBitTiming, channel, gs_usb::Bytes(timing)));
  // A device refuses flags of features that it lacks.
  stamps_ = (constants->features & gs_usb::kHardwareStamps) != 0;
  const uint32_t flags =
      constants->features & (gs_usb::kHardwareStamps | gs_usb::kPadded);
  if ((constants->features & gs_usb::kExtraByte) != 0) ++send_size_;
  if ((flags & gs_usb::kPadded) != 0) {
    const int packet =
        libusb_get_max_packet_size(libusb_get_device(handle_), kOutEndpoint);
    send_size_ = std::clamp(static_cast<size_t>(std::max(packet, 0)),
                            send_size_, kTransferBytes);
  }
  for (int i = 0; i < std::clamp(options_.transfers, 1, 256); ++i) {
    auto& transfer = receives_.emplace_back(std::make_unique<Transfer>());
    transfer->device = this;
    transfer->usb = libusb_alloc_transfer(0);
    libusb_fill_bulk_transfer(transfer->usb, handle_, kInEndpoint,
                              transfer->bytes.data(), kTransferBytes,
                              &Device::OnReceived, transfer.get(), 0);
    Submit(*transfer);
  }
  for (Transfer& transfer : sends_) {
    transfer.device = this;
    transfer.usb = libusb_alloc_transfer(0);
    libusb_fill_bulk_transfer(
        transfer.usb, handle_, kOutEndpoint, transfer.bytes.data(),
        static_cast<int>(send_size_), &Device::OnSent, &transfer, 0);
  }
  TACTUS_RETURN_IF_ERROR(Out("start", Request::kMode, channel,
                             gs_usb::Bytes({gs_usb::kModeStart, flags})));
  running_ = true;
  return absl::OkStatus();
}

void GsUsb::Device::Stop() {
  if (running_) AwaitEchoes();
  stopping_ = true;
  if (running_ && gone_ == 0) {
    // It would keep running without a host.
    std::vector<uint8_t> reset = gs_usb::Bytes({gs_usb::kModeReset, 0});
    Control(LIBUSB_ENDPOINT_OUT, gs_usb::Request::kMode,
            static_cast<uint16_t>(options_.channel), reset);
  }
  for (const auto& transfer : receives_) {
    if (transfer->in_flight) libusb_cancel_transfer(transfer->usb);
  }
  for (Transfer& transfer : sends_) {
    if (transfer.in_flight) libusb_cancel_transfer(transfer.usb);
  }
  const int64_t end_ns = clock_->NowNs() + kCloseWaitNs;
  while (AnyInFlight() && clock_->NowNs() < end_ns) HandleEvents(10'000'000);
  if (claimed_) libusb_release_interface(handle_, kInterface);
  if (had_driver_ && gone_ == 0) {
    libusb_attach_kernel_driver(handle_, kInterface);
  }
  // Takes transfers that did not come back from libusb.
  if (handle_ != nullptr) libusb_close(handle_);
  for (const auto& transfer : receives_) libusb_free_transfer(transfer->usb);
  for (const Transfer& transfer : sends_) libusb_free_transfer(transfer.usb);
  if (context_ != nullptr) libusb_exit(context_);
}

// The reset would drop frames that have not been on the wire, such as those
// that stop a skin.
void GsUsb::Device::AwaitEchoes() {
  const int64_t end_ns = clock_->NowNs() + kSendWaitNs;
  while (waiting_echoes_.any() && gone_ == 0 && !bus_off_ &&
         clock_->NowNs() < end_ns) {
    HandleEvents(5'000'000);
  }
}

bool GsUsb::Device::AnyInFlight() const {
  return std::any_of(receives_.begin(), receives_.end(),
                     [](const auto& t) { return t->in_flight; }) ||
         std::any_of(sends_.begin(), sends_.end(),
                     [](const Transfer& t) { return t.in_flight; });
}

void GsUsb::Device::HandleEvents(int64_t timeout_ns) {
  timeval timeout = {
      .tv_sec = static_cast<time_t>(timeout_ns / 1'000'000'000),
      .tv_usec = static_cast<suseconds_t>(timeout_ns % 1'000'000'000 / 1'000)};
  const int error =
      libusb_handle_events_timeout_completed(context_, &timeout, nullptr);
  if (error < 0 && error != LIBUSB_ERROR_INTERRUPTED && gone_ == 0) {
    gone_ = error;
  }
}

void GsUsb::Device::Submit(Transfer& transfer) {
  const int error = libusb_submit_transfer(transfer.usb);
  transfer.in_flight = error == 0;
  if (error != 0 && gone_ == 0) gone_ = error;
}

void GsUsb::Device::OnReceived(libusb_transfer* usb) {
  auto* transfer = static_cast<Transfer*>(usb->user_data);
  Device* device = transfer->device;
  transfer->in_flight = false;
  switch (usb->status) {
    case LIBUSB_TRANSFER_COMPLETED:
      device->failures_ = 0;
      device->Use({usb->buffer, static_cast<size_t>(usb->actual_length)});
      break;
    case LIBUSB_TRANSFER_NO_DEVICE:
      device->gone_ = LIBUSB_ERROR_NO_DEVICE;
      return;
    case LIBUSB_TRANSFER_CANCELLED:
      return;
    default:
      if (++device->failures_ >= kMaxFailures) {
        device->gone_ = LIBUSB_ERROR_IO;
        return;
      }
      ++device->counters_->malformed;
  }
  if (!device->stopping_) device->Submit(*transfer);
}

void GsUsb::Device::OnSent(libusb_transfer* usb) {
  auto* transfer = static_cast<Transfer*>(usb->user_data);
  Device* device = transfer->device;
  transfer->in_flight = false;
  if (usb->status == LIBUSB_TRANSFER_COMPLETED) {
    ++device->counters_->sent;
    return;
  }
  // It will have no echo.
  device->waiting_echoes_.reset(
      static_cast<size_t>(transfer - device->sends_.data()));
  if (usb->status == LIBUSB_TRANSFER_NO_DEVICE) {
    device->gone_ = LIBUSB_ERROR_NO_DEVICE;
  }
}

void GsUsb::Device::Use(std::span<const uint8_t> bytes) {
  if (bytes.empty()) return;
  // Echoes of old firmware have no stamp.
  const bool with_stamp = stamps_ && bytes.size() >= gs_usb::kStampedFrameSize;
  const auto host = gs_usb::ReadHostFrame(bytes, with_stamp);
  if (!host) {
    ++counters_->malformed;
    return;
  }
  if (host->channel != options_.channel) return;
  if (host->echo_id != gs_usb::kNoEcho) {
    if (host->echo_id < kMaxSends) waiting_echoes_.reset(host->echo_id);
    return;
  }
  if ((host->flags & gs_usb::kOverflowFlag) != 0) ++counters_->overruns;
  if ((host->can_id & kCanErrorBit) != 0) {
    ++counters_->error_frames;
    const CanError error =
        ReadCanError(host->can_id, {host->data.data(), size_t{host->size}});
    counters_->overruns += error.overflow;
    if (error.bus_off) {
      ++counters_->bus_offs;
      bus_off_ = true;
    }
    return;
  }
  CanFrame frame = gs_usb::ToCanFrame(*host);
  const int64_t now_ns = clock_->NowNs();
  frame.time_ns =
      with_stamp ? stamp_clock_.HostTimeNs(host->stamp_us, now_ns) : now_ns;
  ++counters_->received;
  if (!frame.remote && PassesAny(filters_, frame)) received_.push_back(frame);
}

absl::Status GsUsb::Device::Gone() const {
  if (gone_ == LIBUSB_ERROR_NO_DEVICE) {
    return IoError(name_, "the adapter was unplugged");
  }
  return UsbError(name_, "transfer", gone_);
}

absl::Status GsUsb::Device::Send(const CanFrame& frame) {
  const int64_t end_ns = clock_->NowNs() + kSendWaitNs;
  while (true) {
    if (gone_ != 0) return Gone();
    for (size_t i = 0; i < kMaxSends; ++i) {
      if (waiting_echoes_[i] || sends_[i].in_flight) continue;
      Transfer& transfer = sends_[i];
      const auto bytes = gs_usb::Bytes(
          gs_usb::ToHostFrame(frame, static_cast<uint32_t>(i)), false);
      transfer.bytes.fill(0);
      std::copy(bytes.begin(), bytes.end(), transfer.bytes.begin());
      transfer.bytes[9] = static_cast<uint8_t>(options_.channel);
      waiting_echoes_.set(i);
      Submit(transfer);
      return gone_ != 0 ? Gone() : absl::OkStatus();
    }
    const int64_t left_ns = end_ns - clock_->NowNs();
    if (left_ns <= 0) {
      return IoError(name_, "send: nobody on the bus takes frames");
    }
    HandleEvents(std::min<int64_t>(left_ns, 5'000'000));
  }
}

absl::StatusOr<bool> GsUsb::Device::Receive(CanFrame& frame,
                                            int64_t timeout_ns) {
  const int64_t end_ns = clock_->NowNs() + timeout_ns;
  while (true) {
    if (!received_.empty()) {
      frame = received_.front();
      received_.pop_front();
      return true;
    }
    if (gone_ != 0) return Gone();
    if (bus_off_) {
      return IoError(name_,
                     "bus-off: the controller gave up after too many errors "
                     "on the wire (bit rate, termination, cable)");
    }
    const int64_t left_ns = end_ns - clock_->NowNs();
    if (left_ns < 0) return false;
    HandleEvents(left_ns);
    if (received_.empty() && clock_->NowNs() >= end_ns && gone_ == 0 &&
        !bus_off_) {
      return false;
    }
  }
}

GsUsb::GsUsb(const GsUsbOptions& options, Clock* clock)
    : options_(options), clock_(clock) {}

GsUsb::~GsUsb() { Close(); }

std::string GsUsb::name() const {
  return options_.serial.empty() ? "gs_usb" : "gs_usb " + options_.serial;
}

absl::Status GsUsb::Open(std::span<const CanFilter> filters) {
  Close();
  device_ =
      std::make_unique<Device>(name(), options_, clock_, &counters_, filters);
  const absl::Status started = device_->Start();
  if (!started.ok()) Close();
  return started;
}

void GsUsb::Close() { device_.reset(); }

absl::Status GsUsb::Send(const CanFrame& frame) {
  if (!device_) return IoError(name(), "is closed");
  return device_->Send(frame);
}

absl::StatusOr<bool> GsUsb::Receive(CanFrame& frame, int64_t timeout_ns) {
  if (!device_) return IoError(name(), "is closed");
  return device_->Receive(frame, timeout_ns);
}

CanCounters GsUsb::counters() const { return counters_; }

}  // namespace tactus::internal::client
