#include "tools/trainctl/remote/flags.h"

#include <random>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/string_view.h"
#include "core/base/address.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/base/version.h"
#include "tools/common/token_file.h"
#include "tools/trainctl/exit_code.h"

namespace tactus::internal::client {
namespace {

// What to do if nothing answered, by what gRPC says about it.
std::string AdviceOf(absl::string_view message, const RemoteFlags& flags) {
  const std::string text = absl::AsciiStrToLower(message);
  if (absl::StrContains(text, "certificate")) {
    return "the server's certificate was refused. Give the certificate of the "
           "authority that signed it with --tls-ca, and address the server by "
           "a "
           "name that its certificate has";
  }
  if (!flags.ca.empty() && (absl::StrContains(text, "ssl") ||
                            absl::StrContains(text, "handshake"))) {
    return "no TLS connection could be made. If the server uses no TLS, leave "
           "out --tls-ca; else give the certificate of the authority that "
           "signed "
           "the server's certificate";
  }
  if (flags.ca.empty() && (absl::StrContains(text, "socket closed") ||
                           absl::StrContains(text, "connection reset"))) {
    return "the server closed the connection. If it uses TLS, give the "
           "certificate of its authority with --tls-ca";
  }
  return "no server answered. Start one with tactusd --data-dir=FOLDER, or "
         "give the address of another with --server";
}

}  // namespace

void RemoteFlags::Add(CLI::App& command) {
  AddServer(command);
  command.add_flag("--json", json, "Print one JSON value on stdout");
}

void RemoteFlags::AddServer(CLI::App& command) {
  command.add_option("--server", server, "Server: host:port or unix:path")
      ->envname("TACTUS_SERVER");
  command
      .add_option("--tls-ca", ca,
                  "PEM file of the authorities that may vouch for the server; "
                  "with it, the connection uses TLS")
      ->envname("TACTUS_TLS_CA");
  command
      .add_option("--token-file", token_file,
                  "File with the token that the server knows you by")
      ->envname("TACTUS_TOKEN_FILE");
}

absl::StatusOr<std::unique_ptr<TrainingClient>> RemoteFlags::Connect() const {
  if (server.empty()) {
    return WithExitCode(
        InvalidConfig("--server", "absent",
                      "the address of a server, like 127.0.0.1:50051; the "
                      "variable TACTUS_SERVER may hold it too"),
        kExitUsage);
  }
  ChannelOptions options;
  TrainingClientOptions client;
  if (!ca.empty()) {
    TACTUS_ASSIGN_OR_RETURN(options.tls_roots, ReadRootCertificates(ca));
  }
  if (!token_file.empty()) {
    if (ca.empty() && !StaysOnThisHost(server)) {
      return WithExitCode(
          InvalidConfig("--token-file",
                        absl::StrCat("given without --tls-ca for ", server),
                        "given with --tls-ca: a token does not leave this host "
                        "unencrypted"),
          kExitUsage);
    }
    TACTUS_ASSIGN_OR_RETURN(client.token,
                            ReadToken(token_file, server, !ca.empty()));
  }
  return std::make_unique<TrainingClient>(MakeTrainingChannel(server, options),
                                          std::move(client));
}

absl::Status RemoteFlags::Explain(const absl::Status& status) const {
  const std::string reason = ReasonOf(status);
  if (status.code() == absl::StatusCode::kUnavailable && reason.empty()) {
    return Annotate(
        absl::UnavailableError(absl::StrCat(AdviceOf(status.message(), *this),
                                            " (", status.message(), ")")),
        server);
  }
  if (status.code() == absl::StatusCode::kUnimplemented) {
    return absl::UnimplementedError(absl::StrFormat(
        "%s: the server does not know this call. It is no Tactus server, or an "
        "older one than this trainctl, %s: install the same version on both",
        server, kVersion));
  }
  if (status.code() == absl::StatusCode::kUnauthenticated) {
    return Annotate(status,
                    absl::StrCat(server,
                                 ": the server does not know you. Give a file "
                                 "with a token with --token-file"));
  }
  return status;
}

absl::Status RunRemote(const RemoteFlags& flags, const RemoteWork& work) {
  TACTUS_ASSIGN_OR_RETURN(const auto client, flags.Connect());
  const absl::Status status = work(*client, flags);
  // A command that chose its exit code has said what happened.
  if (ExitCodeOf(status) != kExitError) return status;
  return flags.Explain(status);
}

void AddRemoteCommand(CLI::App& command, const SelectCommand& select,
                      RemoteWork work) {
  auto flags = std::make_shared<RemoteFlags>();
  flags->Add(command);
  command.callback([flags, select, work = std::move(work)] {
    select([flags, work] { return RunRemote(*flags, work); });
  });
}

std::string FullName(absl::string_view collection, absl::string_view text) {
  const std::string name = absl::StrReplaceAll(text, {{"@", "/versions/"}});
  if (absl::StartsWith(name, absl::StrCat(collection, "/"))) return name;
  return absl::StrCat(collection, "/", name);
}

std::string NewRequestId() {
  std::random_device random;
  return absl::StrFormat("trainctl-%08x%08x%08x%08x", random(), random(),
                         random(), random());
}

}  // namespace tactus::internal::client
