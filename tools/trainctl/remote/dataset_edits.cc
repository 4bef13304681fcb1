// trainctl datasets relabel, datasets remove: corrections of a dataset.
#include <iostream>

#include "client/training/retry.h"
#include "core/base/status_macros.h"
#include "tools/trainctl/remote/dataset_text.h"
#include "tools/trainctl/remote/flags.h"
#include "tools/trainctl/remote/proto_json.h"

namespace tactus::internal::client {
namespace {

struct EditFlags {
  std::string dataset;
  std::vector<std::string> trials;
  std::string from_label;
  std::string label;
  std::string reason;
  std::string request_id;
};

// Adds what both verbs take.
void AddEditFlags(CLI::App& command, EditFlags& flags) {
  command.add_option("dataset", flags.dataset, "Dataset")->required();
  command.add_option("trials", flags.trials,
                     "Trials, by id or by the name of the recording");
  command.add_option("--from-label", flags.from_label,
                     "Only trials with this label");
  command
      .add_option("--reason", flags.reason,
                  "Why; kept with the version and in the audit log")
      ->required();
  command.add_option("--request-id", flags.request_id,
                     "Names this change: a second one of the same name changes "
                     "nothing and shows the same version. Default: a new name");
}

// Fills in the fields that both requests have.
template <typename Request>
Request RequestOf(const EditFlags& flags) {
  Request request;
  request.set_dataset(FullName("datasets", flags.dataset));
  request.mutable_trials()->Assign(flags.trials.begin(), flags.trials.end());
  request.set_from_label(flags.from_label);
  request.set_reason(flags.reason);
  request.set_request_id(flags.request_id.empty() ? NewRequestId()
                                                  : flags.request_id);
  return request;
}

void Print(const v1::DatasetVersion& version, bool json) {
  if (json) {
    PrintJson(ToJson(version));
  } else {
    std::cout << VersionText(version) << OriginText(version);
  }
}

absl::Status Relabel(TrainingClient& client, const EditFlags& flags,
                     bool json) {
  auto request = RequestOf<v1::RelabelTrialsRequest>(flags);
  request.set_label(flags.label);
  TACTUS_ASSIGN_OR_RETURN(const v1::DatasetVersion version, Repeated({}, [&] {
                            return client.RelabelTrials(request);
                          }));
  Print(version, json);
  return absl::OkStatus();
}

absl::Status Remove(TrainingClient& client, const EditFlags& flags, bool json) {
  const auto request = RequestOf<v1::RemoveTrialsRequest>(flags);
  TACTUS_ASSIGN_OR_RETURN(const v1::DatasetVersion version, Repeated({}, [&] {
                            return client.RemoveTrials(request);
                          }));
  Print(version, json);
  return absl::OkStatus();
}

}  // namespace

void AddDatasetEdits(CLI::App& app, const SelectCommand& select) {
  CLI::App& group =
      CommandGroup(app, "datasets", "Keep labelled trials on a server",
                   "upload arm --data=mine.h5");
  {
    CLI::App& command = AddVerb(
        group, "relabel",
        "Give trials another label; the dataset gets a new version",
        "relabel arm pad_17.csv pad_18.csv --label=soft --reason='typo'");
    auto edit = std::make_shared<EditFlags>();
    AddEditFlags(command, *edit);
    command.add_option("--label", edit->label, "The new label")->required();
    AddRemoteCommand(command, select,
                     [=](TrainingClient& client, const RemoteFlags& flags) {
                       return Relabel(client, *edit, flags.json);
                     });
  }
  {
    CLI::App& command = AddVerb(
        group, "remove",
        "Leave trials out; the dataset gets a new version, older ones keep "
        "them",
        "remove arm pad_17.csv --reason='the skin was upside down'");
    auto edit = std::make_shared<EditFlags>();
    AddEditFlags(command, *edit);
    AddRemoteCommand(command, select,
                     [=](TrainingClient& client, const RemoteFlags& flags) {
                       return Remove(client, *edit, flags.json);
                     });
  }
}

}  // namespace tactus::internal::client
