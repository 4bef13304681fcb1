#include "client/training/admin_client.h"

#include <algorithm>
#include <utility>

#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"

namespace tactus::internal::client {
namespace {

constexpr int kAuditPageSize = 1'000;

}  // namespace

absl::StatusOr<v1::GetServerInfoResponse> AdminClient::GetServerInfo() {
  // A server may need some time to measure its data directory.
  const auto timeout = client_.long_timeout();
  const auto context = client_.NewContext(timeout);
  v1::GetServerInfoResponse response;
  const grpc::Status status =
      client_.admin().GetServerInfo(context.get(), {}, &response);
  if (!status.ok()) {
    return TrainingClient::ErrorOf(status, "GetServerInfo", timeout);
  }
  return response;
}

absl::StatusOr<std::vector<v1::AuditEntry>> AdminClient::ListAuditLog(
    v1::ListAuditLogRequest filter, size_t limit) {
  std::vector<v1::AuditEntry> entries;
  filter.set_page_size(
      static_cast<int32_t>(std::min<size_t>(limit, kAuditPageSize)));
  while (entries.size() < limit) {
    const auto context = client_.NewContext(client_.timeout());
    v1::ListAuditLogResponse response;
    const grpc::Status status =
        client_.admin().ListAuditLog(context.get(), filter, &response);
    if (!status.ok()) {
      return TrainingClient::ErrorOf(status, "ListAuditLog", client_.timeout());
    }
    for (v1::AuditEntry& entry : *response.mutable_entries()) {
      entries.push_back(std::move(entry));
    }
    const std::string& next = response.next_page_token();
    if (next.empty()) break;
    if (next == filter.page_token()) {
      return InvalidResponse("next_page_token", Quoted(next),
                             "another one than that of the request");
    }
    filter.set_page_token(next);
  }
  if (entries.size() > limit) entries.resize(limit);
  return entries;
}

absl::StatusOr<v1::DrainResponse> AdminClient::Drain() {
  const auto context = client_.NewContext(client_.timeout());
  v1::DrainResponse response;
  const grpc::Status status =
      client_.admin().Drain(context.get(), {}, &response);
  if (!status.ok()) {
    return TrainingClient::ErrorOf(status, "Drain", client_.timeout());
  }
  return response;
}

absl::StatusOr<AdminClient::JobLog> AdminClient::ReadOperationLog(
    const std::string& name) {
  v1::ReadOperationLogRequest request;
  request.set_name(name);
  const auto context = client_.NewContext(client_.timeout());
  const auto reader =
      client_.operations().ReadOperationLog(context.get(), request);
  JobLog log;
  v1::ReadOperationLogResponse part;
  while (reader->Read(&part)) {
    log.text += part.data();
    log.omitted_bytes += part.omitted_bytes();
    if (log.text.size() > static_cast<size_t>(limits::kMaxJobLogBytes)) {
      context->TryCancel();
      return InvalidResponse(
          "size of the log", "larger",
          absl::StrCat("at most ", limits::kMaxJobLogBytes, " bytes"));
    }
  }
  if (const grpc::Status status = reader->Finish(); !status.ok()) {
    return TrainingClient::ErrorOf(status, "ReadOperationLog",
                                   client_.timeout());
  }
  return log;
}

}  // namespace tactus::internal::client
