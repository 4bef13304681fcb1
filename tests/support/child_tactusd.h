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
//   EXPECT_TRUE(server.PeakIsBelow(100));
//
//   ChildTactusd few(ChildTactusd::Options{.max_open_files = 128});
//   EXPECT_EQ(ChildTactusd::Run({"--no-such-flag"}), 1);
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
#include <optional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "absl/base/config.h"
#include "gtest/gtest.h"
#include "tests/support/time_limit.h"

namespace tactus::internal::testing {

class ChildTactusd {
 public:
  struct Options {
    std::vector<std::string> flags = {};
    // "NAME=value", in addition to the variables of this process.
    std::vector<std::string> environment = {};
    // Soft and hard limit of open files; 0 leaves both as they are.
    int max_open_files = 0;
    // Becomes its standard error; -1 for the file that Log() reads.
    int standard_error = -1;
    // False: returns without waiting until it serves; there is no port then.
    bool wait = true;
  };

  // Starts tactusd with `flags` and waits until it serves.
  explicit ChildTactusd(const std::vector<std::string>& flags = {})
      : ChildTactusd(Options{.flags = flags}) {}
  explicit ChildTactusd(Options options) {
    const std::string port_file = base_ + ".port";
    // The first address is the one whose port the file holds.
    options.flags.insert(options.flags.begin(),
                         {"--listen=127.0.0.1:0", "--port-file=" + port_file});
    Spawn(options);
    for (int i = 0; options.wait && i < 2000 && pid_ > 0 && port_ == 0; ++i) {
      if (!(std::ifstream(port_file) >> port_)) {
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
        if (waitpid(pid_, nullptr, WNOHANG) == pid_) pid_ = -1;
      }
    }
    std::remove(port_file.c_str());
  }
  // Runs tactusd with these flags alone to its end; returns what Wait does.
  static int Run(const std::vector<std::string>& flags,
                 const std::vector<std::string>& environment = {}) {
    ChildTactusd child(NotServing{});
    child.Spawn({.flags = flags, .environment = environment});
    return child.Wait();
  }
  ~ChildTactusd() {
    if (pid_ > 0) {
      kill(pid_, SIGKILL);
      waitpid(pid_, nullptr, 0);
    }
    std::remove(LogFile().c_str());
    std::remove((base_ + ".port").c_str());
  }

  ChildTactusd(const ChildTactusd&) = delete;
  ChildTactusd& operator=(const ChildTactusd&) = delete;

  pid_t pid() const { return pid_; }
  // 0 if it did not start.
  int port() const { return port_; }
  std::string address() const { return "127.0.0.1:" + std::to_string(port_); }

  void Signal(int signal) const { kill(pid_, signal); }
  // Waits for its end; returns the exit code, or minus the signal. Fails the
  // test and kills it if it does not end within kLongestCall.
  int Wait() {
    const std::optional<int> end = WaitFor(kLongestCall);
    if (end.has_value()) return *end;
    ADD_FAILURE() << "tactusd still runs after " << kLongestCall.count()
                  << " s; its log:\n"
                  << Log();
    Signal(SIGKILL);
    return Reap();
  }
  // The same, or nothing if it still runs after `timeout`.
  std::optional<int> WaitFor(std::chrono::milliseconds timeout) {
    const auto end = std::chrono::steady_clock::now() + timeout;
    siginfo_t info = {};
    do {
      // Looks without taking the exit code away from Reap.
      if (waitid(P_PID, pid_, &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
          info.si_pid == pid_) {
        return Reap();
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    } while (std::chrono::steady_clock::now() < end);
    return std::nullopt;
  }

  // Resident memory now and the most since the start or ResetPeak, MiB.
  double ResidentMib() const { return StatusField("VmRSS:") / 1024.0; }
  double PeakMib() const { return StatusField("VmHWM:") / 1024.0; }
  void ResetPeak() const {
    std::ofstream("/proc/" + std::to_string(pid_) + "/clear_refs") << "5\n";
  }
  // Whether that is below `mib`. AddressSanitizer adds shadow memory and keeps
  // freed memory, so its builds pass.
  ::testing::AssertionResult ResidentIsBelow(double mib) const {
    return IsBelow(ResidentMib(), mib);
  }
  ::testing::AssertionResult PeakIsBelow(double mib) const {
    return IsBelow(PeakMib(), mib);
  }
  int Threads() const { return static_cast<int>(StatusField("Threads:")); }
  // Standard error so far.
  std::string Log() const {
    std::ostringstream text;
    text << std::ifstream(LogFile()).rdbuf();
    return text.str();
  }

 private:
  static ::testing::AssertionResult IsBelow(double used, double mib) {
#ifdef ABSL_HAVE_ADDRESS_SANITIZER
    return ::testing::AssertionSuccess();
#endif
    return (used < mib ? ::testing::AssertionSuccess()
                       : ::testing::AssertionFailure())
           << used << " MiB, " << mib << " MiB are allowed";
  }
  struct NotServing {};
  explicit ChildTactusd(NotServing) {}

  // Takes the exit code of a process that has ended or is about to.
  int Reap() {
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }

  static std::vector<char*> Pointers(std::vector<std::string>& texts) {
    std::vector<char*> pointers;
    for (std::string& text : texts) pointers.push_back(text.data());
    pointers.push_back(nullptr);
    return pointers;
  }

  void Spawn(const Options& options) {
    std::vector<std::string> words;
    if (options.max_open_files > 0) {
      words = {"/bin/sh", "-c",
               "ulimit -n " + std::to_string(options.max_open_files) +
                   " && exec \"$@\"",
               "sh"};
    }
    words.push_back(TACTUSD);
    words.insert(words.end(), options.flags.begin(), options.flags.end());
    std::vector<std::string> variables = options.environment;
    for (char** variable = environ; *variable != nullptr; ++variable) {
      variables.push_back(*variable);
    }
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    if (options.standard_error >= 0) {
      posix_spawn_file_actions_adddup2(&actions, options.standard_error,
                                       STDERR_FILENO);
    } else {
      posix_spawn_file_actions_addopen(&actions, STDERR_FILENO,
                                       LogFile().c_str(),
                                       O_WRONLY | O_CREAT | O_TRUNC, 0600);
    }
    if (posix_spawn(&pid_, words[0].c_str(), &actions, nullptr,
                    Pointers(words).data(), Pointers(variables).data())) {
      pid_ = -1;
    }
    posix_spawn_file_actions_destroy(&actions);
  }

  static std::string NextBase() {
    static std::atomic<int> count = 0;
    return "/tmp/tactusd-child-" + std::to_string(getpid()) + "-" +
           std::to_string(++count);
  }
  std::string LogFile() const { return base_ + ".log"; }

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
  // Its files begin with this path.
  const std::string base_ = NextBase();
};

}  // namespace tactus::internal::testing
