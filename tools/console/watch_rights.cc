#include "tools/console/watch_rights.h"

#include "tools/console/request_checks.h"

namespace tactus::internal::console {

bool IsLocalProgram(const Request& request, bool is_loopback) {
  return is_loopback && !HasOrigin(request) && !WatchKeyOf(request);
}

Doorkeeper::Person FindWatcher(const Request& request,
                               const Doorkeeper& doorkeeper, bool is_loopback) {
  if (const auto key = WatchKeyOf(request)) {
    return doorkeeper.FindByWatchKey(*key);
  }
  if (IsOwnOrigin(request)) return doorkeeper.Find(CookieOf(request));
  return IsLocalProgram(request, is_loopback) ? doorkeeper.Everybody()
                                              : nullptr;
}

}  // namespace tactus::internal::console
