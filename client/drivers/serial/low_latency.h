// File: low_latency.h
//
// LowLatency: asks a serial line for low latency, and says what it got.
//
//   LowLatency latency(file);
//   latency.ToText("/dev/ttyUSB0");  // "low latency is on; ..."
//
// A USB adapter collects bytes before it hands them on: one of FTDI for 16 ms,
// which is more than a period of a skin at 100 Hz. With the kernel's flag
// ASYNC_LOW_LATENCY it waits for 1 ms. Lines without the flag, such as
// pseudo-terminals, stay as they are.
//
// The file must outlive the object, whose destructor puts the flag back. Not
// thread-safe.
#pragma once

#include <linux/serial.h>

#include <functional>
#include <string>

namespace tactus::internal::client {

class LowLatency {
 public:
  // ioctl with TIOCGSERIAL or TIOCSSERIAL; returns 0 or an errno.
  using Control =
      std::function<int(int file, unsigned long request, serial_struct*)>;

  enum class Answer {
    kOn,
    // Taken without an error, but off.
    kIgnored,
    // The line has no such flag.
    kAbsent,
    // The kernel refused.
    kRefused,
  };

  explicit LowLatency(int file);
  LowLatency(int file, Control control);
  ~LowLatency();

  LowLatency(const LowLatency&) = delete;
  LowLatency& operator=(const LowLatency&) = delete;

  Answer answer() const { return answer_; }
  // For people. With the timer of the adapter behind `path`, if it has one;
  // `devices` is where the kernel lists lines.
  std::string ToText(const std::string& path,
                     const std::string& devices = "/sys/class/tty") const;

 private:
  void Ask();

  const int file_;
  const Control control_;
  Answer answer_ = Answer::kAbsent;
  int error_ = 0;
  // The flag was off before.
  bool changed_ = false;
};

}  // namespace tactus::internal::client
