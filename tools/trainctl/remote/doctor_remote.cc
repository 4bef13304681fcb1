#include "tools/trainctl/remote/doctor_remote.h"

#include <cstdlib>
#include <memory>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "client/training/admin_client.h"
#include "core/base/address.h"
#include "core/base/bytes_text.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/base/version.h"
#include "tools/trainctl/remote/tls_probe.h"
#include "tools/trainctl/text.h"

namespace tactus::internal::client {
namespace {

using Severity = CheckResult::Severity;

constexpr char kContract[] = "tactus.v1";
constexpr char kServedAlias[] = "aliases/default";
// A certificate that ends sooner is worth a warning.
constexpr int kFewDays = 30;
constexpr int64_t kClockToleranceMs = 5'000;
constexpr int64_t kLittleBytes = 1024L * 1024 * 1024;
constexpr int64_t kNoBytes = 64L * 1024 * 1024;

class ServerCheck {
 public:
  explicit ServerCheck(const RemoteFlags& flags) : flags_(flags) {}

  std::vector<CheckResult> Run() {
    CheckCertificate();
    auto client = flags_.Connect();
    if (!client.ok()) {
      Add("connection", Severity::kError, Message(client.status()));
    } else if (Ask(**client)) {
      CheckVersion();
      CheckClock();
      CheckDirectory();
      CheckDefault(**client);
    }
    return std::move(results_);
  }

 private:
  static std::string Message(const absl::Status& status) {
    return std::string(status.message());
  }
  void Add(const char* check, Severity severity, std::string text,
           std::string advice = "") {
    results_.push_back({check, severity, std::move(text), std::move(advice)});
  }

  void CheckCertificate() {
    if (flags_.ca.empty() || IsUnixAddress(flags_.server)) return;
    const auto roots = ReadRootCertificates(flags_.ca);
    if (!roots.ok()) {
      Add("certificate", Severity::kError, Message(roots.status()),
          "give the certificate of the server's authority with --tls-ca");
      return;
    }
    const auto probe = ProbeTls(flags_.server, *roots);
    if (!probe.ok()) {
      Add("certificate", Severity::kError, Message(probe.status()),
          "check the address; if the server uses no TLS, leave out --tls-ca");
    } else if (!probe->fault.empty()) {
      Add("certificate", Severity::kError, probe->fault,
          "give the authority that signed the server's certificate with "
          "--tls-ca, "
          "use a name that the certificate has, or renew it");
    } else if (probe->days_left < kFewDays) {
      Add("certificate", Severity::kWarning,
          absl::StrCat("ends in ", probe->days_left, " days"),
          "renew the server's certificate, then start the server again");
    } else {
      Add("certificate", Severity::kOk,
          absl::StrCat("valid for ", probe->days_left, " more days"));
    }
  }

  // Connection, credential and role. False if there is nothing more to ask.
  bool Ask(TrainingClient& client) {
    const auto begin = absl::Now();
    auto info = AdminClient(&client).GetServerInfo();
    const auto end = absl::Now();
    const std::string reason = ReasonOf(info.status());
    if (reason == "PERMISSION_DENIED") {
      Add("connection", Severity::kOk, "the server answers");
      const v1::ErrorInfo error = InfoOf(info.status());
      const auto role = error.metadata().find("role");
      Add("credential", Severity::kWarning,
          absl::StrCat("accepted, with the role ",
                       role == error.metadata().end() ? "?" : role->second),
          "the other checks need the role admin");
      CheckDefault(client);
      return false;
    }
    if (reason == "UNAUTHENTICATED") {
      Add("connection", Severity::kOk, "the server answers");
      Add("credential", Severity::kError, Message(info.status()),
          "give a file with a token that the server knows with --token-file");
      return false;
    }
    if (!info.ok()) {
      Add("connection", Severity::kError,
          Message(flags_.Explain(info.status())));
      return false;
    }
    info_ = *std::move(info);
    // The server read its clock somewhere in between.
    const int64_t middle = absl::ToUnixMillis(begin + (end - begin) / 2);
    clock_difference_ms_ = info_.time_ms() - middle;
    clock_doubt_ms_ = absl::ToInt64Milliseconds(end - begin) / 2;
    Add("connection", Severity::kOk, "the server answers");
    Add("credential", Severity::kOk,
        absl::StrCat("accepted as ", info_.caller(), ", with the role admin"));
    return true;
  }

  void CheckVersion() {
    const v1::VersionInfo& version = info_.version();
    if (version.api() != kContract) {
      Add("version", Severity::kError,
          absl::StrCat("the server speaks ", version.api(), ", this program ",
                       kContract),
          "install the same release on both");
    } else if (version.version() != kVersion) {
      Add("version", Severity::kWarning,
          absl::StrCat("the server has ", version.version(), ", this program ",
                       kVersion),
          "install the same release on both");
    } else {
      Add("version", Severity::kOk,
          absl::StrCat(version.version(), ", contract ", version.api()));
    }
  }

  void CheckClock() {
    const int64_t off = std::abs(clock_difference_ms_);
    const bool bad = off > kClockToleranceMs + clock_doubt_ms_;
    Add("clock", bad ? Severity::kWarning : Severity::kOk,
        absl::StrCat("the server's clock differs by ", clock_difference_ms_,
                     " ms"),
        bad ? "set the clocks, for example with NTP" : "");
  }

  void CheckDirectory() {
    if (!info_.has_data()) {
      Add("data directory", Severity::kWarning, "none: the server classifies",
          "start tactusd with --data-dir to train and to keep models");
      return;
    }
    const v1::DataUse& data = info_.data();
    const int64_t free = data.free_bytes();
    const Severity severity = free < kNoBytes       ? Severity::kError
                              : free < kLittleBytes ? Severity::kWarning
                                                    : Severity::kOk;
    const int64_t used = data.blob_bytes() + data.upload_bytes() +
                         data.job_bytes() + data.catalog_bytes();
    Add("data directory", severity,
        absl::StrCat(data.folder(), " uses ", BytesText(used), ", ",
                     BytesText(free), " are free"),
        severity == Severity::kOk
            ? ""
            : "delete datasets that nobody needs, or move the directory to a "
              "larger disk");
    if (info_.not_served().empty()) return;
    Add("stored models", Severity::kError,
        absl::StrJoin(info_.not_served(), "; "),
        "run trainctl doctor --data-dir on the server's host");
  }

  // A stream that names no model gets a version that the server has.
  void CheckDefault(TrainingClient& client) {
    const auto served = DefaultVersion(client);
    if (ReasonOf(served.status()) == "NO_DATA_DIRECTORY") {
      Add("default model", Severity::kOk, "the server's built-in model");
    } else if (!served.ok()) {
      Add("default model", Severity::kError,
          Message(flags_.Explain(served.status())),
          "promote a model to the alias default");
    } else {
      Add("default model", Severity::kOk, *served);
    }
  }

  absl::StatusOr<std::string> DefaultVersion(TrainingClient& client) const {
    TACTUS_ASSIGN_OR_RETURN(const auto aliases, client.ListAliases());
    std::string name = "models/default";
    for (const v1::Alias& alias : aliases) {
      if (alias.name() == kServedAlias) name = alias.model_version();
    }
    TACTUS_ASSIGN_OR_RETURN(const v1::ModelVersion version,
                            client.GetModelVersion(name));
    for (const std::string& failure : info_.not_served()) {
      if (absl::StartsWith(failure, absl::StrCat(version.name(), ":"))) {
        return absl::DataLossError(failure);
      }
    }
    return version.name();
  }

  const RemoteFlags& flags_;
  std::vector<CheckResult> results_;
  v1::GetServerInfoResponse info_;
  int64_t clock_difference_ms_ = 0;
  int64_t clock_doubt_ms_ = 0;
};

}  // namespace

std::vector<CheckResult> CheckServer(const RemoteFlags& flags) {
  return ServerCheck(flags).Run();
}

}  // namespace tactus::internal::client
