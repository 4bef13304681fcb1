#include "server/records/quotas.h"

#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/store/records.h"
#include "tactus/v1/models.pb.h"
#include "tactus/v1/operations.pb.h"
#include "tactus/v1/storage.pb.h"
#include "tactus/v1/training.pb.h"

namespace tactus::internal::server {
namespace {

// How many records of `table` satisfy `counts`.
template <typename Message, typename Predicate>
absl::StatusOr<int64_t> Count(const Transaction& look, Table table,
                              const Predicate& counts) {
  int64_t count = 0;
  TACTUS_RETURN_IF_ERROR(
      VisitRecords<Message>(look, table, {}, [&](const Message& message) {
        count += counts(message) ? 1 : 0;
        return absl::OkStatus();
      }));
  return count;
}

}  // namespace

absl::StatusOr<int64_t> StoredBytes(const Transaction& look,
                                    absl::string_view client) {
  int64_t bytes = 0;
  TACTUS_RETURN_IF_ERROR(VisitRecords<v1::StoredUpload>(
      look, Table::kUploads, {}, [&](const v1::StoredUpload& upload) {
        if (upload.requester() == client && upload.dataset_version().empty()) {
          bytes += upload.committed_size();
        }
        return absl::OkStatus();
      }));
  TACTUS_RETURN_IF_ERROR(
      VisitRecords<v1::DatasetVersion>(look, Table::kDatasetVersions, {},
                                       [&](const v1::DatasetVersion& version) {
                                         if (version.requester() == client)
                                           bytes += version.added_bytes();
                                         return absl::OkStatus();
                                       }));
  return bytes;
}

absl::Status CheckModelBytes(const Transaction& look, const Quotas& quotas,
                             absl::string_view client, int64_t more) {
  if (quotas.model_bytes == 0) return absl::OkStatus();
  int64_t use = 0;
  TACTUS_RETURN_IF_ERROR(VisitRecords<v1::ModelVersion>(
      look, Table::kModelVersions, {}, [&](const v1::ModelVersion& version) {
        if (version.requester() == client) use += version.bytes();
        return absl::OkStatus();
      }));
  if (more <= quotas.model_bytes - use) return absl::OkStatus();
  return QuotaExceeded(client, "bytes of models", quotas.model_bytes, use,
                       "delete versions that nobody needs (trainctl models "
                       "delete)");
}

absl::Status CheckStoredBytes(const Transaction& look, const Quotas& quotas,
                              absl::string_view client, int64_t more) {
  if (quotas.stored_bytes == 0) return absl::OkStatus();
  TACTUS_ASSIGN_OR_RETURN(const int64_t use, StoredBytes(look, client));
  if (more <= quotas.stored_bytes - use) return absl::OkStatus();
  return QuotaExceeded(client, "stored bytes", quotas.stored_bytes, use,
                       "finish uploads that wait, delete datasets that nobody "
                       "needs (trainctl datasets delete)");
}

absl::Status CheckDatasets(const Transaction& look, const Quotas& quotas,
                           absl::string_view client) {
  if (quotas.datasets == 0) return absl::OkStatus();
  TACTUS_ASSIGN_OR_RETURN(const int64_t use,
                          Count<v1::Dataset>(look, Table::kDatasets,
                                             [&](const v1::Dataset& dataset) {
                                               return dataset.requester() ==
                                                      client;
                                             }));
  if (use < quotas.datasets) return absl::OkStatus();
  return QuotaExceeded(client, "datasets", quotas.datasets, use,
                       "delete datasets that nobody needs (trainctl datasets "
                       "delete)");
}

absl::Status CheckUploads(const Transaction& look, const Quotas& quotas,
                          absl::string_view client) {
  if (quotas.open_uploads == 0) return absl::OkStatus();
  TACTUS_ASSIGN_OR_RETURN(
      const int64_t use,
      Count<v1::StoredUpload>(look, Table::kUploads,
                              [&](const v1::StoredUpload& upload) {
                                return upload.requester() == client &&
                                       upload.dataset_version().empty();
                              }));
  if (use < quotas.open_uploads) return absl::OkStatus();
  return QuotaExceeded(client, "unfinished uploads", quotas.open_uploads, use,
                       "finish those that wait; one without a write for seven "
                       "days is removed");
}

absl::Status CheckQueuedJobs(const Transaction& look, const Quotas& quotas,
                             absl::string_view client) {
  if (quotas.queued_jobs == 0) return absl::OkStatus();
  TACTUS_ASSIGN_OR_RETURN(
      const int64_t use,
      Count<v1::Operation>(look, Table::kOperations,
                           [&](const v1::Operation& job) {
                             return job.requester() == client &&
                                    job.state() == v1::Operation::STATE_QUEUED;
                           }));
  if (use < quotas.queued_jobs) return absl::OkStatus();
  return QuotaExceeded(client, "queued jobs", quotas.queued_jobs, use,
                       "wait until a job has begun, cancel one (trainctl jobs "
                       "cancel)");
}

}  // namespace tactus::internal::server
