// File: admin_client.h
//
// AdminClient: the administration of one server, and the logs of its jobs.
//
//   AdminClient admin(&client);
//   TACTUS_ASSIGN_OR_RETURN(const auto info, admin.GetServerInfo());
//
// Errors as TrainingClient's. Thread-safe. `client` must outlive it.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/training/training_client.h"
#include "tactus/v1/admin.pb.h"

namespace tactus::internal::client {

class AdminClient {
 public:
  // What a server has of the log of a job.
  struct JobLog {
    std::string text;
    // Bytes before the text that the server did not keep.
    int64_t omitted_bytes = 0;
  };

  explicit AdminClient(TrainingClient* client) : client_(*client) {}

  absl::StatusOr<v1::GetServerInfoResponse> GetServerInfo();
  // At most `limit` entries, the newest first; `filter` without page fields.
  absl::StatusOr<std::vector<v1::AuditEntry>> ListAuditLog(
      v1::ListAuditLogRequest filter, size_t limit);
  absl::StatusOr<v1::DrainResponse> Drain();
  absl::StatusOr<JobLog> ReadOperationLog(const std::string& name);

 private:
  TrainingClient& client_;
};

}  // namespace tactus::internal::client
