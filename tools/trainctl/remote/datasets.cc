// trainctl datasets: labelled trials on a server.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "client/training/trial_downloader.h"
#include "client/training/trial_uploader.h"
#include "core/base/bytes_text.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/sha256.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "core/data/trial_file.h"
#include "core/data/trial_id.h"
#include "core/data/trial_layout.h"
#include "core/import/odd_rates.h"
#include "tools/trainctl/command.h"
#include "tools/trainctl/progress_display.h"
#include "tools/trainctl/remote/dataset_text.h"
#include "tools/trainctl/remote/flags.h"
#include "tools/trainctl/remote/proto_json.h"
#include "tools/trainctl/text.h"

namespace tactus::internal::client {
namespace {

constexpr char kCollection[] = "datasets";

absl::Status Create(TrainingClient& client, const std::string& name,
                    const std::string& description, bool json) {
  TACTUS_ASSIGN_OR_RETURN(
      const v1::Dataset dataset,
      client.CreateDataset(FullName(kCollection, name), description));
  if (json) {
    PrintJson(ToJson(dataset));
  } else {
    std::cout << dataset.name() << "\n";
  }
  return absl::OkStatus();
}

// The same for a second upload of the same file to the same version, so that
// the server continues an upload that was interrupted. Another one if the file
// or the dataset has changed.
absl::StatusOr<std::string> UploadId(const v1::Dataset& dataset,
                                     const std::string& path,
                                     const UploadFlags& flags) {
  std::error_code error;
  const auto canonical = std::filesystem::canonical(path, error);
  if (error) return IoError(path, error.message());
  const auto size = std::filesystem::file_size(canonical, error);
  if (error) return IoError(path, error.message());
  const auto changed = std::filesystem::last_write_time(canonical, error);
  if (error) return IoError(path, error.message());
  return absl::StrCat(
      "trainctl-",
      Sha256Hex(absl::StrCat(
          dataset.name(), "\n", dataset.create_time_ms(), "\n",
          dataset.latest_version(), "\n", canonical.string(), "\n", size, "\n",
          changed.time_since_epoch().count(), "\n", flags.replace, "\n",
          flags.replace_labels, "\n", kVersion)));
}

// A trial without a valid id, or whose skin is not known, would be refused at
// the end of a long upload.
absl::Status CheckTrial(const Trial& trial) {
  if (const std::string fault = TrialIdFault(trial.id); !fault.empty()) {
    return InvalidTrial(absl::StrCat(
        "trial ", Quoted(trial.id), ": id: ", fault,
        "; `trainctl import FILE.h5 --out=NEW.h5` makes one and keeps the name "
        "as the trial's source"));
  }
  if (trial.taxels.empty()) return absl::OkStatus();
  return LayoutOfTrial(trial).status();
}

// What became of the trials that are not stored as they were sent.
std::string NotesText(const v1::FinishUploadResponse& made) {
  struct Group {
    v1::TrialNote::Kind kind;
    uint32_t count;
    const char* what;
  };
  const v1::DatasetVersion& version = made.version();
  uint32_t replaced = 0;
  for (const v1::TrialNote& note : made.notes()) {
    replaced += note.kind() == v1::TrialNote::KIND_REPLACED;
  }
  const Group groups[] = {
      {v1::TrialNote::KIND_DUPLICATE, version.duplicates(),
       "were there already and were left out"},
      {v1::TrialNote::KIND_REPLACED, std::max(replaced, version.relabelled()),
       "took the place of trials with the same frames"},
      {v1::TrialNote::KIND_RENAMED, version.renamed(),
       "got another id, because theirs named another recording"}};
  constexpr size_t kNamed = 5;
  std::string text;
  for (const Group& group : groups) {
    if (group.count == 0) continue;
    std::vector<std::string> names;
    for (const v1::TrialNote& note : made.notes()) {
      if (note.kind() != group.kind || names.size() == kNamed) continue;
      names.push_back(Printable(TrialName(note.id(), note.source())));
      if (!note.new_id().empty()) {
        absl::StrAppend(&names.back(), " is ", note.new_id());
      } else if (note.label() != note.other_label()) {
        absl::StrAppend(&names.back(), " (", Printable(note.label()), ", was ",
                        Printable(note.other_label()), ")");
      } else if (const std::string other =
                     Printable(TrialName(note.other_id(), note.other_source()));
                 other != names.back()) {
        absl::StrAppend(&names.back(), " (there as ", other, ")");
      }
    }
    if (group.count > names.size()) names.push_back("...");
    absl::StrAppendFormat(&text, "%s of the trials %s: %s\n",
                          WithCommas(static_cast<int>(group.count)), group.what,
                          absl::StrJoin(names, ", "));
  }
  return text;
}

}  // namespace

absl::Status UploadTrialFile(TrainingClient& client, const std::string& name,
                             const std::string& path, const UploadFlags& flags,
                             bool json) {
  TACTUS_ASSIGN_OR_RETURN(const TrialFileReader reader,
                          TrialFileReader::Open(path));
  TACTUS_ASSIGN_OR_RETURN(const v1::GetDatasetResponse found,
                          client.GetDataset(FullName(kCollection, name)));
  v1::CreateUploadRequest request;
  request.set_dataset(found.dataset().name());
  request.set_replace(flags.replace);
  request.set_replace_labels(flags.replace_labels);
  TACTUS_ASSIGN_OR_RETURN(*request.mutable_request_id(),
                          UploadId(found.dataset(), path, flags));
  ProgressDisplay display;
  const Progress progress = display.progress().Part("upload trials", 1);
  TrialUploader uploader(&client, {});
  size_t next = 0;
  OddRates rates;
  auto made =
      uploader.Upload(request, [&]() -> absl::StatusOr<std::optional<Trial>> {
        if (next == reader.size()) {
          display.Report("check trials", "");
          return std::nullopt;
        }
        TACTUS_ASSIGN_OR_RETURN(Trial trial, reader.Read(next++));
        TACTUS_RETURN_IF_ERROR(CheckTrial(trial));
        rates.Add(trial);
        progress.Add(1 / static_cast<double>(reader.size()));
        return trial;
      });
  display.Clear();
  if (!made.ok()) return Annotate(made.status(), path);
  RemarkRates(rates, path);
  if (json) {
    PrintJson(ToJson(*made));
  } else {
    std::cout << VersionText(made->version()) << NotesText(*made);
  }
  return absl::OkStatus();
}

namespace {

absl::Status ListDatasets(TrainingClient& client, bool json) {
  TACTUS_ASSIGN_OR_RETURN(const auto datasets, client.ListDatasets());
  if (json) {
    PrintJson(ArrayToJson(datasets));
    return absl::OkStatus();
  }
  for (const v1::Dataset& dataset : datasets) {
    std::cout << absl::StrFormat(
        "%s  version %d  %s  %s\n", dataset.name(), dataset.latest_version(),
        TimeText(dataset.create_time_ms()), dataset.description());
  }
  return absl::OkStatus();
}

struct ShowFlags {
  std::string name;
  bool trials = false;
  std::string label;
  std::string condition;
  std::string material;
};

// Who gave the label, and what was taken for true before.
std::string LabellingText(const v1::TrialInfo& trial) {
  if (!trial.has_labelling()) return "";
  const v1::Labelling& labelling = trial.labelling();
  return absl::StrFormat(
      "  %s by %s, %s, was %s%s",
      labelling.prefilled() ? "confirmed" : "labelled",
      Printable(labelling.by()), TimeText(labelling.time_ms()),
      Printable(labelling.before()),
      labelling.model_version().empty()
          ? ""
          : absl::StrFormat(" with %s by %s", Percent(labelling.confidence()),
                            Printable(labelling.model_version())));
}

absl::Status ShowTrials(TrainingClient& client, const ShowFlags& show,
                        bool json) {
  TACTUS_ASSIGN_OR_RETURN(
      const v1::DatasetVersion version,
      client.GetDatasetVersion(FullName(kCollection, show.name)));
  v1::ListTrialsRequest filter;
  filter.set_dataset_version(version.name());
  filter.set_label(show.label);
  filter.set_condition(show.condition);
  filter.set_material(show.material);
  TACTUS_ASSIGN_OR_RETURN(const auto trials, client.ListTrials(filter));
  if (json) {
    PrintJson({{"version", ToJson(version)}, {"trials", ArrayToJson(trials)}});
    return absl::OkStatus();
  }
  for (const v1::TrialInfo& trial : trials) {
    std::cout << absl::StrFormat(
        "%s  %-4s  %d frames  %s  %s  %s  %s  %s%s\n", trial.id(),
        trial.label(), trial.frames(), BytesText(trial.bytes()),
        trial.condition(), trial.material(), trial.layout(),
        Printable(trial.source()), LabellingText(trial));
  }
  return absl::OkStatus();
}

absl::Status ShowDataset(TrainingClient& client, const ShowFlags& show,
                         bool json) {
  const std::string name = FullName(kCollection, show.name);
  if (show.trials || !show.label.empty() || !show.condition.empty() ||
      !show.material.empty()) {
    return ShowTrials(client, show, json);
  }
  if (name.find("/versions/") != std::string::npos) {
    TACTUS_ASSIGN_OR_RETURN(const v1::DatasetVersion version,
                            client.GetDatasetVersion(name));
    if (json) {
      PrintJson(ToJson(version));
    } else {
      std::cout << VersionText(version) << OriginText(version) << "sha256 "
                << version.sha256() << "\n";
    }
    return absl::OkStatus();
  }
  TACTUS_ASSIGN_OR_RETURN(const v1::GetDatasetResponse dataset,
                          client.GetDataset(name));
  if (json) {
    PrintJson(ToJson(dataset));
    return absl::OkStatus();
  }
  std::cout << absl::StrFormat("%s  %s  %s\n", dataset.dataset().name(),
                               TimeText(dataset.dataset().create_time_ms()),
                               dataset.dataset().description());
  for (const v1::DatasetVersion& version : dataset.versions()) {
    std::cout << "  " << VersionText(version);
    if (const std::string origin = OriginText(version); !origin.empty()) {
      std::cout << "    " << origin;
    }
  }
  return absl::OkStatus();
}

// Trials by id and SHA-256: an id may be there twice.
using TrialsOf = std::map<std::pair<std::string, std::string>, v1::TrialInfo>;

absl::StatusOr<TrialsOf> AllTrials(TrainingClient& client,
                                   const std::string& name) {
  TACTUS_ASSIGN_OR_RETURN(
      const v1::DatasetVersion version,
      client.GetDatasetVersion(FullName(kCollection, name)));
  v1::ListTrialsRequest filter;
  filter.set_dataset_version(version.name());
  TACTUS_ASSIGN_OR_RETURN(const auto list, client.ListTrials(filter));
  TrialsOf trials;
  for (const v1::TrialInfo& trial : list) {
    trials[{trial.id(), trial.sha256()}] = trial;
  }
  return trials;
}

std::string LineOf(const v1::TrialInfo& trial) {
  return absl::StrCat(trial.id(), "  ", trial.label(),
                      trial.source().empty()
                          ? ""
                          : absl::StrCat("  ", Printable(trial.source())),
                      "\n");
}

std::vector<v1::TrialInfo> Without(const TrialsOf& from, const TrialsOf& what) {
  std::vector<v1::TrialInfo> rest;
  for (const auto& [key, trial] : from) {
    if (!what.contains(key)) rest.push_back(trial);
  }
  return rest;
}

absl::Status Diff(TrainingClient& client, const std::string& before,
                  const std::string& after, bool json) {
  TACTUS_ASSIGN_OR_RETURN(const TrialsOf old, AllTrials(client, before));
  TACTUS_ASSIGN_OR_RETURN(const TrialsOf now, AllTrials(client, after));
  const auto removed = Without(old, now);
  const auto added = Without(now, old);
  const size_t same = now.size() - added.size();
  if (json) {
    PrintJson({{"removed", ArrayToJson(removed)},
               {"added", ArrayToJson(added)},
               {"same", same}});
    return absl::OkStatus();
  }
  for (const v1::TrialInfo& trial : removed) {
    std::cout << "- " << LineOf(trial);
  }
  for (const v1::TrialInfo& trial : added) {
    std::cout << "+ " << LineOf(trial);
  }
  std::cout << absl::StrFormat("%d removed, %d added, %d the same\n",
                               removed.size(), added.size(), same);
  return absl::OkStatus();
}

absl::Status Download(TrainingClient& client, const std::string& name,
                      const std::string& path, bool overwrite, bool json) {
  TACTUS_ASSIGN_OR_RETURN(
      const v1::DatasetVersion version,
      client.GetDatasetVersion(FullName(kCollection, name)));
  TACTUS_ASSIGN_OR_RETURN(auto writer,
                          TrialFileWriter::Create(path, {overwrite}));
  ProgressDisplay display;
  const Progress progress = display.progress().Part("download trials", 1);
  // Release 0.1.0 stored ids that are repeated, or that no file can have.
  TrialIds ids;
  std::vector<std::string> renamed;
  TACTUS_ASSIGN_OR_RETURN(
      const DownloadTotals totals,
      DownloadTrials(client, version.name(),
                     [&](const Trial& trial) {
                       progress.Add(1 / static_cast<double>(version.trials()));
                       Trial named = trial;
                       named.id = ids.Unique(trial.id);
                       if (named.id != trial.id) {
                         if (named.source.empty()) named.source = trial.id;
                         renamed.push_back(absl::StrCat(Printable(trial.id),
                                                        " is ", named.id));
                       }
                       return writer.Append(named);
                     },
                     {}));
  if (totals.trials != version.trials()) {
    return InvalidResponse(
        "number of received trials", totals.trials,
        absl::StrCat(version.trials(), ", as ", version.name(), " has"));
  }
  TACTUS_RETURN_IF_ERROR(writer.Close());
  display.Clear();
  if (json) {
    PrintJson({{"version", ToJson(version)},
               {"file", path},
               {"renamed", renamed.size()}});
  } else {
    std::cout << absl::StrFormat("%s: %s trials of %s\n", path,
                                 WithCommas(version.trials()), version.name());
    if (!renamed.empty()) {
      std::cout << absl::StrFormat(
          "%s of the trials got another id, because theirs is repeated or not "
          "1 to %d letters, digits, - or _: %s\n",
          WithCommas(static_cast<int>(renamed.size())),
          limits::kMaxTrialIdBytes,
          absl::StrJoin(
              renamed.begin(),
              renamed.begin() + static_cast<ptrdiff_t>(std::min<size_t>(
                                    renamed.size(), limits::kMaxNamedTrials)),
              ", "));
    }
  }
  return absl::OkStatus();
}

absl::Status DeleteDataset(TrainingClient& client, const std::string& name,
                           bool json) {
  const std::string dataset = FullName(kCollection, name);
  TACTUS_ASSIGN_OR_RETURN(const uint32_t removed,
                          client.DeleteDataset(dataset));
  if (json) {
    PrintJson({{"deleted", dataset}, {"removed_trials", removed}});
  } else {
    std::cout << absl::StrFormat("%s deleted, %s trials removed from disk\n",
                                 dataset, WithCommas(removed));
  }
  return absl::OkStatus();
}

}  // namespace

void AddDatasets(CLI::App& app, const SelectCommand& select) {
  CLI::App& group =
      CommandGroup(app, kCollection, "Keep labelled trials on a server",
                   "upload arm --data=mine.h5");
  // The argument of most verbs.
  const auto name = [](CLI::App& command, const char* description) {
    auto value = std::make_shared<std::string>();
    command.add_option("dataset", *value, description)->required();
    return value;
  };
  {
    CLI::App& command =
        AddVerb(group, "create", "Make an empty dataset",
                "create arm --description='the left arm, in June'");
    auto dataset = name(command, "Name: 1 to 64 of a-z, 0-9 and -");
    auto description = std::make_shared<std::string>();
    command.add_option("--description", *description, "Free text for people");
    AddRemoteCommand(
        command, select, [=](TrainingClient& client, const RemoteFlags& flags) {
          return Create(client, *dataset, *description, flags.json);
        });
  }
  {
    CLI::App& command =
        AddVerb(group, "upload",
                "Send a trial file; the dataset gets a new version. An upload "
                "that was interrupted continues",
                "upload arm --data=trials.h5");
    auto dataset = name(command, "Dataset");
    auto data = std::make_shared<std::string>();
    auto upload = std::make_shared<UploadFlags>();
    command.add_option("--data", *data, "Trial file")->required();
    command.add_flag("--replace", upload->replace,
                     "The new version has these trials only, not those of the "
                     "version before");
    command.add_flag("--replace-labels", upload->replace_labels,
                     "Trials whose frames the dataset holds already take their "
                     "place, with their labels. Without it, the same frames "
                     "with another label are refused");
    AddRemoteCommand(
        command, select, [=](TrainingClient& client, const RemoteFlags& flags) {
          return UploadTrialFile(client, *dataset, *data, *upload, flags.json);
        });
  }
  {
    CLI::App& command = AddVerb(group, "list", "List the datasets", "list");
    AddRemoteCommand(command, select,
                     [=](TrainingClient& client, const RemoteFlags& flags) {
                       return ListDatasets(client, flags.json);
                     });
  }
  {
    CLI::App& command =
        AddVerb(group, "show", "Show the versions of a dataset, or its trials",
                "show arm@2 --label=HU");
    auto show = std::make_shared<ShowFlags>();
    command
        .add_option("dataset", show->name,
                    "Dataset, or one of its versions like arm@2")
        ->required();
    command.add_flag("--trials", show->trials, "List the trials");
    command.add_option("--label", show->label, "List trials with this label");
    command.add_option("--condition", show->condition,
                       "List trials with this condition");
    command.add_option("--material", show->material,
                       "List trials with this material");
    AddRemoteCommand(command, select,
                     [=](TrainingClient& client, const RemoteFlags& flags) {
                       return ShowDataset(client, *show, flags.json);
                     });
  }
  {
    CLI::App& command =
        AddVerb(group, "diff", "List the trials that one of two versions has",
                "diff arm@1 arm@2");
    auto before = std::make_shared<std::string>();
    auto after = std::make_shared<std::string>();
    command.add_option("before", *before, "Version")->required();
    command.add_option("after", *after, "Version")->required();
    AddRemoteCommand(command, select,
                     [=](TrainingClient& client, const RemoteFlags& flags) {
                       return Diff(client, *before, *after, flags.json);
                     });
  }
  {
    CLI::App& command =
        AddVerb(group, "download", "Write a version as a trial file",
                "download arm@2 --out=arm.h5");
    auto dataset = name(command, "Dataset, or a version like arm@2");
    auto out = std::make_shared<std::string>();
    auto overwrite = std::make_shared<bool>(false);
    command.add_option("--out", *out, "Trial file to write")->required();
    command.add_flag("--overwrite", *overwrite, "Replace an existing file");
    AddRemoteCommand(
        command, select, [=](TrainingClient& client, const RemoteFlags& flags) {
          return Download(client, *dataset, *out, *overwrite, flags.json);
        });
  }
  {
    CLI::App& command =
        AddVerb(group, "delete", "Delete a dataset with all its versions",
                "delete arm");
    auto dataset = name(command, "Dataset");
    AddRemoteCommand(command, select,
                     [=](TrainingClient& client, const RemoteFlags& flags) {
                       return DeleteDataset(client, *dataset, flags.json);
                     });
  }
}

}  // namespace tactus::internal::client
