// What the examples of public headers need around them. They only have to
// compile. The build takes each .inc from the comment of the header it names.
#include <memory>
#include <string>

#include "core/base/status_macros.h"
#include "core/postgres/live_replicas.h"
#include "core/postgres/pg_connection.h"
#include "core/postgres/postgres_catalog.h"
#include "core/store/locks.h"
#include "core/store/record_seal.h"
#include "server/ops/file_watch.h"
#include "server/replicas/replica.h"
#include "server/replicas/shared_locks.h"
#include "server/start_checks.h"

namespace tactus::internal::server::replicas_examples {

void LookAgain();
void LookForTheirJobs();
void TakeOver();
void Reload();

static absl::Status RecordSealExample(const std::string& key,
                                      std::string value) {
#include "core/store/record_seal.h.inc"
  return absl::OkStatus();
}

static absl::Status LocksExample(Locks* locks, Catalog& catalog) {
#include "core/store/locks.h.inc"
}

static absl::StatusOr<std::string> PgConnectionExample(
    const std::string& address, const std::string& key) {
#include "core/postgres/pg_connection.h.inc"
  return "";
}

static absl::Status PostgresCatalogExample() {
#include "core/postgres/postgres_catalog.h.inc"
  return absl::OkStatus();
}

void Print(const std::string& name);

static absl::Status LiveReplicasExample(
    const std::unique_ptr<Catalog>& catalog) {
#include "core/postgres/live_replicas.h.inc"
  return absl::OkStatus();
}

static absl::Status ReplicaExample(Catalog* catalog,
                                   const v1::StoredReplica& about,
                                   uint64_t change,
                                   std::chrono::milliseconds patience) {
#include "server/replicas/replica.h.inc"
  return absl::OkStatus();
}

static absl::Status SharedLocksExample(Catalog& catalog, Replica* replica) {
#include "server/replicas/shared_locks.h.inc"
  return absl::OkStatus();
}

static void FileWatchExample() {
#include "server/ops/file_watch.h.inc"
}

static void StartChecksExample(bool behind_proxy,
                               TactusServer::Options& options,
                               const TactusServer* server) {
#include "server/start_checks.h.inc"
}

}  // namespace tactus::internal::server::replicas_examples
