#include "tests/client/drivers/can/mock_adapter.h"

#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstring>

#include "absl/strings/str_format.h"

namespace tactus::internal::client {
namespace {

constexpr char kNode[] = "/dev/bus/usb/001/007";

}  // namespace

MockAdapter::MockAdapter(CanPeer* peer, const Options& options)
    : peer_(peer),
      options_(options),
      testbed_(umockdev_testbed_new()),
      handler_(umockdev_ioctl_base_new()),
      firmware_({.features = options.features,
                 .clock_hz = options.clock_hz,
                 .first_stamp_us = options.first_stamp_us,
                 .old_echoes = true},
                NowNs()),
      attached_(options.kernel_driver) {
  g_signal_connect(handler_, "handle-ioctl", G_CALLBACK(&MockAdapter::OnIoctl),
                   this);
  umockdev_testbed_attach_ioctl(testbed_, kNode, handler_, nullptr);
  AddMockAdapter(testbed_);
}

MockAdapter::~MockAdapter() {
  umockdev_testbed_detach_ioctl(testbed_, kNode, nullptr);
  g_object_unref(handler_);
  g_object_unref(testbed_);
  for (const auto* list : {&waiting_, &done_}) {
    for (const Urb& urb : *list) {
      umockdev_ioctl_data_unref(urb.buffer);
      umockdev_ioctl_data_unref(urb.data);
    }
  }
}

void AddMockAdapter(UMockdevTestbed* testbed) {
  // Device 1d50:606f, one interface FF/FF/FF, bulk 0x81 and 0x02 of 32 bytes.
  umockdev_testbed_add_from_string(testbed,
                                   "P: /devices/usb1/1-1\n"
                                   "N: bus/usb/001/007\n"
                                   "E: SUBSYSTEM=usb\n"
                                   "E: DRIVER=usb\n"
                                   "E: BUSNUM=001\n"
                                   "E: DEVNUM=007\n"
                                   "E: DEVNAME=/dev/bus/usb/001/007\n"
                                   "E: DEVTYPE=usb_device\n"
                                   "A: bConfigurationValue=1\\n\n"
                                   "A: busnum=1\\n\n"
                                   "A: devnum=7\\n\n"
                                   "A: speed=12\\n\n"
                                   "H: descriptors="
                                   "1201000200000040501d6f600000010203"
                                   "01"
                                   "090220000101008032"
                                   "0904000002ffffff00"
                                   "07058102200000"
                                   "07050202200000\n",
                                   nullptr);
}

void MockAdapter::Unplug() {
  {
    const std::lock_guard lock(mutex_);
    plugged_ = false;
    firmware_.Reset();
    claimed_ = false;
    to_bus_.clear();
    to_host_.clear();
    while (!waiting_.empty()) {
      Finish(waiting_.front(), -ESHUTDOWN, {});
      waiting_.pop_front();
    }
  }
  umockdev_testbed_remove_device(testbed_, kMockAdapterSysPath);
}

void MockAdapter::Plug() {
  {
    const std::lock_guard lock(mutex_);
    plugged_ = true;
  }
  AddMockAdapter(testbed_);
}

void MockAdapter::SendRaw(std::vector<uint8_t> bytes) {
  const std::lock_guard lock(mutex_);
  to_host_.push_back(std::move(bytes));
}

void MockAdapter::FailTransfers(int count, int error) {
  const std::lock_guard lock(mutex_);
  failures_ = count;
  failure_ = error;
}

void MockAdapter::SetDeaf(bool deaf) {
  const std::lock_guard lock(mutex_);
  deaf_ = deaf;
}

bool MockAdapter::started() {
  const std::lock_guard lock(mutex_);
  return firmware_.started();
}

uint32_t MockAdapter::mode_flags() {
  const std::lock_guard lock(mutex_);
  return firmware_.mode_flags();
}

std::vector<uint8_t> MockAdapter::bit_timing() {
  const std::lock_guard lock(mutex_);
  return firmware_.bit_timing();
}

bool MockAdapter::kernel_driver_attached() {
  const std::lock_guard lock(mutex_);
  return attached_;
}

bool MockAdapter::claimed() {
  const std::lock_guard lock(mutex_);
  return claimed_;
}

size_t MockAdapter::last_sent_size() {
  const std::lock_guard lock(mutex_);
  return last_sent_size_;
}

size_t MockAdapter::most_waiting() {
  const std::lock_guard lock(mutex_);
  return most_waiting_;
}

int64_t MockAdapter::NowNs() const {
  return std::chrono::nanoseconds(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

gboolean MockAdapter::OnIoctl(UMockdevIoctlBase* /*handler*/,
                              UMockdevIoctlClient* client, MockAdapter* self) {
  const std::lock_guard lock(self->mutex_);
  return self->Handle(client) ? TRUE : FALSE;
}

bool MockAdapter::Handle(UMockdevIoctlClient* client) {
  const unsigned long request = umockdev_ioctl_client_get_request(client);
  UMockdevIoctlData* argument = umockdev_ioctl_client_get_arg(client);
  // What is left of a device that is gone.
  if (!plugged_ && request != USBDEVFS_REAPURBNDELAY &&
      request != USBDEVFS_REAPURB) {
    umockdev_ioctl_client_complete(client, -1, ENODEV);
    return true;
  }
  bool known = true;
  switch (request) {
    case USBDEVFS_GET_CAPABILITIES: {
      UMockdevIoctlData* data =
          umockdev_ioctl_data_resolve(argument, 0, sizeof(uint32_t), nullptr);
      const uint32_t capabilities =
          USBDEVFS_CAP_BULK_CONTINUATION | USBDEVFS_CAP_NO_PACKET_SIZE_LIM |
          USBDEVFS_CAP_REAP_AFTER_DISCONNECT | USBDEVFS_CAP_ZERO_PACKET;
      std::memcpy(data->data, &capabilities, sizeof(capabilities));
      umockdev_ioctl_client_complete(client, 0, 0);
      umockdev_ioctl_data_unref(data);
      break;
    }
    case USBDEVFS_GETDRIVER: {
      if (!attached_) {
        umockdev_ioctl_client_complete(client, -1, ENODATA);
        break;
      }
      UMockdevIoctlData* data = umockdev_ioctl_data_resolve(
          argument, 0, sizeof(usbdevfs_getdriver), nullptr);
      std::strcpy(reinterpret_cast<usbdevfs_getdriver*>(data->data)->driver,
                  "gs_usb");
      umockdev_ioctl_client_complete(client, 0, 0);
      umockdev_ioctl_data_unref(data);
      break;
    }
    case USBDEVFS_IOCTL: {
      UMockdevIoctlData* data = umockdev_ioctl_data_resolve(
          argument, 0, sizeof(usbdevfs_ioctl), nullptr);
      attached_ = reinterpret_cast<usbdevfs_ioctl*>(data->data)->ioctl_code ==
                  static_cast<int>(USBDEVFS_CONNECT);
      umockdev_ioctl_client_complete(client, attached_ ? 1 : 0, 0);
      umockdev_ioctl_data_unref(data);
      break;
    }
    case USBDEVFS_CLAIMINTERFACE:
      claimed_ = !attached_;
      umockdev_ioctl_client_complete(client, attached_ ? -1 : 0, EBUSY);
      break;
    case USBDEVFS_RELEASEINTERFACE:
      claimed_ = false;
      umockdev_ioctl_client_complete(client, 0, 0);
      break;
    case USBDEVFS_CLEAR_HALT:
      umockdev_ioctl_client_complete(client, 0, 0);
      break;
    case USBDEVFS_SUBMITURB:
      Submit(client, argument);
      break;
    case USBDEVFS_REAPURB:
    case USBDEVFS_REAPURBNDELAY:
      Reap(client, argument);
      break;
    case USBDEVFS_DISCARDURB:
      Discard(client, argument);
      break;
    default:
      known = false;
  }
  return known;
}

void MockAdapter::Submit(UMockdevIoctlClient* client,
                         UMockdevIoctlData* argument) {
  Urb urb;
  urb.data =
      umockdev_ioctl_data_resolve(argument, 0, sizeof(usbdevfs_urb), nullptr);
  urb.client_address = urb.data->client_addr;
  const auto* raw = reinterpret_cast<const usbdevfs_urb*>(urb.data->data);
  urb.buffer = umockdev_ioctl_data_resolve(
      urb.data, offsetof(usbdevfs_urb, buffer),
      static_cast<gsize>(raw->buffer_length), nullptr);
  std::vector<uint8_t> bytes(urb.buffer->data,
                             urb.buffer->data + raw->buffer_length);
  if (raw->type == USBDEVFS_URB_TYPE_CONTROL) {
    const int result = Control(bytes);
    if (result < 0) {
      Finish(urb, result, {});
    } else {
      Finish(urb, 0, bytes);
    }
  } else if ((raw->endpoint & 0x80) == 0) {
    TakeSent(bytes);
    Finish(urb, 0, bytes);
  } else {
    waiting_.push_back(urb);
    most_waiting_ = std::max(most_waiting_, waiting_.size());
  }
  umockdev_ioctl_client_complete(client, 0, 0);
}

int MockAdapter::Control(std::vector<uint8_t>& buffer) {
  const uint8_t type = buffer[0];
  const uint8_t request = buffer[1];
  const unsigned length = buffer[6] | buffer[7] << 8;
  if (type == 0x41) {
    const bool done = firmware_.Write(request, std::span(buffer).subspan(8));
    if (!firmware_.started()) to_bus_.clear();
    return done ? 0 : -EPIPE;
  }
  std::vector<uint8_t> in;
  if (type == 0x80 && request == 6 && buffer[3] == 3) {
    // String descriptors: languages, then the serial number.
    in = {0, 3};
    if (buffer[2] == 0) {
      in.insert(in.end(), {0x09, 0x04});
    } else {
      for (const char c : options_.serial) {
        in.insert(in.end(), {static_cast<uint8_t>(c), 0});
      }
    }
    in[0] = static_cast<uint8_t>(in.size());
  } else if (const auto answer = firmware_.Read(request, NowNs());
             type == 0xC1 && answer) {
    in = *answer;
  } else {
    return -EPIPE;
  }
  in.resize(std::min<size_t>(in.size(), length));
  buffer.resize(8);
  buffer.insert(buffer.end(), in.begin(), in.end());
  return 0;
}

void MockAdapter::TakeSent(const std::vector<uint8_t>& bytes) {
  last_sent_size_ = bytes.size();
  to_bus_.push_back(bytes);
}

void MockAdapter::Pump() {
  const int64_t now_ns = NowNs();
  for (; !to_bus_.empty(); to_bus_.pop_front()) {
    const auto sent = firmware_.TakeSent(to_bus_.front(), now_ns);
    if (!sent || deaf_) continue;
    peer_->OnFrame(sent->frame, now_ns);
    to_host_.push_back(sent->echo);
  }
  CanFrame frame;
  while (firmware_.started() && to_host_.size() < waiting_.size() &&
         peer_->Emit(NowNs(), frame)) {
    to_host_.push_back(firmware_.FromBus(frame));
  }
  while (!waiting_.empty() && failures_ > 0) {
    --failures_;
    Finish(waiting_.front(), -failure_, {});
    waiting_.pop_front();
  }
  while (!waiting_.empty() && !to_host_.empty()) {
    Finish(waiting_.front(), 0, to_host_.front());
    waiting_.pop_front();
    to_host_.pop_front();
  }
}

void MockAdapter::Finish(const Urb& urb, int status,
                         const std::vector<uint8_t>& bytes) {
  auto* raw = reinterpret_cast<usbdevfs_urb*>(urb.data->data);
  const auto size = std::min<size_t>(bytes.size(), raw->buffer_length);
  raw->status = status;
  raw->actual_length = static_cast<int>(size);
  if (raw->type == USBDEVFS_URB_TYPE_CONTROL) {
    raw->actual_length = std::max(0, raw->actual_length - 8);
  }
  std::copy_n(bytes.begin(), size, urb.buffer->data);
  done_.push_back(urb);
}

void MockAdapter::Reap(UMockdevIoctlClient* client,
                       UMockdevIoctlData* argument) {
  Pump();
  if (done_.empty()) {
    umockdev_ioctl_client_complete(client, -1, plugged_ ? EAGAIN : ENODEV);
    return;
  }
  const Urb urb = done_.front();
  done_.pop_front();
  UMockdevIoctlData* pointer =
      umockdev_ioctl_data_resolve(argument, 0, sizeof(void*), nullptr);
  umockdev_ioctl_data_set_ptr(pointer, 0, urb.data);
  umockdev_ioctl_client_complete(client, 0, 0);
  umockdev_ioctl_data_unref(pointer);
  umockdev_ioctl_data_unref(urb.buffer);
  umockdev_ioctl_data_unref(urb.data);
}

void MockAdapter::Discard(UMockdevIoctlClient* client,
                          UMockdevIoctlData* argument) {
  unsigned long address = 0;
  std::memcpy(&address, argument->data, sizeof(address));
  const auto found = std::find_if(
      waiting_.begin(), waiting_.end(),
      [&](const Urb& urb) { return urb.client_address == address; });
  if (found == waiting_.end()) {
    umockdev_ioctl_client_complete(client, -1, EINVAL);
    return;
  }
  Finish(*found, -ENOENT, {});
  waiting_.erase(found);
  umockdev_ioctl_client_complete(client, 0, 0);
}

}  // namespace tactus::internal::client
