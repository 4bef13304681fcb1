#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>

#include "core/base/limits_catalog.h"
#include "core/postgres/pg_connection.h"
#include "core/postgres/postgres_catalog.h"

namespace tactus::internal {
namespace {

// A connection that is silent for so long is asked whether it is there: a
// database that hangs, or a network that was cut, says nothing.
constexpr std::chrono::milliseconds kLongestSilence(2'000);
constexpr int kPauseMs = 500;

}  // namespace

CatalogNews::CatalogNews(std::string address,
                         std::function<void(bool of_replicas)> on_news)
    : address_(std::move(address)), on_news_(std::move(on_news)) {
  // Programs that are started meanwhile must not keep it open.
  if (pipe2(stop_, O_CLOEXEC) != 0) return;
  thread_ = std::thread([this] { Listen(); });
}

CatalogNews::~CatalogNews() {
  if (!thread_.joinable()) return;
  close(stop_[1]);
  thread_.join();
  close(stop_[0]);
}

void CatalogNews::Listen() {
  const auto stops_within = [&](int ms) {
    pollfd state = {.fd = stop_[0], .events = POLLIN, .revents = 0};
    return poll(&state, 1, ms) > 0;
  };
  while (!stops_within(0)) {
    auto connection = PgConnection::Open(address_);
    if (!connection.ok() || !(*connection)->Run("LISTEN tactus").ok()) {
      if (stops_within(kPauseMs)) return;
      continue;
    }
    // What happened before is not told.
    on_news_(false);
    while ((*connection)->is_good() && !stops_within(0)) {
      const auto noticed =
          (*connection)->WaitForNotices(kLongestSilence, stop_[0]);
      if (!noticed.ok()) continue;
      if (!noticed->empty()) {
        on_news_(std::ranges::all_of(*noticed, [](const std::string& payload) {
          return payload == kNewsOfReplicas;
        }));
      } else {
        (*connection)->Run("SELECT 1").status().IgnoreError();
      }
    }
  }
}

}  // namespace tactus::internal
