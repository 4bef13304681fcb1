// File: pty_program.h
//
// PtyProgram: a program at a pseudo-terminal of 80 x 24, as a user runs it.
// Test-only.
//
//   PtyProgram program({TRAINCTL, "record", ...});
//   ASSERT_TRUE(program.WaitFor("waiting for a touch"));
//   program.Type("q");
//   EXPECT_EQ(program.Wait(), 0);
//
// Owns the process and kills it at the end. Not thread-safe.
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <chrono>
#include <string>
#include <vector>

namespace tactus::internal::testing {

class PtyProgram {
 public:
  explicit PtyProgram(std::vector<std::string> command, bool colour = false) {
    master_ = posix_openpt(O_RDWR | O_NOCTTY);
    grantpt(master_);
    unlockpt(master_);
    const std::string name = ptsname(master_);
    Resize(80, 24);
    slave_ = open(name.c_str(), O_RDWR | O_NOCTTY);
    tcgetattr(slave_, &before_);
    std::vector<char*> argv;
    for (std::string& part : command) argv.push_back(part.data());
    argv.push_back(nullptr);
    child_ = fork();
    if (child_ != 0) return;
    setsid();
    ioctl(slave_, TIOCSCTTY, 0);
    for (const int fd : {0, 1, 2}) dup2(slave_, fd);
    setenv("TERM", "xterm-256color", 1);
    setenv("LC_ALL", "C.UTF-8", 1);
    if (colour) {
      unsetenv("NO_COLOR");
    } else {
      setenv("NO_COLOR", "1", 1);
    }
    execv(argv[0], argv.data());
    _exit(127);
  }
  ~PtyProgram() {
    if (child_ > 0) {
      kill(child_, SIGKILL);
      waitpid(child_, nullptr, 0);
    }
    close(slave_);
    close(master_);
  }
  PtyProgram(const PtyProgram&) = delete;
  PtyProgram& operator=(const PtyProgram&) = delete;

  // True once the program has written `text` since the last call that found
  // its text; false after 30 s, or if the program ended without it.
  bool WaitFor(const std::string& text) {
    const auto end =
        std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (std::chrono::steady_clock::now() < end) {
      const size_t at = output_.find(text, seen_);
      if (at != output_.npos) {
        seen_ = at + text.size();
        return true;
      }
      if (!Read() && !Running()) return false;
    }
    return false;
  }
  void Type(const std::string& keys) {
    [[maybe_unused]] const auto written =
        write(master_, keys.data(), keys.size());
  }
  void Signal(int signal) { kill(child_, signal); }
  void Resize(int columns, int rows) {
    winsize size = {};
    size.ws_col = static_cast<uint16_t>(columns);
    size.ws_row = static_cast<uint16_t>(rows);
    ioctl(master_, TIOCSWINSZ, &size);
  }
  // The exit code, or minus the signal that ended the program.
  int Wait() {
    while (Running()) Read();
    while (Read()) {
    }
    return WIFEXITED(status_) ? WEXITSTATUS(status_) : -WTERMSIG(status_);
  }
  const std::string& output() const { return output_; }
  // The terminal's mode is that from before the program.
  bool IsRestored() const {
    termios now = {};
    tcgetattr(slave_, &now);
    return now.c_lflag == before_.c_lflag &&
           now.c_cc[VMIN] == before_.c_cc[VMIN] &&
           now.c_cc[VSUSP] == before_.c_cc[VSUSP];
  }

 private:
  bool Running() {
    if (child_ > 0 && waitpid(child_, &status_, WNOHANG) == child_) child_ = 0;
    return child_ > 0;
  }
  // False if nothing came within 50 ms.
  bool Read() {
    pollfd wait = {.fd = master_, .events = POLLIN, .revents = 0};
    if (poll(&wait, 1, 50) <= 0 || (wait.revents & POLLIN) == 0) return false;
    char buffer[65536];
    const ssize_t count = read(master_, buffer, sizeof buffer);
    if (count <= 0) return false;
    output_.append(buffer, static_cast<size_t>(count));
    return true;
  }

  int master_ = -1;
  int slave_ = -1;
  pid_t child_ = 0;
  int status_ = 0;
  termios before_ = {};
  std::string output_;
  size_t seen_ = 0;
};

}  // namespace tactus::internal::testing
