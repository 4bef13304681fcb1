#include "core/postgres/live_replicas.h"

#include <algorithm>
#include <map>
#include <set>
#include <thread>

#include "absl/strings/str_cat.h"
#include "core/base/limits_catalog.h"
#include "core/base/status_macros.h"
#include "core/store/records.h"
#include "tactus/v1/storage.pb.h"

namespace tactus::internal {
namespace {

using SteadyClock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kLookAgain(100);
// By then, each that lives has given a sign.
constexpr milliseconds kSomeBeats(3 * limits::kReplicaBeatMs);

struct Registered {
  std::vector<v1::StoredReplica> replicas;
  // By name.
  std::map<std::string, std::string> beats;
};

absl::StatusOr<Registered> ReadRegistered(const Catalog& catalog) {
  Registered found;
  TACTUS_RETURN_IF_ERROR(
      catalog.Look([&](const Transaction& look) -> absl::Status {
        found = {};
        TACTUS_ASSIGN_OR_RETURN(
            found.replicas,
            ScanRecords<v1::StoredReplica>(look, Table::kReplicas, {}));
        TACTUS_ASSIGN_OR_RETURN(const auto beats, look.Scan(Table::kBeats, {}));
        for (const CatalogEntry& beat : beats) {
          found.beats[beat.key] = beat.value;
        }
        return absl::OkStatus();
      }));
  return found;
}

std::string Describe(const std::string& name, const Registered& registered) {
  for (const v1::StoredReplica& replica : registered.replicas) {
    if (replica.name() != name) continue;
    return absl::StrCat(
        name, " (", replica.host(), ", ",
        replica.address().empty() ? "a worker" : replica.address(), ")");
  }
  return name;
}

}  // namespace

absl::StatusOr<std::vector<std::string>> LiveReplicas(const Catalog& catalog,
                                                      milliseconds patience) {
  const SteadyClock::time_point begin = SteadyClock::now();
  TACTUS_ASSIGN_OR_RETURN(const Registered first, ReadRegistered(catalog));
  Registered now = first;
  std::set<std::string> live;
  while (!now.replicas.empty() || !now.beats.empty()) {
    for (const auto& [name, beat] : now.beats) {
      const auto before = first.beats.find(name);
      if (before == first.beats.end() || before->second != beat) {
        live.insert(name);
      }
    }
    const auto waited = SteadyClock::now() - begin;
    if (waited >= patience || (!live.empty() && waited >= kSomeBeats)) break;
    std::this_thread::sleep_for(kLookAgain);
    TACTUS_ASSIGN_OR_RETURN(now, ReadRegistered(catalog));
  }
  std::vector<std::string> described;
  for (const std::string& name : live) {
    // One that has ended meanwhile is at work no more.
    if (now.beats.contains(name)) described.push_back(Describe(name, now));
  }
  return described;
}

}  // namespace tactus::internal
