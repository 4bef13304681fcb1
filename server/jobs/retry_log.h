// File: retry_log.h
//
// RetryLog: which of many failed attempts in a row are worth a line of the log.
// A disk may be full for a night.
//
//   RetryLog log;
//   while (!Store().ok()) {
//     if (log.Fails()) spdlog::error("failed {} times", log.failures());
//   }
//   log.Succeeds();
//
// Not thread-safe.
#pragma once

#include <bit>
#include <cstdint>

namespace tactus::internal::server {

class RetryLog {
 public:
  // True for the 1st, 2nd, 4th, 8th, ... failure in a row.
  bool Fails() { return std::has_single_bit(++failures_); }
  void Succeeds() { failures_ = 0; }
  uint64_t failures() const { return failures_; }

 private:
  uint64_t failures_ = 0;
};

}  // namespace tactus::internal::server
