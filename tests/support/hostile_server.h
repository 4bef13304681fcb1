// File: hostile_server.h
//
// HostileServer: speaks HTTP/2 to each client in turn: its settings, `first`,
// and then `piece` again and again until the client leaves.
//
//   const HostileServer server(
//       RawHttp2::FrameBytes(RawHttp2::kHeaders, 0, 1, block),
//       RawHttp2::FrameBytes(9, 0, 1, more));
//   Dial(server.address());
//
// Its own thread runs until the destructor.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <string>
#include <thread>
#include <utility>

#include "tests/support/raw_http2.h"

namespace tactus::internal::testing {

class HostileServer {
 public:
  HostileServer(std::string first, std::string piece)
      : first_(std::move(first)), piece_(std::move(piece)) {
    sockaddr_in address = {};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    auto* generic = reinterpret_cast<sockaddr*>(&address);
    bind(listener_, generic, size);
    listen(listener_, 64);
    getsockname(listener_, generic, &size);
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this] { Run(); });
  }
  ~HostileServer() {
    stopping_ = true;
    shutdown(listener_, SHUT_RDWR);
    thread_.join();
    close(listener_);
  }

  std::string address() const { return "127.0.0.1:" + std::to_string(port_); }
  int connections() const { return connections_; }

 private:
  static constexpr int kMostPieces = 4'000;

  void Run() {
    while (!stopping_) {
      const int client = accept(listener_, nullptr, nullptr);
      if (client < 0) continue;
      ++connections_;
      Send(client, RawHttp2::FrameBytes(RawHttp2::kSettings, 0, 0, ""));
      // The client's preface; then its call, or the timeout.
      char bytes[4096];
      pollfd readable = {client, POLLIN, 0};
      for (int i = 0; i < 3 && poll(&readable, 1, 100) > 0; ++i) {
        if (recv(client, bytes, sizeof(bytes), 0) <= 0) break;
      }
      bool open = Send(client, first_);
      for (int i = 0; open && i < kMostPieces; ++i) open = Send(client, piece_);
      close(client);
    }
  }
  static bool Send(int client, const std::string& bytes) {
    size_t sent = 0;
    while (sent < bytes.size()) {
      const ssize_t count =
          send(client, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
      if (count <= 0) return false;
      sent += static_cast<size_t>(count);
    }
    return true;
  }

  const std::string first_;
  const std::string piece_;
  const int listener_ = socket(AF_INET, SOCK_STREAM, 0);
  int port_ = 0;
  std::atomic<bool> stopping_ = false;
  std::atomic<int> connections_ = 0;
  std::thread thread_;
};

}  // namespace tactus::internal::testing
