// trainctl models: model versions of a server, and the aliases under which they
// are served.
#include <cmath>
#include <iostream>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "client/training/retry.h"
#include "core/base/bytes_text.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/files/draft_file.h"
#include "core/files/file_bytes.h"
#include "tools/trainctl/exit_code.h"
#include "tools/trainctl/remote/flags.h"
#include "tools/trainctl/remote/job.h"
#include "tools/trainctl/remote/proto_json.h"
#include "tools/trainctl/text.h"

namespace tactus::internal::client {
namespace {

constexpr char kDefaultAlias[] = "default";

// "arm", "arm@3" or "aliases/robot", as the server knows them.
std::string ModelName(const std::string& text) {
  if (absl::StartsWith(text, "aliases/")) return text;
  return FullName("models", text);
}

std::string VersionLine(const v1::ModelVersion& version) {
  // The server states neither time nor size of those that it brings along.
  const std::string made =
      version.built_in() ? "built in"
                         : absl::StrCat(TimeText(version.create_time_ms()),
                                        "  ", BytesText(version.bytes()));
  std::string line = absl::StrFormat("%s  %s  %s", version.name(), made,
                                     absl::StrJoin(version.class_names(), ","));
  if (version.has_train()) {
    absl::StrAppend(&line, "  ", version.train().preset(), " on ",
                    version.train().dataset_version());
  }
  for (const std::string& alias : version.aliases()) {
    absl::StrAppend(&line, "  <- ", alias);
  }
  return line + "\n";
}

std::string AliasText(const v1::Alias& alias) {
  std::string text =
      absl::StrFormat("%s -> %s", alias.name(), alias.model_version());
  if (!alias.previous_version().empty()) {
    absl::StrAppend(&text, ", before ", alias.previous_version());
  }
  text += "\n";
  if (alias.has_canary()) {
    absl::StrAppendFormat(&text, "  canary: %s for %.1f %% of the robots\n",
                          alias.canary().model_version(),
                          0.1 * alias.canary().per_mille());
  }
  if (!alias.shadow_version().empty()) {
    absl::StrAppend(&text, "  shadow: ", alias.shadow_version(), "\n");
  }
  if (alias.has_gate()) {
    absl::StrAppendFormat(
        &text,
        "  gate: on %s; margins: accuracy %g, log-loss %g, calibration error "
        "%g\n",
        alias.gate().dataset_version(), alias.gate().accuracy_margin(),
        alias.gate().log_loss_margin(), alias.gate().calibration_margin());
  }
  return text;
}

void PrintAlias(const v1::Alias& alias, bool json) {
  if (json) {
    PrintJson(ToJson(alias));
  } else {
    std::cout << AliasText(alias);
  }
}

absl::Status ListModels(TrainingClient& client, const std::string& model,
                        bool json) {
  TACTUS_ASSIGN_OR_RETURN(
      const auto versions,
      client.ListModelVersions(model.empty() ? "" : FullName("models", model)));
  if (json) {
    PrintJson(ArrayToJson(versions));
    return absl::OkStatus();
  }
  for (const v1::ModelVersion& version : versions) {
    std::cout << VersionLine(version);
  }
  return absl::OkStatus();
}

absl::Status ShowModel(TrainingClient& client, const std::string& model,
                       bool json) {
  TACTUS_ASSIGN_OR_RETURN(const v1::ModelVersion version,
                          client.GetModelVersion(ModelName(model)));
  std::cout << JsonText(ToJson(version), json ? -1 : 2) << "\n";
  return absl::OkStatus();
}

struct PromoteFlags {
  std::string model;
  std::string alias = kDefaultAlias;
  std::string etag;
  bool force = false;
  bool detach = false;
};

absl::Status Promote(TrainingClient& client, const RemoteFlags& remote,
                     const PromoteFlags& flags) {
  TACTUS_ASSIGN_OR_RETURN(const v1::ModelVersion version,
                          client.GetModelVersion(ModelName(flags.model)));
  v1::PromoteModelRequest request;
  v1::PromoteSpec& spec = *request.mutable_spec();
  spec.set_alias(FullName("aliases", flags.alias));
  spec.set_model_version(version.name());
  spec.set_etag(flags.etag);
  spec.set_force(flags.force);
  request.set_request_id(NewRequestId());
  TACTUS_ASSIGN_OR_RETURN(const v1::Operation job, Repeated({}, [&] {
                            return client.PromoteModel(request);
                          }));
  if (!flags.detach) return FollowJob(client, remote, job);
  PrintJob(job, remote);
  return absl::OkStatus();
}

absl::Status History(TrainingClient& client, const std::string& alias,
                     bool json) {
  TACTUS_ASSIGN_OR_RETURN(const auto changes,
                          client.ListAliasHistory(FullName("aliases", alias)));
  if (json) {
    PrintJson(ArrayToJson(changes));
    return absl::OkStatus();
  }
  for (const v1::AliasChange& change : changes) {
    std::cout << absl::StrFormat("%s  %s  by %s%s%s\n",
                                 TimeText(change.time_ms()),
                                 change.model_version(), change.requester(),
                                 change.forced() ? "  gate overruled" : "",
                                 change.rollback() ? "  rollback" : "");
  }
  return absl::OkStatus();
}

struct AliasFlags {
  std::string alias;
  std::string etag;
  std::string canary;
  double canary_share = 0.1;
  bool no_canary = false;
  std::string shadow;
  bool no_shadow = false;
  std::string gate;
  double accuracy_margin = 0;
  double log_loss_margin = 0;
  double calibration_margin = 0;
  bool no_gate = false;

  bool Changes() const {
    return !canary.empty() || no_canary || !shadow.empty() || no_shadow ||
           !gate.empty() || no_gate;
  }
};

absl::StatusOr<v1::Alias> FindAlias(TrainingClient& client,
                                    const std::string& name) {
  TACTUS_ASSIGN_OR_RETURN(const auto aliases, client.ListAliases());
  for (const v1::Alias& alias : aliases) {
    if (alias.name() == name) return alias;
  }
  return NoSuch(v1::ERROR_REASON_ALIAS_NOT_FOUND, "alias", name,
                "trainctl models alias shows those that do");
}

absl::Status ShowAliases(TrainingClient& client, const AliasFlags& flags,
                         bool json) {
  if (!flags.alias.empty()) {
    TACTUS_ASSIGN_OR_RETURN(
        const v1::Alias alias,
        FindAlias(client, FullName("aliases", flags.alias)));
    PrintAlias(alias, json);
    return absl::OkStatus();
  }
  TACTUS_ASSIGN_OR_RETURN(const auto aliases, client.ListAliases());
  if (json) {
    PrintJson(ArrayToJson(aliases));
    return absl::OkStatus();
  }
  for (const v1::Alias& alias : aliases) std::cout << AliasText(alias);
  return absl::OkStatus();
}

absl::Status ChangeAlias(TrainingClient& client, const AliasFlags& flags,
                         bool json) {
  if (flags.alias.empty()) {
    return WithExitCode(InvalidConfig("alias", "absent", "the alias to change"),
                        kExitUsage);
  }
  v1::UpdateAliasRequest request;
  request.set_name(FullName("aliases", flags.alias));
  request.set_etag(flags.etag);
  // What the flags do not name stays as it is, as of the etag.
  if (const auto alias = FindAlias(client, request.name()); alias.ok()) {
    if (flags.etag.empty()) request.set_etag(alias->etag());
    if (alias->has_canary()) *request.mutable_canary() = alias->canary();
    if (alias->has_gate()) *request.mutable_gate() = alias->gate();
    request.set_shadow_version(alias->shadow_version());
  } else if (ReasonOf(alias.status()) != "ALIAS_NOT_FOUND") {
    return alias.status();
  }
  if (flags.no_canary) request.clear_canary();
  if (flags.no_shadow) request.clear_shadow_version();
  if (!flags.shadow.empty()) {
    TACTUS_ASSIGN_OR_RETURN(const v1::ModelVersion version,
                            client.GetModelVersion(ModelName(flags.shadow)));
    request.set_shadow_version(version.name());
  }
  if (flags.no_gate) request.clear_gate();
  if (!flags.canary.empty()) {
    TACTUS_ASSIGN_OR_RETURN(const v1::ModelVersion version,
                            client.GetModelVersion(ModelName(flags.canary)));
    request.mutable_canary()->set_model_version(version.name());
    request.mutable_canary()->set_per_mille(
        static_cast<uint32_t>(std::lround(1000 * flags.canary_share)));
  }
  if (!flags.gate.empty()) {
    TACTUS_ASSIGN_OR_RETURN(
        const v1::DatasetVersion version,
        client.GetDatasetVersion(FullName("datasets", flags.gate)));
    v1::PromotionGate& gate = *request.mutable_gate();
    gate.set_dataset_version(version.name());
    gate.set_accuracy_margin(flags.accuracy_margin);
    gate.set_log_loss_margin(flags.log_loss_margin);
    gate.set_calibration_margin(flags.calibration_margin);
  }
  TACTUS_ASSIGN_OR_RETURN(const v1::Alias changed, client.UpdateAlias(request));
  PrintAlias(changed, json);
  return absl::OkStatus();
}

absl::Status Export(TrainingClient& client, const std::string& model,
                    const std::string& path, bool json) {
  TACTUS_ASSIGN_OR_RETURN(const v1::ModelVersion version,
                          client.GetModelVersion(ModelName(model)));
  TACTUS_ASSIGN_OR_RETURN(const std::string bundle,
                          client.ExportModel(version.name()));
  TACTUS_RETURN_IF_ERROR(WriteFileBytes(path, bundle));
  if (json) {
    PrintJson({{"version", ToJson(version)}, {"file", path}});
  } else {
    std::cout << absl::StrFormat("%s: %s, %s\n", path, version.name(),
                                 BytesText(version.bytes()));
  }
  return absl::OkStatus();
}

absl::Status Import(TrainingClient& client, const std::string& model,
                    const std::string& path, bool json) {
  TACTUS_ASSIGN_OR_RETURN(const std::string bundle,
                          ReadFileBytes(path, limits::kMaxBundleBytes));
  TACTUS_ASSIGN_OR_RETURN(
      const v1::ModelVersion version,
      client.ImportModel(FullName("models", model), bundle));
  if (json) {
    PrintJson(ToJson(version));
  } else {
    std::cout << VersionLine(version);
  }
  return absl::OkStatus();
}

absl::Status DeleteModel(TrainingClient& client, const std::string& model,
                         bool json) {
  const std::string name = FullName("models", model);
  TACTUS_RETURN_IF_ERROR(client.DeleteModelVersion(name));
  if (json) {
    PrintJson({{"deleted", name}});
  } else {
    std::cout << name << " deleted\n";
  }
  return absl::OkStatus();
}

void AddAliasVerbs(CLI::App& group, const SelectCommand& select) {
  {
    CLI::App& command =
        AddVerb(group, "promote",
                "Let an alias name another version. If the alias has a gate, "
                "the version must pass it; exit code 5 if it does not",
                "promote arm@2 --alias=default");
    auto flags = std::make_shared<PromoteFlags>();
    command
        .add_option("model", flags->model,
                    "Version like arm@2, or a model for its newest version")
        ->required();
    command.add_option("--alias", flags->alias, "Alias")->capture_default_str();
    command.add_option("--etag", flags->etag,
                       "Refuse if the alias has another etag by now");
    command.add_flag("--force", flags->force,
                     "Overrule the gate; the history records it");
    command.add_flag("--detach", flags->detach,
                     "Return at once; the comparison runs on");
    AddRemoteCommand(command, select,
                     [=](TrainingClient& client, const RemoteFlags& remote) {
                       return Promote(client, remote, *flags);
                     });
  }
  {
    CLI::App& command = AddVerb(
        group, "rollback", "Let an alias name the version that it named before",
        "rollback");
    auto alias = std::make_shared<std::string>(kDefaultAlias);
    auto etag = std::make_shared<std::string>();
    command.add_option("alias", *alias, "Alias")->capture_default_str();
    command.add_option("--etag", *etag,
                       "Refuse if the alias has another etag by now");
    AddRemoteCommand(
        command, select,
        [=](TrainingClient& client, const RemoteFlags& flags) -> absl::Status {
          TACTUS_ASSIGN_OR_RETURN(
              const v1::Alias now,
              client.RollbackAlias(FullName("aliases", *alias), *etag));
          PrintAlias(now, flags.json);
          return absl::OkStatus();
        });
  }
  {
    CLI::App& command = AddVerb(
        group, "history", "List which version an alias named, when and by whom",
        "history default");
    auto alias = std::make_shared<std::string>(kDefaultAlias);
    command.add_option("alias", *alias, "Alias")->capture_default_str();
    AddRemoteCommand(command, select,
                     [=](TrainingClient& client, const RemoteFlags& flags) {
                       return History(client, *alias, flags.json);
                     });
  }
  CLI::App& command =
      AddVerb(group, "alias",
              "Show the aliases, or change what one demands of a new version "
              "and which robots get another version",
              "alias default --gate=arm@2 --accuracy-margin=0.005\n"
              "  trainctl models alias default --canary=arm@3 "
              "--canary-share=0.05");
  auto flags = std::make_shared<AliasFlags>();
  command.add_option("alias", flags->alias, "Alias");
  command.add_option("--etag", flags->etag,
                     "Refuse if the alias has another etag by now");
  CLI::Option* canary = command.add_option(
      "--canary", flags->canary, "Version that some of the robots get");
  command
      .add_option("--canary-share", flags->canary_share,
                  "Fraction of the robots that get it, by a hash of their id")
      ->check(CLI::Range(0.001, 1.0))
      ->needs(canary)
      ->capture_default_str();
  command.add_flag("--no-canary", flags->no_canary, "Remove the canary")
      ->excludes(canary);
  CLI::Option* shadow = command.add_option(
      "--shadow", flags->shadow,
      "Version that answers logged contacts once more; robots see nothing of "
      "it (trainctl contacts list --disagreeing)");
  command.add_flag("--no-shadow", flags->no_shadow, "Remove the shadow")
      ->excludes(shadow);
  CLI::Option* gate = command.add_option(
      "--gate", flags->gate,
      "Dataset version on which a new version must be as good as the present "
      "one");
  command
      .add_option("--accuracy-margin", flags->accuracy_margin,
                  "How much lower its accuracy may be")
      ->needs(gate);
  command
      .add_option("--log-loss-margin", flags->log_loss_margin,
                  "How much higher its log-loss may be")
      ->needs(gate);
  command
      .add_option("--calibration-margin", flags->calibration_margin,
                  "How much higher its calibration error may be")
      ->needs(gate);
  command.add_flag("--no-gate", flags->no_gate, "Remove the gate")
      ->excludes(gate);
  AddRemoteCommand(
      command, select, [=](TrainingClient& client, const RemoteFlags& remote) {
        return flags->Changes() ? ChangeAlias(client, *flags, remote.json)
                                : ShowAliases(client, *flags, remote.json);
      });
}

}  // namespace

void AddModels(CLI::App& app, const SelectCommand& select) {
  CLI::App& group =
      CommandGroup(app, "models", "Keep and serve models", "promote arm@3");
  {
    CLI::App& command =
        AddVerb(group, "list", "List model versions", "list arm");
    auto model = std::make_shared<std::string>();
    command.add_option("model", *model, "Only versions of this model");
    AddRemoteCommand(command, select,
                     [=](TrainingClient& client, const RemoteFlags& flags) {
                       return ListModels(client, *model, flags.json);
                     });
  }
  using Run = absl::Status (*)(TrainingClient&, const std::string&, bool);
  struct Verb {
    const char* name;
    const char* description;
    const char* argument;
    const char* example;
    Run run;
  };
  const Verb verbs[] = {
      {"show", "Show where a version comes from, as JSON",
       "Version like arm@2, model, or alias like aliases/default", "show arm@2",
       ShowModel},
      {"delete", "Delete a version that no alias and no history names",
       "Version like arm@2", "delete arm@2", DeleteModel}};
  for (const Verb& verb : verbs) {
    CLI::App& command =
        AddVerb(group, verb.name, verb.description, verb.example);
    auto model = std::make_shared<std::string>();
    command.add_option("model", *model, verb.argument)->required();
    AddRemoteCommand(command, select,
                     [model, run = verb.run](TrainingClient& client,
                                             const RemoteFlags& flags) {
                       return run(client, *model, flags.json);
                     });
  }
  AddAliasVerbs(group, select);
  {
    CLI::App& command =
        AddVerb(group, "export", "Write the bundle of a version to a file",
                "export arm@2 --out=arm.tactus");
    auto model = std::make_shared<std::string>();
    auto out = std::make_shared<std::string>();
    command
        .add_option("model", *model,
                    "Version like arm@2, model, or alias like aliases/default")
        ->required();
    command.add_option("--out", *out, "Bundle to write")->required();
    AddRemoteCommand(command, select,
                     [=](TrainingClient& client, const RemoteFlags& flags) {
                       return Export(client, *model, *out, flags.json);
                     });
  }
  {
    CLI::App& command =
        AddVerb(group, "import", "Make a bundle a new version of a model",
                "import arm --bundle=arm.tactus");
    auto model = std::make_shared<std::string>();
    auto bundle = std::make_shared<std::string>();
    command.add_option("model", *model, "Model; it may be new")->required();
    command.add_option("--bundle", *bundle, "Bundle to send")->required();
    AddRemoteCommand(command, select,
                     [=](TrainingClient& client, const RemoteFlags& flags) {
                       return Import(client, *model, *bundle, flags.json);
                     });
  }
}

}  // namespace tactus::internal::client
