// File: restarted_server.h
//
// RestartedServer: the program tactusd, which ends and comes back on the same
// port. A target that uses it defines TACTUSD and depends on tactusd.
//
//   RestartedServer server;
//   auto stream = ResumableStream::Open(MakeChannel(server.address()), ...);
//   server.Kill();
//   server.Start();
//
// Owns the process. Not thread-safe.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gtest/gtest.h"
#include "tests/support/child_tactusd.h"

namespace tactus::internal::testing {

class RestartedServer {
 public:
  explicit RestartedServer(std::vector<std::string> flags = {})
      : flags_(std::move(flags)),
        server_(std::make_unique<ChildTactusd>(flags_)),
        address_(server_->address()) {
    EXPECT_NE(server_->port(), 0) << server_->Log();
  }

  const std::string& address() const { return address_; }
  void Kill() { End(SIGKILL); }
  // It has ended by itself within its drain grace.
  void Drain() { End(SIGTERM); }
  void Signal(int signal) const { server_->Signal(signal); }
  void Start() {
    std::vector<std::string> flags = flags_;
    flags.push_back(absl::StrCat("--listen=", address_));
    // The kernel may have given the port to a connection of another process
    // meanwhile.
    for (int i = 0; i < 20; ++i) {
      server_ = std::make_unique<ChildTactusd>(flags);
      if (server_->port() != 0) return;
    }
    FAIL() << server_->Log();
  }
  void Restart() {
    Kill();
    Start();
  }

 private:
  void End(int signal) {
    server_->Signal(signal);
    server_->Wait();
  }

  const std::vector<std::string> flags_;
  std::unique_ptr<ChildTactusd> server_;
  const std::string address_;
};

}  // namespace tactus::internal::testing
