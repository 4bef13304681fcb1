// What a serial line makes of the wish for low latency; the kernel is played.
#include "client/drivers/serial/low_latency.h"

#include <sys/ioctl.h>

#include <cerrno>
#include <filesystem>
#include <fstream>

#include "gtest/gtest.h"
#include "tests/client/drivers/serial/talking_skin.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal::client {
namespace {

using Answer = LowLatency::Answer;

// A line with `flags`; errors of asking and of setting.
struct Line {
  int flags = 0;
  int get_error = 0;
  int set_error = 0;
  bool keeps = true;
  int sets = 0;

  LowLatency::Control Control() {
    return [this](int, unsigned long request, serial_struct* line) {
      if (request == TIOCGSERIAL) {
        if (get_error == 0) line->flags = flags;
        return get_error;
      }
      ++sets;
      if (set_error == 0 && keeps) flags = line->flags;
      return set_error;
    };
  }
};

TEST(LowLatencyTest, IsSetAndPutBack) {
  Line line{.flags = ASYNC_SPD_HI};
  {
    const LowLatency latency(3, line.Control());
    EXPECT_EQ(latency.answer(), Answer::kOn);
    EXPECT_EQ(line.flags, ASYNC_SPD_HI | ASYNC_LOW_LATENCY);
    EXPECT_EQ(latency.ToText("/dev/x"), "low latency is on");
  }
  EXPECT_EQ(line.flags, ASYNC_SPD_HI);
}

TEST(LowLatencyTest, WasSetBeforeAndStays) {
  Line line{.flags = ASYNC_LOW_LATENCY};
  { EXPECT_EQ(LowLatency(3, line.Control()).answer(), Answer::kOn); }
  EXPECT_EQ(line.sets, 0);
  EXPECT_EQ(line.flags, ASYNC_LOW_LATENCY);
}

TEST(LowLatencyTest, SaysWhatItDidNotGet) {
  Line ignores{.keeps = false};
  const LowLatency ignored(3, ignores.Control());
  EXPECT_EQ(ignored.answer(), Answer::kIgnored);
  EXPECT_EQ(ignored.ToText("/dev/x"),
            "low latency was asked for, and the line ignores it");
  Line forbids{.set_error = EPERM};
  const LowLatency refused(3, forbids.Control());
  EXPECT_EQ(refused.answer(), Answer::kRefused);
  EXPECT_EQ(refused.ToText("/dev/x"),
            "low latency was refused: Operation not permitted");
  Line lacks{.get_error = ENOTTY};
  EXPECT_EQ(LowLatency(3, lacks.Control()).answer(), Answer::kAbsent);
  Line lacks_set{.set_error = EINVAL};
  EXPECT_EQ(LowLatency(3, lacks_set.Control()).answer(), Answer::kAbsent);
}

TEST(LowLatencyTest, NamesTheTimerOfTheAdapter) {
  const ScratchDir dir;
  const std::string port = dir / "ttyUSB0";
  std::ofstream(port) << "x";
  std::filesystem::create_directories(dir / "tty/ttyUSB0/device");
  std::ofstream(dir / "tty/ttyUSB0/device/latency_timer") << "1\n";
  Line line;
  const LowLatency latency(3, line.Control());
  EXPECT_EQ(latency.ToText(port, dir / "tty"),
            "low latency is on; the adapter's timer is 1 ms");
}

TEST(LowLatencyTest, APseudoTerminalHasNone) {
  const testing::Pty pty;
  const int file = ::open(pty.path().c_str(), O_RDWR | O_NOCTTY);
  ASSERT_GE(file, 0);
  EXPECT_EQ(LowLatency(file).answer(), Answer::kAbsent);
  ::close(file);
}

}  // namespace
}  // namespace tactus::internal::client
