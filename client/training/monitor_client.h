// File: monitor_client.h
//
// MonitorClient: the open streams of one server, for those who watch.
//
//   MonitorClient monitor(&client);
//   TACTUS_ASSIGN_OR_RETURN(const auto streams, monitor.ListStreams());
//   absl::Status status = monitor.WatchAll(
//       v1::WatchAllRequest(),
//       [](const v1::StreamUpdate& update) { Show(update); });
//
// Errors as TrainingClient's. Cancel is thread-safe, all else is for one
// thread. `client` must outlive it.
#pragma once

#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/training/training_client.h"
#include "tactus/v1/monitor.pb.h"

namespace tactus::internal::client {

class MonitorClient {
 public:
  using OnUpdate = std::function<void(const v1::StreamUpdate&)>;

  explicit MonitorClient(TrainingClient* client) : client_(*client) {}

  // All pages, the oldest stream first.
  absl::StatusOr<std::vector<v1::OpenStream>> ListStreams();

  // Calls `on_update` with what is new, until the stream ends (OK), the
  // connection is lost, or Cancel (CANCELLED). Updates are checked:
  // INVALID_RESPONSE if one is of a stream that was not described, or if its
  // numbers do not fit the stream.
  absl::Status WatchStream(const v1::WatchStreamRequest& request,
                           const OnUpdate& on_update);
  // Also calls `on_response` after each response; the first comes at once.
  absl::Status WatchAll(
      const v1::WatchAllRequest& request, const OnUpdate& on_update,
      const std::function<void()>& on_response = [] {});

  // Ends a watch, also one that begins later.
  void Cancel();

 private:
  // What updates must fit.
  struct Shape {
    std::vector<int> values;  // of each question
    size_t classes = 0;
    size_t taxel_bytes = 0;
  };

  template <typename Response, typename Call, typename Take>
  absl::Status Watch(const char* what, const Call& call, const Take& take);
  absl::Status OnUpdateOf(const v1::StreamUpdate& update,
                          const OnUpdate& on_update);
  absl::Status Check(const v1::StreamUpdate& update);
  static absl::Status CheckAnswers(const v1::Contact& contact,
                                   const Shape& shape);
  static absl::Status CheckValue(uint32_t question, uint32_t value,
                                 const Shape& shape);

  TrainingClient& client_;
  // By the ids of the streams that are watched.
  std::map<std::string, Shape> shapes_;

  std::mutex mutex_;
  grpc::ClientContext* context_ = nullptr;
  bool cancelled_ = false;
};

}  // namespace tactus::internal::client
