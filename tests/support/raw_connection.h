// File: raw_connection.h
//
// A TCP connection that says what a test wants.
#pragma once

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <string>

namespace tactus::internal::testing {

// A connection to a port of this host; a stranger decides what it says.
class RawConnection {
 public:
  explicit RawConnection(int port) : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address = {};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const timeval patience = {.tv_sec = 20, .tv_usec = 0};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
    connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof(address));
  }
  ~RawConnection() { close(socket_); }
  RawConnection(const RawConnection&) = delete;
  RawConnection& operator=(const RawConnection&) = delete;

  // Says no more.
  void EndSending() const { shutdown(socket_, SHUT_WR); }
  void Send(const std::string& bytes) const {
    size_t sent = 0;
    while (sent < bytes.size()) {
      const ssize_t now =
          send(socket_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
      if (now <= 0) return;
      sent += static_cast<size_t>(now);
    }
  }
  // Up to `end`, and perhaps more; all if it does not come.
  std::string ReadUntil(const std::string& end) const {
    std::string text;
    char part[4096];
    ssize_t count = 0;
    while (text.find(end) == std::string::npos &&
           (count = recv(socket_, part, sizeof(part), 0)) > 0) {
      text.append(part, static_cast<size_t>(count));
    }
    return text;
  }
  std::string ReadAll() const {
    std::string text;
    char part[4096];
    ssize_t count = 0;
    while ((count = recv(socket_, part, sizeof(part), 0)) > 0) {
      text.append(part, static_cast<size_t>(count));
    }
    return text;
  }

 private:
  const int socket_;
};

}  // namespace tactus::internal::testing
