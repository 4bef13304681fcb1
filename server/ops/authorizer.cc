#include "server/ops/authorizer.h"

#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/files/file_bytes.h"
#include "grpc/grpc_security_constants.h"
#include "server/ops/clock.h"
#include "server/ops/peer.h"
#include "spdlog/spdlog.h"

namespace tactus::internal::server {
namespace {

constexpr absl::string_view kClassification = "/tactus.v1.ContactService/";

absl::StatusOr<std::shared_ptr<const AccessTable>> ReadTable(
    const std::string& path) {
  TACTUS_ASSIGN_OR_RETURN(const std::string text,
                          ReadFileBytes(path, AccessTable::kMaxFileBytes));
  auto table = AccessTable::Parse(text);
  if (!table.ok()) return Annotate(table.status(), path);
  return std::make_shared<const AccessTable>(*std::move(table));
}

// The peer's address; "inproc" for a call of this process. gRPC 1.51 has no
// address for such a call, and, unlike for a connection, no security either.
std::string AddressOf(const grpc::ServerContextBase& context) {
  std::string peer = context.peer();
  if (peer != "unknown") return peer;
  const auto security = context.auth_context();
  const bool is_connection =
      security != nullptr &&
      !security->FindPropertyValues(GRPC_TRANSPORT_SECURITY_TYPE_PROPERTY_NAME)
           .empty();
  return is_connection ? peer : "inproc";
}

Authorizer::Credentials CredentialsOf(const grpc::ServerContextBase& context) {
  Authorizer::Credentials credentials = {.peer = AddressOf(context)};
  const auto [begin, end] =
      context.client_metadata().equal_range("authorization");
  for (auto it = begin; it != end; ++it) {
    credentials.authorization.emplace_back(it->second.data(),
                                           it->second.size());
  }
  if (const auto security = context.auth_context()) {
    const auto names = security->FindPropertyValues(GRPC_X509_CN_PROPERTY_NAME);
    if (names.size() == 1) {
      credentials.certificate.assign(names[0].data(), names[0].size());
    }
  }
  return credentials;
}

absl::Status NotLocal(absl::string_view method) {
  return Unauthenticated(absl::StrCat(
      method,
      " is open only to callers on the server's own host (with --behind-proxy: "
      "on a unix socket); for others, start tactusd with --tokens=FILE "
      "(trainctl tokens create makes the file)"));
}

// The entry of the credentials; UNAUTHENTICATED if there is none.
absl::StatusOr<const AccessTable::Entry*> FindEntry(
    const AccessTable& table, const Authorizer::Credentials& credentials,
    absl::string_view method) {
  if (credentials.authorization.empty()) {
    if (credentials.certificate.empty()) {
      return Unauthenticated(absl::StrCat(
          method,
          " needs a role, and the call has no credential; send the metadata "
          "\"authorization: Bearer TOKEN\" or use a client certificate"));
    }
    const auto* entry = table.FindCertificate(credentials.certificate);
    if (entry != nullptr) return entry;
    return Unauthenticated(absl::StrCat(
        "the certificate of ", Quoted(credentials.certificate),
        " has no role; add the line \"certificate NAME ROLE\" to the server's "
        "tokens file and send the server SIGHUP"));
  }
  // Never shown in the text: the token.
  absl::string_view token = credentials.authorization.front();
  constexpr absl::string_view kBearer = "bearer ";
  if (credentials.authorization.size() > 1 ||
      !absl::StartsWithIgnoreCase(token, kBearer)) {
    return Unauthenticated(
        "the metadata authorization must be one value, \"Bearer TOKEN\"");
  }
  token = absl::StripAsciiWhitespace(token.substr(kBearer.size()));
  if (const auto* entry = table.FindToken(token)) return entry;
  return Unauthenticated(
      "the server does not know the token; it may have been removed from the "
      "server's tokens file, or not been loaded yet: the server reads the file "
      "when it starts and on SIGHUP");
}

}  // namespace

absl::StatusOr<std::unique_ptr<Authorizer>> Authorizer::Open(
    const std::string& tokens_path) {
  auto authorizer = std::make_unique<Authorizer>();
  authorizer->path_ = tokens_path;
  TACTUS_RETURN_IF_ERROR(authorizer->Reload());
  return authorizer;
}

absl::Status Authorizer::Reload() {
  TACTUS_ASSIGN_OR_RETURN(auto table, ReadTable(path_));
  const std::lock_guard lock(mutex_);
  table_.swap(table);
  return absl::OkStatus();
}

bool Authorizer::IsTrusted(const std::string& peer) const {
  if (loopback_ == Loopback::kThisHost) return IsOnThisHost(peer);
  return peer == "inproc" || PeerOf(peer) == "unix";
}

std::shared_ptr<const AccessTable> Authorizer::Table() const {
  const std::lock_guard lock(mutex_);
  return table_;
}

absl::StatusOr<Caller> Authorizer::Authorize(
    const grpc::ServerContextBase& context, absl::string_view method,
    Role role) const {
  // Without tokens, only the peer counts.
  const Credentials credentials = Table() == nullptr
                                      ? Credentials{.peer = AddressOf(context)}
                                      : CredentialsOf(context);
  auto caller = Check(credentials, method, role);
  if (caller.ok()) return caller;
  if (const auto left_out = log_.Admit(MonotonicNs())) {
    spdlog::warn("refused {} of {}: {}{}", std::string(method),
                 credentials.peer, std::string(caller.status().message()),
                 LeftOut(*left_out));
  }
  return caller;
}

absl::StatusOr<Caller> Authorizer::Check(const Credentials& credentials,
                                         absl::string_view method,
                                         Role role) const {
  const auto table = Table();
  if (table == nullptr) {
    if (!absl::StartsWith(method, kClassification) &&
        !IsTrusted(credentials.peer)) {
      return NotLocal(method);
    }
    return Caller{.name = PeerOf(credentials.peer),
                  .peer = credentials.peer,
                  .role = Role::kAdmin};
  }
  TACTUS_ASSIGN_OR_RETURN(const AccessTable::Entry* entry,
                          FindEntry(*table, credentials, method));
  if (entry->role < role) {
    return PermissionDenied(method, RoleName(entry->role), RoleName(role));
  }
  return Caller{
      .name = entry->name, .peer = credentials.peer, .role = entry->role};
}

}  // namespace tactus::internal::server
