#include "server/ops/peer.h"

#include <arpa/inet.h>

#include <cstdint>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/strip.h"

namespace tactus::server {
namespace {

// "[2001:db8::1]:50123" or "[fe80::1%eth0]:50123".
std::string NetworkOf(const std::string& address) {
  const size_t end = address.find_first_of("]%");
  if (end == std::string::npos || address[0] != '[') return address;
  const std::string host = address.substr(1, end - 1);
  in6_addr bytes = {};
  if (inet_pton(AF_INET6, host.c_str(), &bytes) != 1) return host;
  // An IPv4 address in IPv6 form is one host.
  if (IN6_IS_ADDR_V4MAPPED(&bytes)) return host;
  const auto group = [&bytes](int i) {
    return bytes.s6_addr[2 * i] << 8 | bytes.s6_addr[2 * i + 1];
  };
  return absl::StrFormat("%x:%x:%x:%x::/64", group(0), group(1), group(2),
                         group(3));
}

}  // namespace

std::string PeerOf(absl::string_view address) {
  if (absl::StartsWith(address, "unix")) return "unix";
  if (absl::ConsumePrefix(&address, "ipv4:")) {
    return std::string(address.substr(0, address.rfind(':')));
  }
  if (absl::ConsumePrefix(&address, "ipv6:")) {
    return NetworkOf(absl::StrReplaceAll(
        address, {{"%5B", "["}, {"%5D", "]"}, {"%25", "%"}}));
  }
  return std::string(address);
}

}  // namespace tactus::server
