#include "client/stream/channel.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include "absl/strings/match.h"
#include "core/base/errors.h"
#include "grpcpp/create_channel.h"
#include "grpcpp/security/credentials.h"

namespace tactus::client {

std::shared_ptr<grpc::Channel> MakeChannel(const std::string& address,
                                           const ChannelOptions& options) {
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIME_MS, 20'000);
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, 10'000);
  arguments.SetInt(GRPC_ARG_HTTP2_MAX_PINGS_WITHOUT_DATA, 0);
  // As the server: no pings to find more bandwidth than frames need.
  arguments.SetInt(GRPC_ARG_HTTP2_BDP_PROBE, 0);
  if (!options.share_connection) {
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  }
  const bool plain =
      options.tls_roots.empty() || absl::StartsWith(address, "unix");
  return grpc::CreateCustomChannel(
      address,
      plain ? grpc::InsecureChannelCredentials()
            : grpc::SslCredentials({.pem_root_certs = options.tls_roots,
                                    .pem_private_key = "",
                                    .pem_cert_chain = ""}),
      arguments);
}

absl::StatusOr<std::string> ReadRootCertificates(const std::string& path) {
  if (path.empty()) return std::string();
  std::ifstream file(path);
  std::ostringstream text;
  if (!file || !(text << file.rdbuf())) {
    return IoError(path, std::strerror(errno));
  }
  return text.str();
}

}  // namespace tactus::client
