// File: haproxy.h
//
// Haproxy: HAProxy with deploy/haproxy.cfg as a child process, in front of one
// server of this machine. The process ends with the object.
//
//   TACTUS_ASSIGN_OR_RETURN(auto proxy, Haproxy::Start(server->address()));
//   MakeChannel(proxy->address());
//
// Owns the process and its folder. Not thread-safe.
#pragma once

#include <sys/types.h>

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "tests/bench/temporary_folder.h"

namespace tactus::internal::client {

class Haproxy {
 public:
  // Whether the program is installed.
  static bool Installed();
  // Starts it before the server at `backend`, "127.0.0.1:50052". Returns when
  // it accepts connections, or IO after ten seconds.
  static absl::StatusOr<std::unique_ptr<Haproxy>> Start(
      const std::string& backend);
  ~Haproxy();

  Haproxy(const Haproxy&) = delete;
  Haproxy& operator=(const Haproxy&) = delete;

  const std::string& address() const { return address_; }

 private:
  explicit Haproxy(TemporaryFolder folder) : folder_(std::move(folder)) {}
  absl::Status Await(int port);

  TemporaryFolder folder_;
  pid_t pid_ = -1;
  std::string address_;
};

}  // namespace tactus::internal::client
