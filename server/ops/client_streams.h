// File: client_streams.h
//
// ClientStreams: how many streams each client has open, where a client is a
// token, a certificate or, without credentials, a peer.
//
//   ClientStreams clients(100);
//   TACTUS_RETURN_IF_ERROR(clients.Enter(call, caller.name));
//   // ... serve the stream ...
//   clients.Leave(call);
//
// Thread-safe. Enter and Leave take a lock, once per call.
#pragma once

#include <mutex>
#include <string>
#include <unordered_map>

#include "absl/status/status.h"
#include "core/base/errors.h"

namespace tactus::internal::server {

class ClientStreams {
 public:
  // `limit`: of one client; 0 means none, and nothing is counted.
  explicit ClientStreams(int limit) : limit_(limit) {}

  // QUOTA_EXCEEDED. `call` identifies the stream until it leaves.
  absl::Status Enter(const void* call, const std::string& client) {
    if (limit_ == 0) return absl::OkStatus();
    const std::lock_guard lock(mutex_);
    int& live = live_of_[client];
    if (live >= limit_) {
      return QuotaExceeded(client, "streams", limit_, live, "end a stream");
    }
    ++live;
    client_of_[call] = client;
    return absl::OkStatus();
  }
  // Nothing happens if the call has not entered.
  void Leave(const void* call) {
    if (limit_ == 0) return;
    const std::lock_guard lock(mutex_);
    const auto found = client_of_.find(call);
    if (found == client_of_.end()) return;
    const auto live = live_of_.find(found->second);
    if (--live->second == 0) live_of_.erase(live);
    client_of_.erase(found);
  }

 private:
  const int limit_;
  std::mutex mutex_;
  std::unordered_map<const void*, std::string> client_of_;
  std::unordered_map<std::string, int> live_of_;
};

}  // namespace tactus::internal::server
