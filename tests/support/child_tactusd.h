// File: child_tactusd.h
//
// ChildTactusd: the program tactusd as a child process on a free loopback
// port, for tests that look at the process from outside: its memory, threads,
// file descriptors and how it ends. A target that uses it defines TACTUSD as
// the program's path and depends on tactusd.
//
//   ChildTactusd server({"--max-streams=10"});
//   ASSERT_NE(server.port(), 0);
//   server.ResetPeak();
//   ...attack server.port()...
//   EXPECT_LT(server.PeakMib(), 100);
//
// Owns the process and kills it at the end. Not thread-safe, except for the
// reading functions.
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace tactus::testing {

class ChildTactusd {
 public:
  // Starts tactusd with `flags` and waits until it serves.
  explicit ChildTactusd(std::vector<std::string> flags = {}) {
    static std::atomic<int> count = 0;
    const std::string port_file = "/tmp/tactusd-child-" +
                                  std::to_string(getpid()) + "-" +
                                  std::to_string(++count);
    std::remove(port_file.c_str());
    log_ = port_file + ".log";
    flags.insert(flags.begin(),
                 {TACTUSD, "--listen=127.0.0.1:0", "--port-file=" + port_file});
    std::vector<char*> argv;
    for (std::string& flag : flags) argv.push_back(flag.data());
    argv.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, log_.c_str(),
                                     O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (posix_spawn(&pid_, TACTUSD, &actions, nullptr, argv.data(), environ)) {
      pid_ = -1;
    }
    posix_spawn_file_actions_destroy(&actions);
    for (int i = 0; i < 2000 && pid_ > 0 && port_ == 0; ++i) {
      if (!(std::ifstream(port_file) >> port_)) {
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
      }
    }
    std::remove(port_file.c_str());
  }
  ~ChildTactusd() {
    if (pid_ > 0) {
      kill(pid_, SIGKILL);
      waitpid(pid_, nullptr, 0);
    }
    std::remove(log_.c_str());
  }

  ChildTactusd(const ChildTactusd&) = delete;
  ChildTactusd& operator=(const ChildTactusd&) = delete;

  pid_t pid() const { return pid_; }
  // 0 if it did not start.
  int port() const { return port_; }
  std::string address() const { return "127.0.0.1:" + std::to_string(port_); }

  void Signal(int signal) const { kill(pid_, signal); }
  // Waits for its end; returns the exit code, or minus the signal.
  int Wait() {
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }

  // Resident memory now and the most since the start or ResetPeak, MiB.
  double ResidentMib() const { return StatusField("VmRSS:") / 1024.0; }
  double PeakMib() const { return StatusField("VmHWM:") / 1024.0; }
  void ResetPeak() const {
    std::ofstream("/proc/" + std::to_string(pid_) + "/clear_refs") << "5\n";
  }
  int Threads() const { return static_cast<int>(StatusField("Threads:")); }
  // Standard error so far.
  std::string Log() const {
    std::ostringstream text;
    text << std::ifstream(log_).rdbuf();
    return text.str();
  }

 private:
  long StatusField(const std::string& name) const {
    std::ifstream file("/proc/" + std::to_string(pid_) + "/status");
    std::string word;
    while (file >> word) {
      long value = 0;
      if (word == name && file >> value) return value;
    }
    return -1;
  }

  pid_t pid_ = -1;
  int port_ = 0;
  std::string log_;
};

}  // namespace tactus::testing
