// File: bystander.h
//
// Bystander: a robot with one open stream that sends a frame, waits for the
// answer, and so on, on its own thread and connection. Tests of attacks ask it
// whether the server still serves it.
//
//   Bystander robot(server.address());
//   ...attack the server...
//   EXPECT_TRUE(robot.IsServed());
//   EXPECT_TRUE(robot.Finish().ok());
//
// IsServed may be called from any thread; Finish once.
#pragma once

#include <atomic>
#include <chrono>
#include <string>
#include <thread>
#include <utility>

#include "tests/server/support/test_server.h"

namespace tactus::internal::testing {

class Bystander {
 public:
  // `model` takes streams without poses; empty for the server's default.
  explicit Bystander(const std::string& address,
                     std::string model = kModelWithoutPoses)
      : model_(std::move(model)),
        stream_(OwnConnection(address)),
        thread_([this] { Play(); }) {}
  ~Bystander() {
    if (thread_.joinable()) Finish().IgnoreError();
  }

  Bystander(const Bystander&) = delete;
  Bystander& operator=(const Bystander&) = delete;

  // Waits for `answers` more answers. False if the stream ends instead, or if
  // they take longer than a loaded machine may need.
  bool IsServed(uint64_t answers = 20) const {
    const uint64_t goal = answered_ + answers;
    return Eventually([&] { return answered_ >= goal || over_; }) &&
           answered_ >= goal;
  }
  // Ends the stream in good order; returns how it ended.
  absl::Status Finish() {
    stop_ = true;
    thread_.join();
    stream_.HalfClose();
    return stream_.Finish();
  }

  // A channel that shares its connection with no other channel.
  static std::shared_ptr<grpc::Channel> OwnConnection(
      const std::string& address) {
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    return grpc::CreateCustomChannel(
        address, grpc::InsecureChannelCredentials(), arguments);
  }

 private:
  void Play() {
    uint64_t sequence = 0;
    bool alive =
        stream_.Write(ConfigRequest(model_)) && stream_.Read().has_started();
    while (alive && !stop_) {
      alive = stream_.Write(DenseU16(++sequence, {Touch(1)})) &&
              stream_.Read().answer().sequence() == sequence;
      if (alive) ++answered_;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    over_ = true;
  }

  const std::string model_;
  RawStream stream_;
  std::atomic<bool> stop_ = false;
  std::atomic<bool> over_ = false;
  std::atomic<uint64_t> answered_ = 0;
  // Last, so that it starts when everything else is there.
  std::thread thread_;
};

}  // namespace tactus::internal::testing
