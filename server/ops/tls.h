// File: tls.h
//
// The server's certificate and key, for TLS on its host:port addresses.
//
//   TACTUS_ASSIGN_OR_RETURN(options.tls, ReadTlsIdentity("s.crt", "s.key"));
//
// Plain data and free functions; thread-safe.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "grpcpp/security/credentials.h"
#include "grpcpp/security/server_credentials.h"

namespace tactus::server {

struct TlsIdentity {
  // PEM: the server's certificate and those that vouch for it, in order.
  std::string certificate_chain;
  // PEM, without a pass phrase.
  std::string private_key;
};

// IO if a file cannot be read.
absl::StatusOr<TlsIdentity> ReadTlsIdentity(const std::string& certificate_path,
                                            const std::string& key_path);

// What an address is listened on with: TLS if there is an identity. Unix
// sockets are always plain: the file's permissions guard them.
std::shared_ptr<grpc::ServerCredentials> CredentialsFor(
    const std::string& address, const TlsIdentity* identity);

// What a client calls with: TLS checked against the PEM file of authorities at
// `roots_path`, plain if that is empty. IO if it cannot be read.
absl::StatusOr<std::shared_ptr<grpc::ChannelCredentials>> ReadTlsRoots(
    const std::string& roots_path);

}  // namespace tactus::server
