// File: keep_warm.h
//
// KeepWarm: calls the server from within its own process every 250 ms.
//
// The worker threads of gRPC's callback API sleep 100 ms after a second in
// which nothing happened, so that the first frame of a touch on an idle server
// would be answered up to 100 ms late. A trickle of calls keeps them awake for
// about 0.1 % of a processor.
//
// Owns its thread; stops with the object.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <thread>

#include "grpcpp/channel.h"

namespace tactus::server {

class KeepWarm {
 public:
  // `channel` is the server's in-process channel.
  explicit KeepWarm(std::shared_ptr<grpc::Channel> channel);
  ~KeepWarm();

  KeepWarm(const KeepWarm&) = delete;
  KeepWarm& operator=(const KeepWarm&) = delete;

 private:
  void Run();

  std::shared_ptr<grpc::Channel> channel_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace tactus::server
