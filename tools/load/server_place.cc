#include "tools/load/server_place.h"

#include "absl/strings/str_cat.h"
#include "boost/asio/io_context.hpp"
#include "boost/asio/ip/tcp.hpp"
#include "boost/asio/local/stream_protocol.hpp"
#include "core/base/address.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::internal::client {
namespace {

namespace asio = boost::asio;

absl::StatusOr<std::shared_ptr<asio::ssl::context>> MakeTls(
    const std::string& roots) {
  auto tls =
      std::make_shared<asio::ssl::context>(asio::ssl::context::tls_client);
  boost::system::error_code error;
  tls->add_certificate_authority(asio::buffer(roots), error);
  if (error) {
    return InvalidConfig("certificate authorities", error.message(),
                         "certificates in PEM");
  }
  tls->set_verify_mode(asio::ssl::verify_peer);
  constexpr unsigned char kHttp2[] = {2, 'h', '2'};
  SSL_CTX_set_alpn_protos(tls->native_handle(), kHttp2, sizeof kHttp2);
  return tls;
}

}  // namespace

absl::StatusOr<ServerPlace> ServerPlace::Find(
    const std::string& address, const std::optional<std::string>& tls_roots) {
  ServerPlace place = {.address = address};
  if (IsUnixAddress(address)) {
    place.host = "localhost";
    const std::string path = UnixPath(address);
    constexpr size_t kMost = sizeof(sockaddr_un::sun_path) - 1;
    if (path.empty() || path.size() > kMost) {
      return InvalidConfig("path of a socket", path,
                           absl::StrCat("1 to ", kMost, " characters"));
    }
    place.endpoints.emplace_back(asio::local::stream_protocol::endpoint(path));
    return place;
  }
  TACTUS_ASSIGN_OR_RETURN(const HostPort at, ParseHostPort(address));
  place.host = at.host;
  if (tls_roots) {
    TACTUS_ASSIGN_OR_RETURN(place.tls, MakeTls(*tls_roots));
  }
  asio::io_context context;
  boost::system::error_code error;
  for (const auto& found : asio::ip::tcp::resolver(context).resolve(
           at.host, std::to_string(at.port), error)) {
    place.endpoints.emplace_back(found.endpoint());
  }
  if (error) {
    return absl::UnavailableError(absl::StrCat(address, ": ", error.message()));
  }
  return place;
}

}  // namespace tactus::internal::client
