#include "tools/fakeskin/function_fs.h"

#include <endian.h>
#include <fcntl.h>
#include <linux/usb/functionfs.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::internal::client {
namespace {

constexpr uint16_t kPacketBytes = 32;
constexpr size_t kQueuedReceives = 4;

// The interface and its endpoints, for full speed only.
struct FunctionDescriptors {
  usb_functionfs_descs_head_v2 head;
  __le32 count;
  usb_interface_descriptor interface;
  usb_endpoint_descriptor_no_audio to_host;
  usb_endpoint_descriptor_no_audio from_host;
} __attribute__((packed));

FunctionDescriptors MakeDescriptors() {
  FunctionDescriptors all = {};
  all.head.magic = htole32(FUNCTIONFS_DESCRIPTORS_MAGIC_V2);
  all.head.length = htole32(sizeof(all));
  all.head.flags = htole32(FUNCTIONFS_HAS_FS_DESC);
  all.count = htole32(3);
  all.interface.bLength = sizeof(all.interface);
  all.interface.bDescriptorType = USB_DT_INTERFACE;
  all.interface.bNumEndpoints = 2;
  all.interface.bInterfaceClass = USB_CLASS_VENDOR_SPEC;
  all.interface.bInterfaceSubClass = 0xFF;
  all.interface.bInterfaceProtocol = 0xFF;
  for (auto* endpoint : {&all.to_host, &all.from_host}) {
    endpoint->bLength = sizeof(*endpoint);
    endpoint->bDescriptorType = USB_DT_ENDPOINT;
    endpoint->bmAttributes = USB_ENDPOINT_XFER_BULK;
    endpoint->wMaxPacketSize = htole16(kPacketBytes);
  }
  all.to_host.bEndpointAddress = USB_DIR_IN | 1;
  all.from_host.bEndpointAddress = USB_DIR_OUT | 2;
  return all;
}

}  // namespace

FunctionFs::FunctionFs(FunctionFsOptions options, Callbacks callbacks)
    : options_(std::move(options)), callbacks_(std::move(callbacks)) {
  for (size_t i = 0; i < kQueuedSends; ++i) {
    sends_.push_back(std::make_unique<Transfer>());
  }
  for (size_t i = 0; i < kQueuedReceives; ++i) {
    receives_.push_back(std::make_unique<Transfer>());
  }
}

FunctionFs::~FunctionFs() { Close(); }

absl::Status FunctionFs::Failed(const std::string& what) const {
  return IoError(options_.directory,
                 absl::StrCat(what, ": ", std::strerror(errno)));
}

absl::Status FunctionFs::Open() {
  Close();
  absl::Status status = OpenFiles();
  if (status.ok()) status = Bind();
  if (!status.ok()) Close();
  return status;
}

absl::Status FunctionFs::OpenFiles() {
  constexpr int kFlags = O_RDWR | O_NONBLOCK | O_CLOEXEC;
  control_ = ::open((options_.directory + "/ep0").c_str(), kFlags);
  if (control_ < 0) return Failed("open ep0 (is FunctionFS mounted there?)");
  TACTUS_RETURN_IF_ERROR(WriteDescriptors());
  to_host_ = ::open((options_.directory + "/ep1").c_str(), kFlags);
  if (to_host_ < 0) return Failed("open ep1");
  from_host_ = ::open((options_.directory + "/ep2").c_str(), kFlags);
  if (from_host_ < 0) return Failed("open ep2");
  done_ = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  if (done_ < 0) return Failed("eventfd");
  if (syscall(SYS_io_setup, kQueuedSends + kQueuedReceives, &context_) < 0) {
    return Failed("io_setup");
  }
  return absl::OkStatus();
}

absl::Status FunctionFs::WriteDescriptors() {
  const FunctionDescriptors descriptors = MakeDescriptors();
  if (::write(control_, &descriptors, sizeof(descriptors)) < 0) {
    return Failed("descriptors");
  }
  // The interface has no strings.
  const usb_functionfs_strings_head strings = {
      .magic = htole32(FUNCTIONFS_STRINGS_MAGIC),
      .length = htole32(sizeof(strings)),
      .str_count = 0,
      .lang_count = 0};
  if (::write(control_, &strings, sizeof(strings)) < 0) {
    return Failed("strings");
  }
  return absl::OkStatus();
}

absl::Status FunctionFs::Bind() {
  std::error_code error;
  const std::filesystem::directory_iterator controllers(options_.controllers,
                                                        error);
  if (error || controllers == std::filesystem::directory_iterator()) {
    return IoError(options_.controllers,
                   "this machine has no USB device controller (module "
                   "dummy_hcd plays one)");
  }
  const std::string controller = controllers->path().filename().string();
  const int file =
      ::open((options_.gadget + "/UDC").c_str(), O_WRONLY | O_CLOEXEC);
  if (file < 0) return Failed(absl::StrCat("open ", options_.gadget, "/UDC"));
  bound_ = ::write(file, controller.data(), controller.size()) >= 0;
  const absl::Status status =
      bound_ ? absl::OkStatus()
             : Failed(absl::StrCat("bind the gadget to ", controller));
  ::close(file);
  return status;
}

void FunctionFs::Close() {
  if (bound_) {
    const int file =
        ::open((options_.gadget + "/UDC").c_str(), O_WRONLY | O_CLOEXEC);
    // A gadget that has left already refuses; then there is nothing to do.
    if (file >= 0 && ::write(file, "\n", 1) >= 0) bound_ = false;
    if (file >= 0) ::close(file);
  }
  bound_ = false;
  enabled_ = false;
  // Waits for the transfers, which ended when the gadget left.
  if (context_ != 0) syscall(SYS_io_destroy, context_);
  context_ = 0;
  for (auto* transfers : {&sends_, &receives_}) {
    for (const auto& transfer : *transfers) transfer->in_flight = false;
  }
  for (int* file : {&to_host_, &from_host_, &control_, &done_}) {
    if (*file >= 0) ::close(*file);
    *file = -1;
  }
}

bool FunctionFs::IsSend(const Transfer& transfer) const {
  return transfer.block.aio_lio_opcode == IOCB_CMD_PWRITE;
}

bool FunctionFs::Submit(Transfer& transfer, uint16_t operation, size_t size) {
  transfer.block = {};
  transfer.block.aio_data = reinterpret_cast<uintptr_t>(&transfer);
  transfer.block.aio_lio_opcode = operation;
  transfer.block.aio_fildes =
      static_cast<uint32_t>(IsSend(transfer) ? to_host_ : from_host_);
  transfer.block.aio_buf = reinterpret_cast<uintptr_t>(transfer.bytes.data());
  transfer.block.aio_nbytes = size;
  transfer.block.aio_flags = IOCB_FLAG_RESFD;
  transfer.block.aio_resfd = static_cast<uint32_t>(done_);
  iocb* list[] = {&transfer.block};
  transfer.in_flight = syscall(SYS_io_submit, context_, 1, list) == 1;
  return transfer.in_flight;
}

void FunctionFs::SubmitReceives() {
  for (const auto& transfer : receives_) {
    if (!transfer->in_flight) {
      Submit(*transfer, IOCB_CMD_PREAD, transfer->bytes.size());
    }
  }
}

bool FunctionFs::Send(std::span<const uint8_t> data) {
  if (!enabled_ || data.size() > kTransferBytes) return false;
  const auto idle =
      std::find_if(sends_.begin(), sends_.end(),
                   [](const auto& transfer) { return !transfer->in_flight; });
  if (idle == sends_.end()) return false;
  std::copy(data.begin(), data.end(), (*idle)->bytes.begin());
  return Submit(**idle, IOCB_CMD_PWRITE, data.size());
}

void FunctionFs::CancelSends() {
  for (const auto& transfer : sends_) {
    if (!transfer->in_flight) continue;
    // Its completion comes like that of any transfer.
    io_event event;
    syscall(SYS_io_cancel, context_, &transfer->block, &event);
  }
}

absl::Status FunctionFs::Wait(int64_t timeout_ns) {
  // Reads that a host's reset ended, too: the kernel may report their end
  // after it has reported that the host configured the device anew.
  if (enabled_) SubmitReceives();
  pollfd files[] = {{.fd = control_, .events = POLLIN, .revents = 0},
                    {.fd = done_, .events = POLLIN, .revents = 0}};
  const timespec timeout = {
      .tv_sec = static_cast<time_t>(timeout_ns / 1'000'000'000),
      .tv_nsec = static_cast<long>(timeout_ns % 1'000'000'000)};
  if (ppoll(files, 2, &timeout, nullptr) < 0 && errno != EINTR) {
    return Failed("poll");
  }
  if (files[1].revents != 0) TakeCompletions();
  return files[0].revents != 0 ? TakeEvents() : absl::OkStatus();
}

void FunctionFs::TakeCompletions() {
  uint64_t count = 0;
  // The number is known from the events.
  if (::read(done_, &count, sizeof(count)) < 0) return;
  while (true) {
    std::array<io_event, 16> events;
    timespec none = {};
    const long taken = syscall(SYS_io_getevents, context_, 0, events.size(),
                               events.data(), &none);
    for (long i = 0; i < taken; ++i) {
      Transfer& transfer = *reinterpret_cast<Transfer*>(events[i].data);
      transfer.in_flight = false;
      if (IsSend(transfer) || events[i].res < 0) continue;
      callbacks_.received(
          {transfer.bytes.data(), static_cast<size_t>(events[i].res)});
    }
    if (taken < static_cast<long>(events.size())) return;
  }
}

absl::Status FunctionFs::TakeEvents() {
  usb_functionfs_event event;
  while (true) {
    const ssize_t size = ::read(control_, &event, sizeof(event));
    if (size < 0 && (errno == EAGAIN || errno == EINTR)) break;
    // The host has given up a request.
    if (size < 0 && errno == EIDRM) continue;
    if (size < 0) return Failed("events");
    switch (event.type) {
      case FUNCTIONFS_ENABLE:
        enabled_ = true;
        break;
      case FUNCTIONFS_DISABLE:
      case FUNCTIONFS_UNBIND:
        enabled_ = false;
        break;
      case FUNCTIONFS_SETUP:
        Answer(event.u.setup.bRequestType, event.u.setup.bRequest,
               le16toh(event.u.setup.wLength));
        break;
      default:
        break;
    }
  }
  return absl::OkStatus();
}

void FunctionFs::Answer(uint8_t type, uint8_t request, uint16_t length) {
  const bool is_vendor = (type & USB_TYPE_MASK) == USB_TYPE_VENDOR;
  std::vector<uint8_t> bytes(length);
  // A failure of these calls means that the host has given the request up.
  ssize_t done = 0;
  if ((type & USB_DIR_IN) != 0) {
    const auto answer = is_vendor ? callbacks_.read(request) : std::nullopt;
    if (answer) {
      done = ::write(control_, answer->data(),
                     std::min<size_t>(answer->size(), length));
    } else {
      // Reading instead of writing stalls the endpoint.
      done = ::read(control_, bytes.data(), 0);
    }
  } else if (is_vendor) {
    done = ::read(control_, bytes.data(), bytes.size());
    if (done >= 0) {
      callbacks_.write(request, {bytes.data(), static_cast<size_t>(done)});
    }
  } else {
    done = ::write(control_, bytes.data(), 0);
  }
}

}  // namespace tactus::internal::client
