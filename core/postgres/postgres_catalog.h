// File: postgres_catalog.h
//
// PostgresCatalog: a Catalog in a database of PostgreSQL, which several servers
// share.
//
//   TACTUS_ASSIGN_OR_RETURN(auto catalog,
//                           OpenPostgresCatalog("postgresql://db/tactus"));
//   CatalogNews news("postgresql://db/tactus", [](bool of_replicas) {
//     if (!of_replicas) LookAgain();
//   });
//
// Transactions are serialisable: one that meets another one's changes runs
// again. If the connection is lost while a change commits, the database is
// asked whether it did. CATALOG_UNAVAILABLE if the database does not answer
// within limits::kCatalogChangeMs; the next transaction tries anew.
//
// The functions of several threads run side by side, on
// limits::kCatalogConnections connections.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/store/catalog.h"

namespace tactus::internal {

// The version of the schema that this program writes, and the oldest program's
// that may still use the schema.
inline constexpr int kPostgresVersion = 1;
inline constexpr int kOldestPostgresVersion = 1;

// True for addresses that PostgreSQL understands.
bool IsPostgresAddress(absl::string_view address);

// Connects, and makes the tables or brings them to kPostgresVersion. DATA_LOST
// if a newer release has changed them so that this one cannot use them.
absl::StatusOr<std::unique_ptr<Catalog>> OpenPostgresCatalog(
    const std::string& address);

// The same for a catalogue that is there already; the schema stays as it is.
// DATA_LOST if the database holds none, or one of another version.
absl::StatusOr<std::unique_ptr<Catalog>> OpenExistingPostgresCatalog(
    const std::string& address);

// The payload of a notification about what replicas say of themselves, and
// nothing else. With every server that serves a version, all others hear of it.
inline constexpr char kNewsOfReplicas[] = "replicas";

// Calls a function after each change, soon after it was made, and whenever
// changes may have been missed because the connection was lost. A thread of its
// own does it. `of_replicas`: only replicas have put records of themselves.
class CatalogNews {
 public:
  CatalogNews(std::string address,
              std::function<void(bool of_replicas)> on_news);
  // Waits for a call that is under way.
  ~CatalogNews();

  CatalogNews(const CatalogNews&) = delete;
  CatalogNews& operator=(const CatalogNews&) = delete;

 private:
  void Listen();

  const std::string address_;
  const std::function<void(bool)> on_news_;
  // A pipe that ends the wait.
  int stop_[2] = {-1, -1};
  std::thread thread_;
};

}  // namespace tactus::internal
