// File: client.h
//
// Client: the connection to a Tactus server, on which the skins of a robot have
// their streams.
//
//   Client client("arm.lab:50051", {.tls_ca = "ca.crt"});
//   auto palm = client.Open({.name = "vitac-12x32", .sample_rate_hz = 30});
//   auto forearm = client.Open(
//       {.name = "cody-forearm", .scale = 0.001},
//       {.on_event = [](const Event& event) { Use(event); }});
//   if (!palm.ok()) return palm.status();
//   if (!forearm.ok()) return forearm.status();
//   return (*palm)->Push(frame);
//
// A stream that loses its connection, or its server, is resumed: it sends the
// frames again that its answers depend on, and the robot gets what it would
// have got from one unbroken stream, each answer and event once.
//
// No call waits longer than its timeout. Callbacks run on a thread of their
// stream. Open may be called from any thread; streams outlive their client.
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "tactus/skin.h"
#include "tactus/stream.h"

namespace tactus {

struct ClientOptions {
  // PEM file of the authorities that may vouch for the server: the connection
  // is encrypted. Empty: it is not.
  std::string tls_ca = {};
  // The robot's bearer token; empty: none.
  std::string token = {};

  // How long a loss of a stream may last; 0: the first loss ends the stream.
  std::chrono::milliseconds resume_for{30'000};
  // What a stream keeps of its trial to resume it; 256 KiB to 16 MiB.
  size_t replay_bytes = 16UL * 1024 * 1024;

  // How long a server may take: to accept a stream, to take a frame, for a
  // final answer, and to end a stream. 0 is no limit.
  std::chrono::milliseconds open_timeout{10'000};
  std::chrono::milliseconds push_timeout{10'000};
  std::chrono::milliseconds answer_timeout{10'000};
  std::chrono::milliseconds close_timeout{10'000};
};

class Client {
 public:
  // `address` is "host:port" or "unix:path". Connects with the first stream.
  explicit Client(std::string address, ClientOptions options = {});
  ~Client();
  Client(Client&&) noexcept;
  Client& operator=(Client&&) noexcept;

  // Returns the stream once the server has accepted it, or the server's error:
  // INVALID_CONFIG and UNKNOWN_LAYOUT for a wrong skin, MODEL_NOT_FOUND,
  // GEOMETRY_MISMATCH if the model was trained on another skin, NO_RESPONSE
  // after the timeout. IO if the file `tls_ca` cannot be read.
  absl::StatusOr<std::unique_ptr<Stream>> Open(
      const Skin& skin, const StreamOptions& options = {}) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tactus
