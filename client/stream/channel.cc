#include "client/stream/channel.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include "absl/strings/match.h"
#include "core/base/address.h"
#include "core/base/errors.h"
#include "core/base/text.h"
#include "grpcpp/create_channel.h"
#include "grpcpp/security/credentials.h"

namespace tactus::internal::client {

std::shared_ptr<grpc::Channel> MakeChannel(const std::string& address,
                                           const ChannelOptions& options) {
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIME_MS, 20'000);
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, 10'000);
  arguments.SetInt(GRPC_ARG_HTTP2_MAX_PINGS_WITHOUT_DATA, 0);
  // As the server: no pings to find more bandwidth than frames need.
  arguments.SetInt(GRPC_ARG_HTTP2_BDP_PROBE, 0);
  // As the server: no compression, because a small message can inflate to a
  // thousand times its size before anything compares it with a limit.
  arguments.SetInt(GRPC_COMPRESSION_CHANNEL_ENABLED_ALGORITHMS_BITSET,
                   1 << GRPC_COMPRESS_NONE);
  arguments.SetInt(GRPC_ARG_ENABLE_PER_MESSAGE_DECOMPRESSION, 0);
  // gRPC repeats a call by itself, at once and until its deadline, as long as
  // a server ends each new connection with GOAWAY. Ours wait between tries.
  arguments.SetInt(GRPC_ARG_ENABLE_RETRIES, 0);
  arguments.SetMaxReceiveMessageSize(options.max_receive_bytes);
  if (!options.share_connection) {
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  }
  if (!options.tls_roots || IsUnixAddress(address)) {
    return grpc::CreateCustomChannel(
        address, grpc::InsecureChannelCredentials(), arguments);
  }
  // gRPC takes an empty text for the system's authorities; ours holds none.
  return grpc::CreateCustomChannel(
      address,
      grpc::SslCredentials({.pem_root_certs = options.tls_roots->empty()
                                                  ? "no certificate"
                                                  : *options.tls_roots,
                            .pem_private_key = "",
                            .pem_cert_chain = ""}),
      arguments);
}

absl::StatusOr<std::string> ReadRootCertificates(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  // An empty file leaves nothing to insert, which sets the fail bit of `text`.
  if (!file || (file.peek() != EOF && !(text << file.rdbuf()))) {
    return IoError(Quoted(path), std::strerror(errno));
  }
  if (!absl::StrContains(text.str(), "-----BEGIN CERTIFICATE-----")) {
    return IoError(Quoted(path), "holds no PEM certificate");
  }
  return text.str();
}

}  // namespace tactus::internal::client
