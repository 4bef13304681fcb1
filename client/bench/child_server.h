// File: child_server.h
//
// ChildServer: a tactusd of our own, the program beside this one, on a free
// port; ended with the object.
//
//   TACTUS_ASSIGN_OR_RETURN(auto server, ChildServer::Start());
//   MakeChannel(server->address());
//
// Owns the process. Not thread-safe.
#pragma once

#include <sys/types.h>

#include <memory>
#include <string>

#include "absl/status/statusor.h"

namespace tactus::client {

class ChildServer {
 public:
  // Returns once it serves; IO if it does not within ten seconds.
  static absl::StatusOr<std::unique_ptr<ChildServer>> Start();
  ~ChildServer();

  ChildServer(const ChildServer&) = delete;
  ChildServer& operator=(const ChildServer&) = delete;

  const std::string& address() const { return address_; }

 private:
  ChildServer() = default;
  absl::Status Await(const std::string& port_file);

  pid_t pid_ = -1;
  std::string address_;
};

}  // namespace tactus::client
