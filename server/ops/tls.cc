#include "server/ops/tls.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include "absl/strings/match.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::server {
namespace {

absl::StatusOr<std::string> ReadText(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  if (!file || !(text << file.rdbuf())) {
    return IoError(path, std::strerror(errno));
  }
  return text.str();
}

}  // namespace

absl::StatusOr<TlsIdentity> ReadTlsIdentity(const std::string& certificate_path,
                                            const std::string& key_path) {
  TlsIdentity identity;
  TACTUS_ASSIGN_OR_RETURN(identity.certificate_chain,
                          ReadText(certificate_path));
  TACTUS_ASSIGN_OR_RETURN(identity.private_key, ReadText(key_path));
  return identity;
}

std::shared_ptr<grpc::ServerCredentials> CredentialsFor(
    const std::string& address, const TlsIdentity* identity) {
  if (identity == nullptr || absl::StartsWith(address, "unix")) {
    return grpc::InsecureServerCredentials();
  }
  grpc::SslServerCredentialsOptions options;
  options.pem_key_cert_pairs.push_back(
      {identity->private_key, identity->certificate_chain});
  return grpc::SslServerCredentials(options);
}

absl::StatusOr<std::shared_ptr<grpc::ChannelCredentials>> ReadTlsRoots(
    const std::string& roots_path) {
  if (roots_path.empty()) return grpc::InsecureChannelCredentials();
  grpc::SslCredentialsOptions options;
  TACTUS_ASSIGN_OR_RETURN(options.pem_root_certs, ReadText(roots_path));
  return grpc::SslCredentials(options);
}

}  // namespace tactus::server
