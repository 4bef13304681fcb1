#include "tools/fakeskin/gs_usb_gadget.h"

#include <algorithm>

#include "core/base/status_macros.h"

namespace tactus::internal::client {

GsUsbGadget::GsUsbGadget(const FunctionFsOptions& options, Clock* clock)
    : name_(options.directory),
      clock_(clock),
      firmware_({}, clock->NowNs()),
      function_(
          options,
          {.write =
               [this](uint8_t request, std::span<const uint8_t> data) {
                 firmware_.Write(request, data);
                 if (!firmware_.started()) function_.CancelSends();
               },
           .read =
               [this](uint8_t request) {
                 return firmware_.Read(request, clock_->NowNs());
               },
           .received =
               [this](std::span<const uint8_t> data) { OnReceived(data); }}) {}

absl::Status GsUsbGadget::Open(std::span<const CanFilter> filters) {
  filters_.assign(filters.begin(), filters.end());
  received_.clear();
  firmware_.Reset();
  return function_.Open();
}

absl::Status GsUsbGadget::Send(const CanFrame& frame) {
  if (!firmware_.started()) return absl::OkStatus();
  if (function_.Send(firmware_.FromBus(frame))) {
    ++counters_.sent;
  } else {
    ++counters_.overruns;
  }
  return absl::OkStatus();
}

void GsUsbGadget::OnReceived(std::span<const uint8_t> bytes) {
  if (!firmware_.started()) {
    ++while_stopped_;
    return;
  }
  const auto sent = firmware_.TakeSent(bytes, clock_->NowNs());
  if (!sent) {
    ++counters_.malformed;
    return;
  }
  if (!function_.Send(sent->echo)) ++counters_.overruns;
  ++counters_.received;
  if (PassesAny(filters_, sent->frame)) received_.push_back(sent->frame);
}

absl::StatusOr<bool> GsUsbGadget::Receive(CanFrame& frame, int64_t timeout_ns) {
  const int64_t end_ns = clock_->NowNs() + timeout_ns;
  int64_t left_ns = timeout_ns;
  while (received_.empty()) {
    if (left_ns < 0) return false;
    TACTUS_RETURN_IF_ERROR(function_.Wait(left_ns));
    if (received_.empty() && clock_->NowNs() >= end_ns) return false;
    left_ns = end_ns - clock_->NowNs();
  }
  frame = received_.front();
  received_.pop_front();
  return true;
}

}  // namespace tactus::internal::client
