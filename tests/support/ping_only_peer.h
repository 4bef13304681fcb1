// File: ping_only_peer.h
//
// PingOnlyPeer: a TCP listener on loopback that speaks as much HTTP/2 as keeps
// a connection alive: it sends its settings and acknowledges settings and
// pings. It answers nothing else.
//
//   PingOnlyPeer peer;
//   const auto channel = MakeChannel(peer.address());
//
// Serves one connection at a time on a separate thread, until destruction.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

namespace tactus::internal::testing {

class PingOnlyPeer {
 public:
  PingOnlyPeer() : listener_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    auto* generic = reinterpret_cast<sockaddr*>(&address);
    bind(listener_, generic, size);
    listen(listener_, 8);
    getsockname(listener_, generic, &size);
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this] { Run(); });
  }
  ~PingOnlyPeer() {
    Stop();
    thread_.join();
    close(listener_);
  }

  PingOnlyPeer(const PingOnlyPeer&) = delete;
  PingOnlyPeer& operator=(const PingOnlyPeer&) = delete;

  std::string address() const { return "127.0.0.1:" + std::to_string(port_); }
  // Closes the connection and takes no more. May be called from another thread.
  void Stop() {
    stopping_ = true;
    shutdown(listener_, SHUT_RDWR);
  }
  // Frames of a request that have arrived.
  int headers() const { return headers_; }

 private:
  static constexpr size_t kPrefaceBytes = 24;
  static constexpr uint8_t kHeaders = 1;
  static constexpr uint8_t kSettings = 4;
  static constexpr uint8_t kPing = 6;
  static constexpr uint8_t kAck = 1;

  void Run() {
    while (!stopping_) {
      if (!Readable(listener_)) continue;
      const int connection = accept(listener_, nullptr, nullptr);
      if (connection < 0) continue;
      Serve(connection);
      close(connection);
    }
  }

  void Serve(int connection) {
    std::vector<uint8_t> bytes;
    if (!Read(connection, kPrefaceBytes, bytes)) return;
    Write(connection, kSettings, 0, {});
    while (Read(connection, 9, bytes)) {
      const size_t length = bytes[0] << 16 | bytes[1] << 8 | bytes[2];
      const uint8_t type = bytes[3];
      const uint8_t flags = bytes[4];
      if (!Read(connection, length, bytes)) return;
      if (type == kHeaders) ++headers_;
      if ((flags & kAck) != 0) continue;
      if (type == kSettings) Write(connection, kSettings, kAck, {});
      if (type == kPing) Write(connection, kPing, kAck, bytes);
    }
  }

  bool Readable(int descriptor) const {
    pollfd poll_for{descriptor, POLLIN, 0};
    return poll(&poll_for, 1, 10) > 0;
  }

  // False at the end of the connection or of the test.
  bool Read(int connection, size_t size, std::vector<uint8_t>& bytes) const {
    bytes.resize(size);
    size_t got = 0;
    while (got < size) {
      if (stopping_) return false;
      if (!Readable(connection)) continue;
      const ssize_t n = read(connection, bytes.data() + got, size - got);
      if (n <= 0) return false;
      got += n;
    }
    return true;
  }

  // A frame of the whole connection; 255 bytes at most.
  static void Write(int connection, uint8_t type, uint8_t flags,
                    const std::vector<uint8_t>& payload) {
    std::vector<uint8_t> frame = {
        0, 0, static_cast<uint8_t>(payload.size()), type, flags, 0, 0, 0, 0};
    frame.insert(frame.end(), payload.begin(), payload.end());
    send(connection, frame.data(), frame.size(), MSG_NOSIGNAL);
  }

  const int listener_;
  int port_ = 0;
  std::atomic<bool> stopping_ = false;
  std::atomic<int> headers_ = 0;
  std::thread thread_;
};

}  // namespace tactus::internal::testing
