// File: raw_http2.h
//
// RawHttp2: a client that writes HTTP/2 frames by hand, for tests of what a
// hostile peer may send. It sends the preface and an empty SETTINGS frame,
// then whatever the test asks for, in any order and without any check.
//
//   RawHttp2 attacker(port);
//   const uint32_t stream =
//   attacker.Open("/tactus.v1.ContactService/Classify");
//   attacker.Reset(stream);
//   ASSERT_TRUE(attacker.Flush());
//   attacker.ReadFor(std::chrono::milliseconds(100));
//
// Frames wait in a buffer until Flush. Reading answers SETTINGS and PING frames
// and follows the peer's flow control, so that the connection stays alive.
// Linux, IPv4 loopback only. Owns its socket. Not thread-safe.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tactus::internal::testing {

class RawHttp2 {
 public:
  using Headers = std::vector<std::pair<std::string, std::string>>;
  using Milliseconds = std::chrono::milliseconds;
  enum FrameType : uint8_t {
    kData = 0,
    kHeaders = 1,
    kReset = 3,
    kSettings = 4,
    kPing = 6,
    kGoAway = 7,
    kWindowUpdate = 8,
  };
  static constexpr uint8_t kAck = 1;
  static constexpr uint8_t kEndStream = 1;
  static constexpr uint8_t kEndHeaders = 4;
  static constexpr std::string_view kPreface =
      "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n";
  static constexpr size_t kMaxFrameBytes = 16384;

  explicit RawHttp2(int port) : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address = {};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const int on = 1;
    setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
    open_ = connect(socket_, reinterpret_cast<sockaddr*>(&address),
                    sizeof(address)) == 0;
    out_ = kPreface;
    Frame(kSettings, 0, 0, "");
  }
  ~RawHttp2() { close(socket_); }

  RawHttp2(const RawHttp2&) = delete;
  RawHttp2& operator=(const RawHttp2&) = delete;

  // False once the peer has closed the connection.
  bool open() const { return open_; }
  // Frames of `type` that came.
  int received(FrameType type) const {
    const auto found = received_.find(type);
    return found == received_.end() ? 0 : found->second;
  }

  // Appends one frame of any kind.
  void Frame(uint8_t type, uint8_t flags, uint32_t stream,
             std::string_view payload) {
    Append(FrameBytes(type, flags, stream, payload));
  }
  // Appends bytes of any kind.
  void Append(std::string_view bytes) { out_.append(bytes); }
  static std::string FrameBytes(uint8_t type, uint8_t flags, uint32_t stream,
                                std::string_view payload) {
    std::string frame;
    const auto byte = [&frame](uint32_t value) {
      frame.push_back(static_cast<char>(value & 0xFF));
    };
    const auto size = static_cast<uint32_t>(payload.size());
    for (const int shift : {16, 8, 0}) byte(size >> shift);
    byte(type);
    byte(flags);
    for (const int shift : {24, 16, 8, 0}) byte(stream >> shift);
    return frame.append(payload);
  }
  // The header block of a call to `path`.
  static std::string Block(const std::string& path, const Headers& more = {}) {
    Headers headers = CallHeaders(path);
    headers.insert(headers.end(), more.begin(), more.end());
    return Hpack(headers);
  }

  // Begins a gRPC call to `path` on the next stream; returns the stream's id.
  uint32_t Open(const std::string& path, const Headers& more = {}) {
    return OpenBlock(Block(path, more));
  }
  // The same with `headers` and no others.
  uint32_t OpenWith(const Headers& headers) {
    return OpenBlock(Hpack(headers));
  }
  // Ends what the client says in a call with `headers`.
  void Trailers(uint32_t stream, const Headers& headers) {
    Frame(kHeaders, kEndHeaders | kEndStream, stream, Hpack(headers));
  }
  void Reset(uint32_t stream) {
    stream_windows_.erase(stream);
    Frame(kReset, 0, stream, std::string("\0\0\0\x08", 4));
  }

  // Sends one gRPC message in DATA frames, as fast as the peer's flow control
  // allows. False if the peer closes the connection or lets nothing more in
  // for `timeout`.
  bool Message(uint32_t stream, std::string_view bytes, bool compressed = false,
               Milliseconds timeout = Milliseconds(10'000)) {
    std::string data(1, compressed ? '\1' : '\0');
    for (const int shift : {24, 16, 8, 0}) {
      data.push_back(static_cast<char>((bytes.size() >> shift) & 0xFF));
    }
    data.append(bytes);
    return SendData(stream, data, timeout);
  }

  // Writes everything that was appended. False if the connection is closed.
  bool Flush() {
    size_t sent = 0;
    while (open_ && sent < out_.size()) {
      // Answers are read meanwhile: a server that cannot write stops reading.
      pollfd poll_socket = {socket_, POLLIN | POLLOUT, 0};
      poll(&poll_socket, 1, 1000);
      if (poll_socket.revents & (POLLIN | POLLHUP)) ReadSome();
      if (!(poll_socket.revents & POLLOUT)) continue;
      const ssize_t count =
          send(socket_, out_.data() + sent, out_.size() - sent,
               MSG_NOSIGNAL | MSG_DONTWAIT);
      if (count > 0) {
        sent += static_cast<size_t>(count);
      } else if (errno != EAGAIN) {
        open_ = false;
      }
    }
    // Answers to what came meanwhile follow with the next flush.
    out_.erase(0, sent);
    return open_;
  }

  // Reads and answers for `time`, or until the peer closes.
  void ReadFor(Milliseconds time) {
    const auto end = std::chrono::steady_clock::now() + time;
    while (open_) {
      const auto left = std::chrono::duration_cast<Milliseconds>(
          end - std::chrono::steady_clock::now());
      if (left.count() <= 0) return;
      pollfd poll_socket = {socket_, POLLIN, 0};
      if (poll(&poll_socket, 1, static_cast<int>(left.count())) <= 0) return;
      ReadSome();
      Flush();
    }
  }
  // Reads until `done()` or for at most `timeout`; returns done().
  template <typename Condition>
  bool ReadUntil(Condition done, Milliseconds timeout) {
    const auto end = std::chrono::steady_clock::now() + timeout;
    while (open_ && !done() && std::chrono::steady_clock::now() < end) {
      ReadFor(Milliseconds(10));
    }
    return done();
  }

 private:
  static Headers CallHeaders(const std::string& path) {
    return {{":method", "POST"},
            {":scheme", "http"},
            {":path", path},
            {":authority", "localhost"},
            {"content-type", "application/grpc"},
            {"te", "trailers"}};
  }

  uint32_t OpenBlock(const std::string& block) {
    const uint32_t stream = next_stream_;
    next_stream_ += 2;
    stream_windows_[stream] = initial_window_;
    Frame(kHeaders, kEndHeaders, stream, block);
    return stream;
  }

  // HPACK literals: nothing is compressed.
  static std::string Hpack(const Headers& headers) {
    std::string block;
    const auto text = [&block](const std::string& value) {
      // A length of 7 bits, and what is more in groups of 7 bits.
      size_t size = value.size();
      if (size < 127) {
        block.push_back(static_cast<char>(size));
      } else {
        block.push_back(127);
        for (size -= 127; size >= 128; size >>= 7) {
          block.push_back(static_cast<char>(128 | (size & 127)));
        }
        block.push_back(static_cast<char>(size));
      }
      block.append(value);
    };
    for (const auto& [name, value] : headers) {
      block.push_back(0);  // with a new name, never in the table
      text(name);
      text(value);
    }
    return block;
  }

  bool SendData(uint32_t stream, std::string_view data, Milliseconds timeout) {
    while (!data.empty()) {
      const auto room = [&] {
        return std::min(connection_window_, stream_windows_[stream]);
      };
      if (!Flush()) return false;
      if (!ReadUntil([&] { return room() > 0; }, timeout)) return false;
      const size_t size =
          std::min({data.size(), kMaxFrameBytes, static_cast<size_t>(room())});
      Frame(kData, 0, stream, data.substr(0, size));
      connection_window_ -= static_cast<int64_t>(size);
      stream_windows_[stream] -= static_cast<int64_t>(size);
      data.remove_prefix(size);
    }
    return Flush();
  }

  void ReadSome() {
    char buffer[65536];
    const ssize_t count = recv(socket_, buffer, sizeof(buffer), MSG_DONTWAIT);
    if (count == 0 || (count < 0 && errno != EAGAIN)) open_ = false;
    if (count > 0) in_.append(buffer, static_cast<size_t>(count));
    size_t used = 0;
    while (in_.size() - used >= 9) {
      const size_t size = Number(used, 3);
      if (in_.size() - used < 9 + size) break;
      Handle(static_cast<uint8_t>(in_[used + 3]),
             static_cast<uint8_t>(in_[used + 4]), Number(used + 5, 4),
             in_.substr(used + 9, size));
      used += 9 + size;
    }
    in_.erase(0, used);
  }
  uint32_t Number(size_t at, int bytes) const {
    return NumberOf(std::string_view(in_).substr(at), bytes);
  }
  static uint32_t NumberOf(std::string_view text, int bytes) {
    uint32_t number = 0;
    for (int i = 0; i < bytes; ++i) {
      number = number << 8 | static_cast<uint8_t>(text[i]);
    }
    return number;
  }

  void Handle(uint8_t type, uint8_t flags, uint32_t stream,
              const std::string& payload) {
    ++received_[static_cast<FrameType>(type)];
    if (type == kSettings && !(flags & kAck)) {
      for (size_t at = 0; at + 6 <= payload.size(); at += 6) {
        const std::string_view setting = std::string_view(payload).substr(at);
        // SETTINGS_INITIAL_WINDOW_SIZE changes open streams as well.
        if (NumberOf(setting, 2) != 4) continue;
        const int64_t window = NumberOf(setting.substr(2), 4);
        for (auto& [id, left] : stream_windows_) {
          left += window - initial_window_;
        }
        initial_window_ = window;
      }
      Frame(kSettings, kAck, 0, "");
    } else if (type == kPing && !(flags & kAck)) {
      Frame(kPing, kAck, 0, payload);
    } else if (type == kWindowUpdate && stream == 0) {
      connection_window_ += NumberOf(payload, 4);
    } else if (type == kWindowUpdate) {
      stream_windows_[stream] += NumberOf(payload, 4);
    }
  }

  const int socket_;
  bool open_ = false;
  std::string out_;
  std::string in_;
  uint32_t next_stream_ = 1;
  int64_t initial_window_ = 65535;
  int64_t connection_window_ = 65535;
  std::map<uint32_t, int64_t> stream_windows_;
  std::map<FrameType, int> received_;
};

}  // namespace tactus::internal::testing
