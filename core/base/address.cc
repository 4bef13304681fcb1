#include "core/base/address.h"

#include <arpa/inet.h>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/strip.h"
#include "core/base/errors.h"
#include "core/base/text.h"

namespace tactus::internal {
namespace {

constexpr absl::string_view kUnixPrefix = "unix:";

}  // namespace

bool IsUnixAddress(absl::string_view address) {
  return absl::StartsWith(address, kUnixPrefix);
}

std::string UnixPath(absl::string_view address) {
  absl::string_view path = absl::StripPrefix(address, kUnixPrefix);
  if (absl::StartsWith(path, "///")) path.remove_prefix(2);
  return std::string(path);
}

absl::StatusOr<HostPort> ParseHostPort(absl::string_view address) {
  const absl::Status invalid =
      InvalidConfig("address", Quoted(address),
                    "host:port, [IPv6 address]:port or unix:path");
  const size_t colon = address.rfind(':');
  if (colon == address.npos) return invalid;
  absl::string_view host = address.substr(0, colon);
  const absl::string_view digits = address.substr(colon + 1);
  const bool bracketed =
      absl::ConsumePrefix(&host, "[") && absl::ConsumeSuffix(&host, "]");
  if (host.empty() || (!bracketed && absl::StrContains(host, ':'))) {
    return invalid;
  }
  uint32_t port = 0;
  if (!absl::SimpleAtoi(digits, &port) || port > 65'535) return invalid;
  return HostPort{std::string(host), static_cast<int>(port)};
}

bool StaysOnThisHost(absl::string_view address) {
  if (IsUnixAddress(address)) return true;
  const auto at = ParseHostPort(address);
  if (!at.ok()) return false;
  in_addr ipv4 = {};
  return at->host == "localhost" || at->host == "::1" ||
         (inet_pton(AF_INET, at->host.c_str(), &ipv4) == 1 &&
          ntohl(ipv4.s_addr) >> 24 == 127);
}

}  // namespace tactus::internal
