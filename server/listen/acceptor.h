// File: acceptor.h
//
// Acceptor: accepts connections on listening sockets, within limits, and hands
// each one on.
//
//   Acceptor acceptor(std::move(sockets), {}, [](const auto& socket, int fd) {
//     // ... owns fd from here on ...
//   });
//   acceptor.Start();
//   // ... until the process is to end ...
//   acceptor.Stop();
//
// gRPC 1.51 limits neither the number of connections nor that of one peer, and
// it never accepts again on a socket after the process once ran out of file
// descriptors. The acceptor refuses a connection above a limit by closing it,
// and tries again when descriptors are short.
//
// Runs one thread, on which `on_connection` is called. Start and Stop belong
// to one thread; ExpectSelfCheck may be called from any.
#pragma once

#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "server/listen/connection_table.h"
#include "server/listen/listening_socket.h"
#include "server/ops/log_limiter.h"

namespace tactus::internal::server {

class Acceptor {
 public:
  // `fd` is connected and non-blocking; the callee owns it.
  using OnConnection = std::function<void(const ListeningSocket&, int fd)>;

  Acceptor(std::vector<ListeningSocket> sockets,
           const ConnectionTable::Limits& limits, OnConnection on_connection);
  ~Acceptor() { Stop(); }

  Acceptor(const Acceptor&) = delete;
  Acceptor& operator=(const Acceptor&) = delete;

  void Start();
  // Accepts no more; connections that wait in the kernel are closed with the
  // sockets. Does nothing the second time.
  void Stop();

  // Ends the connections that it accepted and that are still open. After Stop.
  void CutOff() const { table_.ShutDownAll(); }

  const std::vector<ListeningSocket>& sockets() const { return sockets_; }

  // The next connection from `own` is the self-check: it passes the limits, so
  // that strangers who fill them do not make the server look dead.
  void ExpectSelfCheck(const SocketAddress& own);

 private:
  void Run();
  // Ends the connections whose peers read nothing.
  void EndUnread();
  // False if descriptors or memory are short.
  bool AcceptWaiting(const ListeningSocket& socket);
  bool IsSelfCheck(const SocketAddress& peer);
  void LogRefusal(Verdict verdict, const SocketAddress& peer);

  std::vector<ListeningSocket> sockets_;
  ConnectionTable table_;
  const OnConnection on_connection_;
  int64_t last_look_ns_ = 0;
  // Becomes readable when Stop is called.
  FileDescriptor stop_event_;
  std::thread thread_;
  LogLimiter refusals_{{.lines_per_second = 1, .burst = 5}};

  std::mutex mutex_;
  SocketAddress self_check_;
};

}  // namespace tactus::internal::server
