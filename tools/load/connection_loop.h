// File: connection_loop.h
//
// ConnectionLoop: the connections of one thread, served when it suits that
// thread. One that waits for answers would be woken for each, at the server's
// cost if both share a machine; and what is sent together over a connection
// costs little more than one message.
//
//   ConnectionLoop loop;
//   GrpcConnection connection(&loop, place);
//   loop.HandleUntil([&] { return started; }, timeout);
//   loop.HandleReady();   // takes what has come
//   loop.Flush();         // sends what is due
//
// Must outlive its connections. Not thread-safe.
#pragma once

#include <chrono>
#include <memory>
#include <vector>

#include "boost/asio/executor_work_guard.hpp"
#include "boost/asio/io_context.hpp"

namespace tactus::internal::client {

class ConnectionLoop {
 public:
  // What Flush flushes.
  class Connection {
   public:
    virtual void Flush() = 0;

   protected:
    ~Connection() = default;
  };

  ConnectionLoop() = default;
  ConnectionLoop(const ConnectionLoop&) = delete;
  ConnectionLoop& operator=(const ConnectionLoop&) = delete;

  boost::asio::io_context& io() { return io_; }
  // The next Flush flushes `connection`, too.
  void Touch(std::shared_ptr<Connection> connection) {
    touched_.push_back(std::move(connection));
  }

  void HandleReady() {
    io_.poll();
    Flush();
  }
  void Flush() {
    // A flush may touch others.
    while (!touched_.empty()) {
      flushed_.swap(touched_);
      for (const auto& connection : flushed_) connection->Flush();
      flushed_.clear();
    }
  }
  // Handles what comes until `done()`; false if that takes longer than
  // `timeout`.
  template <typename Done>
  bool HandleUntil(Done done, std::chrono::milliseconds timeout) {
    const auto deadline = std::chrono::steady_clock::now() + timeout;
    Flush();
    while (!done()) {
      if (io_.run_one_until(deadline) == 0) return done();
      HandleReady();
    }
    return true;
  }

 private:
  // One thread runs it: no locks.
  boost::asio::io_context io_{1};
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type>
      work_{io_.get_executor()};
  std::vector<std::shared_ptr<Connection>> touched_;
  std::vector<std::shared_ptr<Connection>> flushed_;
};

}  // namespace tactus::internal::client
