// File: echo_server.h
//
// What gRPC alone costs: a server whose every method answers each message of a
// stream with one of a given size, by the callback interface, as tactusd's
// adapter is built, or by a completion queue. Run as a child process,
// `tactus-bench echo-server`.
#pragma once

#include <string>

#include "absl/status/status.h"

namespace CLI {
class App;
}  // namespace CLI

namespace tactus::client {

struct EchoOptions {
  std::string port_file;
  // What every message is answered with, in hexadecimal.
  std::string answer;
  // In place of a completion queue and its thread.
  bool callbacks = false;
};

void AddEchoFlags(EchoOptions& options, CLI::App& command);

// Serves on a free port until the process is ended. IO if it cannot listen.
absl::Status RunEchoServer(const EchoOptions& options);

}  // namespace tactus::client
