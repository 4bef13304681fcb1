#include "tools/common/vetted_servers.h"

#include <atomic>
#include <chrono>
#include <cstdio>
#include <string>

#include "core/connections/vetted_connections.h"

namespace tactus::internal::client {
namespace {

const char* program_name = "";

int64_t SteadyNs() {
  return std::chrono::steady_clock::now().time_since_epoch().count();
}

// A client that tries again meets the same fault again.
void ReportOnce(int, absl::string_view fault) {
  static std::atomic<bool> reported = false;
  if (reported.exchange(true)) return;
  std::fprintf(stderr, "%s: closed the connection to the server: %s\n",
               program_name, std::string(fault).c_str());
}

}  // namespace

void VetServers(const char* program) {
  program_name = program;
  VettedConnections::Start(
      {.connects = true, .now_ns = SteadyNs, .on_fault = ReportOnce});
}

}  // namespace tactus::internal::client
