// File: serial_port.h
//
// SerialPort: a serial line of the kernel, raw, without flow control, with low
// latency if the device has it (low_latency.h).
//
//   SerialPort port("/dev/ttyUSB0", /*baud=*/2'000'000);
//   TACTUS_RETURN_IF_ERROR(port.Open());
//   uint8_t bytes[4096];
//   TACTUS_ASSIGN_OR_RETURN(const size_t count,
//                           port.Read(bytes, /*timeout_ns=*/100'000'000));
//
// Not thread-safe.
#pragma once

#include <termios.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/drivers/serial/low_latency.h"

namespace tactus::internal::client {

class SerialPort {
 public:
  SerialPort(std::string path, int baud);
  ~SerialPort();

  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;

  const std::string& path() const { return path_; }
  // INVALID_CONFIG for a rate that the kernel has no name for; IO if the line
  // cannot be opened or is no terminal. What came before is dropped.
  absl::Status Open();
  // Puts the line's settings back.
  void Close();
  // What came of the wish for low latency, for people; empty while closed.
  const std::string& latency() const { return latency_; }
  // Number of bytes read; 0 if none came in time. IO if the device is gone.
  absl::StatusOr<size_t> Read(std::span<uint8_t> bytes, int64_t timeout_ns);

 private:
  const std::string path_;
  const int baud_;
  int file_ = -1;
  // The settings before Open.
  std::optional<termios> before_;
  std::optional<LowLatency> low_latency_;
  std::string latency_;
};

}  // namespace tactus::internal::client
