#include "server/ops/peer.h"

#include <arpa/inet.h>

#include <cstring>

#include "absl/strings/match.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/strip.h"

namespace tactus::internal::server {

std::string PeerOfHost(absl::string_view host) {
  // "fe80::1%eth0": inet_pton takes no interface.
  const std::string address(host.substr(0, host.find('%')));
  in6_addr bytes = {};
  if (inet_pton(AF_INET6, address.c_str(), &bytes) != 1) {
    return std::string(host);
  }
  const uint8_t* octets = bytes.s6_addr;
  if (IN6_IS_ADDR_V4MAPPED(&bytes)) {
    return absl::StrFormat("%d.%d.%d.%d", octets[12], octets[13], octets[14],
                           octets[15]);
  }
  const auto group = [octets](int i) {
    return octets[2 * i] << 8 | octets[2 * i + 1];
  };
  return absl::StrFormat("%x:%x:%x:%x::/64", group(0), group(1), group(2),
                         group(3));
}

namespace {

// "[2001:db8::1]:50123" from "%5B2001:db8::1%5D:50123".
std::string Unescaped(absl::string_view address) {
  return absl::StrReplaceAll(address,
                             {{"%5B", "["}, {"%5D", "]"}, {"%25", "%"}});
}

}  // namespace

std::string PeerOf(absl::string_view address) {
  if (absl::StartsWith(address, "unix")) return "unix";
  if (absl::ConsumePrefix(&address, "ipv4:")) {
    return std::string(address.substr(0, address.rfind(':')));
  }
  if (absl::ConsumePrefix(&address, "ipv6:")) {
    const std::string plain = Unescaped(address);
    const size_t end = plain.find(']');
    if (end == std::string::npos || plain[0] != '[') return plain;
    return PeerOfHost(plain.substr(1, end - 1));
  }
  return std::string(address);
}

bool IsOnThisHost(absl::string_view address) {
  if (address == "inproc" || absl::StartsWith(address, "unix:") ||
      absl::StartsWith(address, "unix-abstract:")) {
    return true;
  }
  in_addr ipv4 = {};
  in6_addr ipv6 = {};
  const auto is_loopback = [&ipv4] { return ntohl(ipv4.s_addr) >> 24 == 127; };
  if (absl::StartsWith(address, "ipv4:")) {
    return inet_pton(AF_INET, PeerOf(address).c_str(), &ipv4) == 1 &&
           is_loopback();
  }
  if (!absl::ConsumePrefix(&address, "ipv6:")) return false;
  const std::string plain = Unescaped(address);
  const size_t end = plain.find("]:");
  if (end == std::string::npos || plain[0] != '[') return false;
  const std::string host = plain.substr(1, end - 1);
  if (inet_pton(AF_INET6, host.c_str(), &ipv6) != 1) return false;
  if (IN6_IS_ADDR_LOOPBACK(&ipv6)) return true;
  std::memcpy(&ipv4, &ipv6.s6_addr[12], sizeof(ipv4));
  return IN6_IS_ADDR_V4MAPPED(&ipv6) && is_loopback();
}

}  // namespace tactus::internal::server
