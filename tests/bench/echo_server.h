// File: echo_server.h
//
// A server that measures the cost of gRPC alone: every method answers each
// message of a stream with a fixed message. It uses a completion queue, as
// tactusd does, or the callback interface. It runs as a child process,
// `tactus-bench echo-server`.
//
//   EchoOptions options;
//   AddEchoFlags(options, *command);
//   absl::Status ended = RunEchoServer(options);
#pragma once

#include <string>

#include "absl/status/status.h"

namespace CLI {
class App;
}  // namespace CLI

namespace tactus::internal::client {

struct EchoOptions {
  std::string port_file;
  // The answer to every message, in hexadecimal.
  std::string answer;
  // Use the callback interface instead of a completion queue.
  bool callbacks = false;
};

void AddEchoFlags(EchoOptions& options, CLI::App& command);

// Serves on a free port until the process ends. IO if it cannot listen.
absl::Status RunEchoServer(const EchoOptions& options);

}  // namespace tactus::internal::client
