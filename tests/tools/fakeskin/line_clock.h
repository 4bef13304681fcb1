// File: line_clock.h
//
// A simulated AnySkin board on a pseudo-terminal, on a clock that moves on to
// its next frame when the driver has read all that came. Runs are repeatable
// and do not depend on the time that they take. Test-only.
//
//   LineClock clock(&board, &line);
//   AnySkin skin(line.path(), {}, &clock);
//   HardwareDriver driver(&skin, {}, &clock);
//
// Not thread-safe.
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <string>

#include "client/drivers/clock.h"
#include "gtest/gtest.h"
#include "tools/fakeskin/anyskin_board.h"
#include "tools/fakeskin/pty_line.h"

namespace tactus::internal::client::testing {

inline constexpr int64_t kSecond = 1'000'000'000;

class LineClock : public Clock {
 public:
  // Opens the line.
  LineClock(AnySkinBoard* board, PtyLine* line) : board_(board), line_(line) {
    Plug();
  }
  ~LineClock() override { Unplug(); }

  void Plug() {
    const absl::Status status = line_->Open();
    ASSERT_TRUE(status.ok()) << status;
    // Looks whether something waits there.
    host_ = open(line_->path().c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    ASSERT_GE(host_, 0);
  }
  void Unplug() {
    line_->Close();
    if (host_ >= 0) close(host_);
    host_ = -1;
  }

  int64_t NowNs() override {
    if (!Waits(0)) Advance(board_->NextNs());
    return now_ns_;
  }
  void SleepNs(int64_t duration_ns) override {
    const int64_t end_ns = now_ns_ + duration_ns;
    while (board_->NextNs() <= end_ns) Advance(board_->NextNs());
    now_ns_ = std::max(now_ns_, end_ns);
  }

 private:
  bool Waits(int timeout_ms) const {
    pollfd poll = {.fd = host_, .events = POLLIN, .revents = 0};
    return ::poll(&poll, 1, timeout_ms) > 0;
  }

  void Advance(int64_t time_ns) {
    now_ns_ = std::max(now_ns_, time_ns);
    while (board_->Emit(now_ns_, bytes_)) {
      if (host_ < 0) continue;
      line_->Write(bytes_);
      // The kernel hands it on a moment later.
      EXPECT_TRUE(Waits(10'000));
    }
  }

  AnySkinBoard* const board_;
  PtyLine* const line_;
  int host_ = -1;
  int64_t now_ns_ = 0;
  std::string bytes_;
};

}  // namespace tactus::internal::client::testing
