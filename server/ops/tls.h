// File: tls.h
//
// The server's certificate and key, for TLS on its host:port addresses.
//
//   TACTUS_ASSIGN_OR_RETURN(options.tls, ReadTlsIdentity("s.crt", "s.key"));
//
// Nothing here falls back to plaintext: an empty path or file is an error.
// Plain data and free functions; thread-safe.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "grpcpp/security/credentials.h"
#include "grpcpp/security/server_credentials.h"

namespace tactus::internal::server {

struct TlsIdentity {
  // PEM: the server's certificate and those that vouch for it, in order.
  std::string certificate_chain;
  // PEM, without a pass phrase.
  std::string private_key;
  // PEM of the authorities that may vouch for clients; empty: clients are not
  // asked for a certificate. A client may connect without one, but not with one
  // that is expired or that no authority vouches for.
  std::string client_roots = {};
};

// IO if a file cannot be read or holds no PEM block of the right kind.
absl::StatusOr<TlsIdentity> ReadTlsIdentity(const std::string& certificate_path,
                                            const std::string& key_path);

// TlsIdentity::client_roots from a file. IO as above.
absl::StatusOr<std::string> ReadClientRoots(const std::string& path);

// What a server speaks TLS with.
std::shared_ptr<grpc::ServerCredentials> TlsCredentials(
    const TlsIdentity& identity);

// What a client speaks TLS with, checked against the PEM file of authorities at
// `roots_path`. IO as above.
absl::StatusOr<std::shared_ptr<grpc::ChannelCredentials>> ReadTlsRoots(
    const std::string& roots_path);

// What the health check of a server on the same machine speaks TLS with: it
// accepts the certificates in the server's own `certificate_path` under
// whatever name it calls, for example localhost. IO as above.
absl::StatusOr<std::shared_ptr<grpc::ChannelCredentials>> ReadOwnCertificate(
    const std::string& certificate_path);

}  // namespace tactus::internal::server
