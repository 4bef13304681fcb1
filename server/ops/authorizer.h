// File: authorizer.h
//
// Authorizer: decides who makes a call and whether the caller may.
//
//   TACTUS_ASSIGN_OR_RETURN(auto authorizer, Authorizer::Open("tokens"));
//   options.authorizer = authorizer.get();
//   // ... after a change of the file ...
//   absl::Status status = authorizer->Reload();
//
// With a tokens file (core/access/access_table.h), every call needs a role: by
// a bearer token in the metadata `authorization`, or by a client certificate
// that TLS has verified. Without one, callers on the server's host may do
// everything, and callers on other hosts may only classify. Behind a proxy on
// the same host, all callers from other hosts come from a loopback address;
// only unix sockets and this process then count as the server's host.
//
// Calls are checked once, when they begin; a reload does not end calls that
// have begun. Refused credentials are logged at a limited rate, without the
// token.
//
// Thread-safe. A reload does not make calls wait: they use the old table until
// the new one is there.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/access/access_table.h"
#include "core/access/role.h"
#include "grpcpp/server_context.h"
#include "server/ops/log_limiter.h"
#include "server/records/caller.h"

namespace tactus::internal::server {

class Authorizer {
 public:
  // What a call says about its caller.
  struct Credentials {
    // As grpc::ServerContext::peer(); "inproc" for a call of this process.
    std::string peer;
    // All values of the metadata `authorization`.
    std::vector<std::string> authorization = {};
    // Common name of the client certificate that TLS has verified; empty: none.
    std::string certificate = {};
  };

  // Who calls from a loopback address.
  enum class Loopback { kThisHost, kProxy };

  // Without a tokens file.
  explicit Authorizer(Loopback loopback = Loopback::kThisHost)
      : loopback_(loopback) {}
  // IO or INVALID_CONFIG if the file cannot be read or is wrong.
  static absl::StatusOr<std::unique_ptr<Authorizer>> Open(
      const std::string& tokens_path);

  // Reads the file again. After an error the old table stays.
  absl::Status Reload();

  // The caller of `method` ("/tactus.v1.Service/Method"), which needs `role`.
  // UNAUTHENTICATED without a valid credential, PERMISSION_DENIED if the
  // caller's role is too low.
  absl::StatusOr<Caller> Authorize(const grpc::ServerContextBase& context,
                                   absl::string_view method, Role role) const;
  // The same for given credentials, without a line in the log.
  absl::StatusOr<Caller> Check(const Credentials& credentials,
                               absl::string_view method, Role role) const;

 private:
  // Whether the peer may do everything if there is no tokens file.
  bool IsTrusted(const std::string& peer) const;
  // Null without a tokens file.
  std::shared_ptr<const AccessTable> Table() const;

  const Loopback loopback_;
  std::string path_;
  // Guards the pointer, not what it points to.
  mutable std::mutex mutex_;
  std::shared_ptr<const AccessTable> table_;
  mutable LogLimiter log_{{.lines_per_second = 1, .burst = 20}};
};

}  // namespace tactus::internal::server
