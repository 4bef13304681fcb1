#include "tools/console/request_checks.h"

#include <poll.h>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/string_view.h"
#include "absl/strings/strip.h"
#include "core/base/address.h"
#include "tools/console/sign_ins.h"

namespace tactus::internal::console {
namespace {

absl::string_view HeaderOf(const Request& request, http::field field) {
  const auto value = request[field];
  return {value.data(), value.size()};
}

absl::string_view TargetOf(const Request& request) {
  const auto target = request.target();
  return {target.data(), target.size()};
}

}  // namespace

bool HasAllowedHost(const Request& request, bool is_loopback) {
  const absl::string_view host = HeaderOf(request, http::field::host);
  if (!is_loopback) return !host.empty();
  if (IsUnixAddress(host)) return false;
  // Without a port it is that of the scheme.
  return StaysOnThisHost(host) || StaysOnThisHost(absl::StrCat(host, ":80"));
}

bool IsOwnOrigin(const Request& request) {
  absl::string_view origin = HeaderOf(request, http::field::origin);
  if (!absl::ConsumePrefix(&origin, "https://") &&
      !absl::ConsumePrefix(&origin, "http://")) {
    return false;
  }
  return !origin.empty() && origin == HeaderOf(request, http::field::host);
}

bool HasOrigin(const Request& request) {
  return request.find(http::field::origin) != request.end();
}

absl::string_view PathOf(const Request& request) {
  const absl::string_view target = TargetOf(request);
  return target.substr(0, target.find('?'));
}

std::optional<std::string> WatchKeyOf(const Request& request) {
  const absl::string_view target = TargetOf(request);
  const size_t mark = target.find('?');
  if (mark == absl::string_view::npos) return std::nullopt;
  for (absl::string_view part : absl::StrSplit(target.substr(mark + 1), '&')) {
    if (absl::ConsumePrefix(&part, "key=")) return std::string(part);
  }
  return std::nullopt;
}

bool IsFromPage(const Request& request, absl::string_view csrf) {
  const auto given = request["X-CSRF-Token"];
  return IsOwnOrigin(request) && SameSecret({given.data(), given.size()}, csrf);
}

bool HasGone(int socket) {
  pollfd state = {.fd = socket, .events = POLLRDHUP, .revents = 0};
  return poll(&state, 1, 0) > 0;
}

std::string CookieOf(const Request& request) {
  for (absl::string_view part :
       absl::StrSplit(HeaderOf(request, http::field::cookie), ';')) {
    part = absl::StripAsciiWhitespace(part);
    if (absl::ConsumePrefix(&part, kCookieName) &&
        absl::ConsumePrefix(&part, "=")) {
      return std::string(part);
    }
  }
  return "";
}

}  // namespace tactus::internal::console
