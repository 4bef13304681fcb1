// File: talking_skin.h
//
// A skin at the other end of a serial line: a pseudo-terminal on which a thread
// sends frames. Test-only.
//
//   Pty pty;
//   const TalkingSkin talking(pty, {AsciiFrame({1, 2, 3, 4}, 2)});
//   SerialSkin skin(pty.path(), ...);
//
// Pty is not thread-safe, but for Write.
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gtest/gtest.h"

namespace tactus::internal::client::testing {

using Values = std::vector<uint16_t>;

inline std::string AsciiFrame(const Values& values, int columns) {
  std::string text;
  for (size_t i = 0; i < values.size(); ++i) {
    const bool last = (i + 1) % static_cast<size_t>(columns) == 0;
    absl::StrAppend(&text, values[i], last ? "\r\n" : " ");
  }
  return text + "\r\n";
}

inline std::string BinaryFrame(const Values& values) {
  std::string bytes = "\xAA\x55";
  for (const uint16_t value : values) bytes.push_back(static_cast<char>(value));
  return bytes;
}

inline std::span<const uint8_t> AsBytes(const std::string& text) {
  return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

// Two ends of a serial line, which is as terminals are until SerialPort has set
// it up: it would change some bytes and act on others.
class Pty {
 public:
  Pty() : master_(posix_openpt(O_RDWR | O_NOCTTY)) {
    EXPECT_GE(master_, 0);
    grantpt(master_);
    unlockpt(master_);
    char name[128];
    ptsname_r(master_, name, sizeof(name));
    path_ = name;
  }
  ~Pty() { Close(); }
  const std::string& path() const { return path_; }
  void Write(const std::string& bytes) const {
    size_t done = 0;
    while (done < bytes.size()) {
      const ssize_t count =
          ::write(master_, bytes.data() + done, bytes.size() - done);
      if (count <= 0) return;
      done += static_cast<size_t>(count);
    }
  }
  // A program at the other end wrote something, or the line echoes.
  bool WasWrittenTo() const {
    pollfd poll = {.fd = master_, .events = POLLIN, .revents = 0};
    return ::poll(&poll, 1, 0) > 0 && (poll.revents & POLLIN) != 0;
  }
  // Pulls the device out.
  void Close() {
    if (master_ >= 0) ::close(master_);
    master_ = -1;
  }

 private:
  int master_;
  std::string path_;
};

// A skin on a thread, that sends the same frames again and again.
class TalkingSkin {
 public:
  TalkingSkin(const Pty& pty, std::vector<std::string> frames)
      : thread_([this, &pty, frames = std::move(frames)] {
          for (size_t i = 0; !stop_; ++i) {
            pty.Write(frames[i % frames.size()]);
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
          }
        }) {}
  ~TalkingSkin() {
    stop_ = true;
    thread_.join();
  }

 private:
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

}  // namespace tactus::internal::client::testing
