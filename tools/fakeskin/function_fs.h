// File: function_fs.h
//
// FunctionFs: a USB interface that this process plays for a USB host, through
// the kernel's FunctionFS: vendor requests, one bulk endpoint to the host and
// one from it, at full speed. The host may be another machine, or this one
// (module dummy_hcd).
//
//   FunctionFs function({.directory = "/dev/skin", .gadget = gadget},
//                       {.write = ..., .read = ..., .received = ...});
//   TACTUS_RETURN_IF_ERROR(function.Open());
//   while (go_on) {
//     function.Send(bytes);
//     TACTUS_RETURN_IF_ERROR(function.Wait(/*timeout_ns=*/1'000'000));
//   }
//
// The gadget is made before, in configfs (tests/vm/make-gadget.sh). Open gives
// it the interface and lets the host see it. Errors have the reason IO. Not
// thread-safe; the callbacks run in Wait.
#pragma once

#include <linux/aio_abi.h>

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "absl/status/status.h"

namespace tactus::internal::client {

struct FunctionFsOptions {
  // Where FunctionFS is mounted.
  std::string directory;
  // The gadget's directory in configfs.
  std::string gadget;
  // Where the kernel lists its USB device controllers.
  std::string controllers = "/sys/class/udc";
};

class FunctionFs {
 public:
  // The largest transfer, in bytes.
  static constexpr size_t kTransferBytes = 64;
  // Transfers to the host that may wait at once.
  static constexpr size_t kQueuedSends = 64;

  struct Callbacks {
    // A vendor request of the host with data.
    std::function<void(uint8_t request, std::span<const uint8_t> data)> write;
    // A vendor request for data; nothing: the endpoint stalls.
    std::function<std::optional<std::vector<uint8_t>>(uint8_t request)> read;
    // A bulk transfer of the host.
    std::function<void(std::span<const uint8_t> data)> received;
  };

  FunctionFs(FunctionFsOptions options, Callbacks callbacks);
  ~FunctionFs();

  FunctionFs(const FunctionFs&) = delete;
  FunctionFs& operator=(const FunctionFs&) = delete;

  absl::Status Open();
  // The host sees the device leave.
  void Close();

  // Queues a bulk transfer to the host. False if the host has not configured
  // the device, or kQueuedSends transfers wait already.
  bool Send(std::span<const uint8_t> data);
  // Takes back the transfers that wait for the host.
  void CancelSends();
  // Handles what the host does, until something came or the time is over.
  absl::Status Wait(int64_t timeout_ns);

 private:
  struct Transfer {
    iocb block = {};
    std::array<uint8_t, kTransferBytes> bytes = {};
    bool in_flight = false;
  };

  absl::Status OpenFiles();
  absl::Status WriteDescriptors();
  absl::Status Bind();
  absl::Status TakeEvents();
  void Answer(uint8_t type, uint8_t request, uint16_t length);
  void TakeCompletions();
  bool Submit(Transfer& transfer, uint16_t operation, size_t size);
  // Begins all reads that are not in flight.
  void SubmitReceives();
  bool IsSend(const Transfer& transfer) const;
  absl::Status Failed(const std::string& what) const;

  const FunctionFsOptions options_;
  const Callbacks callbacks_;
  int control_ = -1;
  int to_host_ = -1;
  int from_host_ = -1;
  // Counts transfers that are done.
  int done_ = -1;
  aio_context_t context_ = 0;
  bool bound_ = false;
  // The host has configured the device.
  bool enabled_ = false;
  std::vector<std::unique_ptr<Transfer>> sends_;
  std::vector<std::unique_ptr<Transfer>> receives_;
};

}  // namespace tactus::internal::client
