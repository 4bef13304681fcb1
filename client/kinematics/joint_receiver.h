// File: joint_receiver.h
//
// JointReceiver: joint values that a robot's program sends by UDP, one sample
// per datagram (joint_line.h), for JointPoses.
//
//   TACTUS_ASSIGN_OR_RETURN(const auto receiver,
//                           JointReceiver::Listen("127.0.0.1:5005", &poses));
//
// The time is CLOCK_MONOTONIC of this host, in nanoseconds. A time of 0 stands
// for the time at which the datagram is received, for senders with another
// clock. Datagrams that are wrong are counted, and Statistics has the last
// reason. Whoever can send to the address moves the arm: listen on loopback, or
// in a network of which every host is trusted.
//
// Owns a thread and a socket. Thread-safe.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "absl/status/statusor.h"
#include "client/drivers/clock.h"
#include "client/kinematics/joint_poses.h"

namespace tactus::internal::client {

class JointReceiver {
 public:
  // A sample whose time is farther than this from now has another clock.
  static constexpr int64_t kMaxClockDifferenceNs = 1'000'000'000;

  struct Statistics {
    uint64_t taken = 0;
    uint64_t refused = 0;
    // Why the last refused datagram was refused; empty if none was.
    std::string last_refusal = {};
    // The last datagram was refused.
    bool refusing = false;
  };

  // `address` is host:port; port 0 lets the kernel choose. INVALID_CONFIG if it
  // is no such address, IO if the socket cannot be opened. `poses` and `clock`
  // outlive the receiver.
  static absl::StatusOr<std::unique_ptr<JointReceiver>> Listen(
      const std::string& address, JointPoses* poses,
      Clock* clock = &Clock::System());
  // Ends the thread.
  ~JointReceiver();

  JointReceiver(const JointReceiver&) = delete;
  JointReceiver& operator=(const JointReceiver&) = delete;

  int port() const { return port_; }
  JointReceiver::Statistics statistics() const;

 private:
  JointReceiver(int socket, int port, JointPoses* poses, Clock* clock);

  void ReceiveAll();
  absl::Status Take(absl::string_view line, std::span<double> values);

  const int socket_;
  const int port_;
  JointPoses* const poses_;
  Clock* const clock_;
  std::atomic<bool> stop_ = false;

  mutable std::mutex mutex_;
  Statistics statistics_;
  std::thread thread_;
};

}  // namespace tactus::internal::client
