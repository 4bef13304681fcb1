#include "tools/trainctl/remote/shared_data.h"

#include <chrono>

#include "core/base/limits_catalog.h"
#include "core/postgres/live_replicas.h"
#include "core/postgres/postgres_catalog.h"

namespace tactus::internal::client {

CLI::Option* SharedDataFlags::Add(CLI::App& command,
                                  const std::string& catalog_flag,
                                  const std::string& blobs_flag) {
  CLI::Option* const address =
      command
          .add_option(catalog_flag, catalog,
                      "postgresql://... that tactusd got as --catalog; the "
                      "password is better in PGPASSFILE")
          ->check(CLI::Validator(
              [](const std::string& text) {
                return IsPostgresAddress(text)
                           ? std::string()
                           : std::string("must begin with postgresql://");
              },
              "ADDRESS"));
  CLI::Option* const folder = command.add_option(
      blobs_flag, blobs, "Folder that tactusd got as --blobs");
  address->needs(folder);
  folder->needs(address);
  return address;
}

absl::StatusOr<std::vector<std::string>> ServersAtWork(const Catalog& catalog) {
  return LiveReplicas(catalog,
                      std::chrono::milliseconds(limits::kReplicaDeadMs));
}

}  // namespace tactus::internal::client
