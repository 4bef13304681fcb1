// trainctl server: the state of a server, its audit log, its end.
#include <iostream>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/time/time.h"
#include "client/training/admin_client.h"
#include "core/base/bytes_text.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "tools/trainctl/remote/flags.h"
#include "tools/trainctl/remote/proto_json.h"
#include "tools/trainctl/text.h"

namespace tactus::internal::client {
namespace {

std::string LimitText(int64_t limit) {
  return limit == 0 ? "no limit" : absl::StrCat(limit);
}

void PrintData(const v1::GetServerInfoResponse& info) {
  const v1::DataUse& data = info.data();
  absl::PrintF("data directory  %s\n", Printable(data.folder()));
  absl::PrintF("  blobs         %s\n", BytesText(data.blob_bytes()));
  absl::PrintF("  uploads       %s\n", BytesText(data.upload_bytes()));
  absl::PrintF("  jobs          %s\n", BytesText(data.job_bytes()));
  absl::PrintF("  catalogue     %s\n", BytesText(data.catalog_bytes()));
  absl::PrintF("  free          %s\n", BytesText(data.free_bytes()));
  for (const v1::JobCount& jobs : info.jobs()) {
    const auto* state =
        v1::Operation::State_descriptor()->FindValueByNumber(jobs.state());
    absl::PrintF("jobs %-10s %d\n",
                 state == nullptr ? "unknown" : EnumText(*state), jobs.count());
  }
  const v1::Quotas& quotas = info.quotas();
  absl::PrintF("quotas of a client\n");
  absl::PrintF("  stored bytes  %s\n", quotas.stored_bytes() == 0
                                           ? "no limit"
                                           : BytesText(quotas.stored_bytes()));
  absl::PrintF("  datasets      %s\n", LimitText(quotas.datasets()));
  absl::PrintF("  queued jobs   %s\n", LimitText(quotas.queued_jobs()));
  absl::PrintF("  model bytes   %s\n", quotas.model_bytes() == 0
                                           ? "no limit"
                                           : BytesText(quotas.model_bytes()));
  absl::PrintF("  streams       %s\n", LimitText(quotas.streams()));
  for (const std::string& failure : info.not_served()) {
    absl::PrintF("not served      %s\n", Printable(failure));
  }
  for (const v1::Replica& replica : info.replicas()) {
    absl::PrintF("%-15s %s%s%s%s\n", Printable(replica.name()),
                 replica.address().empty()
                     ? "worker"
                     : absl::StrCat("server at ", Printable(replica.address())),
                 absl::StrCat(" on ", Printable(replica.host())),
                 replica.is_this() ? ", this one" : "",
                 !replica.alive()       ? ", silent"
                 : replica.up_to_date() ? ""
                                        : ", serves older models");
  }
}

absl::Status PrintInfo(TrainingClient& client, const RemoteFlags& flags) {
  TACTUS_ASSIGN_OR_RETURN(const auto info,
                          AdminClient(&client).GetServerInfo());
  if (flags.json) {
    PrintJson(ToJson(info));
    return absl::OkStatus();
  }
  absl::PrintF("version         %s\n", Printable(info.version().version()));
  absl::PrintF("started         %s, %s ago\n", TimeText(info.start_time_ms()),
               absl::FormatDuration(absl::Seconds(info.uptime_ms() / 1000)));
  absl::PrintF("streams         %d of %d\n", info.streams(),
               info.max_streams());
  if (info.has_data()) {
    PrintData(info);
  } else {
    absl::PrintF("no data directory\n");
  }
  return absl::OkStatus();
}

absl::Status PrintAudit(TrainingClient& client, const RemoteFlags& flags,
                        const v1::ListAuditLogRequest& filter, size_t limit) {
  TACTUS_ASSIGN_OR_RETURN(const auto entries,
                          AdminClient(&client).ListAuditLog(filter, limit));
  if (flags.json) {
    PrintJson(ArrayToJson(entries));
    return absl::OkStatus();
  }
  for (const v1::AuditEntry& entry : entries) {
    absl::PrintF("%s  %-9s %-32s %s  %s%s\n", TimeText(entry.time_ms()),
                 Printable(entry.verb()), Printable(entry.resource()),
                 Printable(entry.caller()), Printable(entry.peer()),
                 entry.reason().empty()
                     ? ""
                     : absl::StrCat("  ", Printable(entry.reason())));
  }
  return absl::OkStatus();
}

absl::Status Drain(TrainingClient& client, const RemoteFlags& flags) {
  TACTUS_ASSIGN_OR_RETURN(const auto response, AdminClient(&client).Drain());
  if (flags.json) {
    PrintJson(ToJson(response));
  } else {
    absl::PrintF("the server ends; %d open streams have %d ms to finish\n",
                 response.streams(), response.grace_ms());
  }
  return absl::OkStatus();
}

}  // namespace

void AddServer(CLI::App& app, const SelectCommand& select) {
  CLI::App& group = CommandGroup(
      app, "server", "See the state of a server and what was changed; end it",
      "info");
  CLI::App& info = AddVerb(
      group, "info", "Show version, streams, jobs, quotas and use of the disk",
      "info");
  AddRemoteCommand(info, select, PrintInfo);

  CLI::App& audit =
      AddVerb(group, "audit",
              "List who changed what, when and from where, newest first",
              "audit --resource=models/");
  auto filter = std::make_shared<v1::ListAuditLogRequest>();
  auto limit = std::make_shared<size_t>(100);
  audit.add_option("--resource", *filter->mutable_resource_prefix(),
                   "Only resources that begin with this, like models/");
  audit.add_option("--caller", *filter->mutable_caller(),
                   "Only changes of this caller");
  audit.add_option("--limit", *limit, "At most this many")
      ->capture_default_str();
  AddRemoteCommand(audit, select,
                   [=](TrainingClient& client, const RemoteFlags& flags) {
                     return PrintAudit(client, flags, *filter, *limit);
                   });

  CLI::App& drain = AddVerb(
      group, "drain",
      "End the server as SIGTERM does: new streams are refused, open ones get "
      "a notice and may finish, then the process ends",
      "drain");
  AddRemoteCommand(drain, select, Drain);
}

}  // namespace tactus::internal::client
