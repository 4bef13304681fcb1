#include "server/ops/tls.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "grpcpp/security/tls_certificate_provider.h"
#include "grpcpp/security/tls_certificate_verifier.h"
#include "grpcpp/security/tls_credentials_options.h"

namespace tactus::internal::server {
namespace {

// The text of a PEM file whose blocks are labelled `kind`.
absl::StatusOr<std::string> ReadPem(const std::string& path,
                                    absl::string_view kind) {
  std::ifstream file(path);
  std::ostringstream text;
  // An empty file leaves nothing to insert, which sets the fail bit of `text`.
  if (!file || (file.peek() != EOF && !(text << file.rdbuf()))) {
    return IoError(Quoted(path), std::strerror(errno));
  }
  if (!absl::StrContains(text.str(), absl::StrCat(kind, "-----"))) {
    return IoError(Quoted(path), absl::StrCat("holds no PEM block ", kind));
  }
  return text.str();
}

}  // namespace

absl::StatusOr<TlsIdentity> ReadTlsIdentity(const std::string& certificate_path,
                                            const std::string& key_path) {
  TlsIdentity identity;
  TACTUS_ASSIGN_OR_RETURN(identity.certificate_chain,
                          ReadPem(certificate_path, "CERTIFICATE"));
  TACTUS_ASSIGN_OR_RETURN(identity.private_key,
                          ReadPem(key_path, "PRIVATE KEY"));
  return identity;
}

absl::StatusOr<std::string> ReadClientRoots(const std::string& path) {
  return ReadPem(path, "CERTIFICATE");
}

std::shared_ptr<grpc::ServerCredentials> TlsCredentials(
    const TlsIdentity& identity) {
  grpc::SslServerCredentialsOptions options(
      identity.client_roots.empty()
          ? GRPC_SSL_DONT_REQUEST_CLIENT_CERTIFICATE
          : GRPC_SSL_REQUEST_CLIENT_CERTIFICATE_AND_VERIFY);
  options.pem_root_certs = identity.client_roots;
  options.pem_key_cert_pairs.push_back(
      {identity.private_key, identity.certificate_chain});
  return grpc::SslServerCredentials(options);
}

absl::StatusOr<std::shared_ptr<grpc::ChannelCredentials>> ReadTlsRoots(
    const std::string& roots_path) {
  grpc::SslCredentialsOptions options;
  TACTUS_ASSIGN_OR_RETURN(options.pem_root_certs,
                          ReadPem(roots_path, "CERTIFICATE"));
  return grpc::SslCredentials(options);
}

absl::StatusOr<std::shared_ptr<grpc::ChannelCredentials>> ReadOwnCertificate(
    const std::string& certificate_path) {
  TACTUS_ASSIGN_OR_RETURN(const std::string certificate,
                          ReadPem(certificate_path, "CERTIFICATE"));
  grpc::experimental::TlsChannelCredentialsOptions options;
  options.set_certificate_provider(
      std::make_shared<grpc::experimental::StaticDataCertificateProvider>(
          certificate));
  options.watch_root_certs();
  options.set_verify_server_certs(true);
  options.set_check_call_host(false);
  options.set_certificate_verifier(
      std::make_shared<grpc::experimental::NoOpCertificateVerifier>());
  return grpc::experimental::TlsCredentials(options);
}

}  // namespace tactus::internal::server
