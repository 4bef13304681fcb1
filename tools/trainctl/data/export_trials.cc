// trainctl trials export: writes the trials of a file for other programs.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>
#include <optional>
#include <set>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/data/trial_csv.h"
#include "core/data/trial_file.h"
#include "core/data/trial_npz.h"
#include "core/data/trial_zarr.h"
#include "core/files/draft_file.h"
#include "core/files/zarr.h"
#include "core/import/skin_folder_writer.h"
#include "tools/trainctl/command.h"
#include "tools/trainctl/progress_display.h"

namespace tactus::internal::client {
namespace {

namespace fs = std::filesystem;

struct ExportTrialsFlags {
  std::string data;
  std::string format;
  std::string out;
  std::vector<std::string> trials;
  bool json = false;
};

constexpr char kSignalFolder[] = "signals";

// Takes trials one at a time; Close() ends the work.
class Writer {
 public:
  static absl::StatusOr<Writer> Create(const ExportTrialsFlags& flags) {
    Writer writer(flags.format, flags.out);
    if (flags.format != "npz" && flags.format != "csv" &&
        flags.format != "zarr" && flags.format != "hdf5") {
      return InvalidConfig("--format", flags.format, "npz, csv, zarr or hdf5");
    }
    TACTUS_RETURN_IF_ERROR(MakeFolder(flags.out));
    if (flags.format == "hdf5") {
      TACTUS_ASSIGN_OR_RETURN(
          writer.hdf5_,
          TrialFileWriter::Create(fs::path(flags.out) / "trials.h5",
                                  {.overwrite = true}));
    }
    if (flags.format == "zarr") {
      TACTUS_RETURN_IF_ERROR(MakeZarrGroup(flags.out));
    }
    return writer;
  }

  absl::Status Write(const Trial& trial) {
    if (hdf5_) return hdf5_->Append(trial);
    if (format_ == "npz") {
      TACTUS_ASSIGN_OR_RETURN(const std::string bytes, TrialToNpz(trial));
      return WriteFileBytes(fs::path(out_) / (trial.id + ".npz"), bytes);
    }
    if (format_ == "zarr") {
      return TrialToZarr(trial, fs::path(out_) / trial.id);
    }
    return WriteCsv(trial);
  }

  absl::Status Close() {
    if (skin_folder_) return skin_folder_->Close();
    return hdf5_ ? hdf5_->Close() : absl::OkStatus();
  }

  // Says what was not written, or is not read again with the taxels; empty if
  // nothing.
  std::string LeftOut() const {
    std::vector<std::string> parts;
    for (const auto& [part, trials] : left_out_) {
      parts.push_back(absl::StrCat(part, " (", trials, " trials)"));
    }
    return absl::StrJoin(parts, ", ");
  }

 private:
  Writer(std::string format, std::string out)
      : format_(std::move(format)), out_(std::move(out)) {}

  // A folder of recordings of the skin, or files of signals if no trial has
  // taxels.
  absl::Status WriteCsv(const Trial& trial) {
    if (!trial.object_motion.empty()) ++left_out_["object_motion"];
    if (!skin_folder_ && trial.taxels.empty()) {
      if (!trial.poses.empty()) ++left_out_["poses"];
      has_signals_ = true;
      return WriteSignals(trial, out_);
    }
    if (has_signals_) {
      return TrialFileInvalid(
          "csv", absl::StrCat("trial ", trial.id,
                              ": taxels: the trials before it have none, and "
                              "one folder has the one or the other; choose by "
                              "--trial"));
    }
    if (!skin_folder_) {
      TACTUS_ASSIGN_OR_RETURN(skin_folder_, SkinFolderWriter::Create(out_));
    }
    TACTUS_RETURN_IF_ERROR(skin_folder_->Append(trial));
    if (trial.signals.empty()) return absl::OkStatus();
    ++left_out_["signals"];
    const fs::path folder = fs::path(out_) / kSignalFolder;
    TACTUS_RETURN_IF_ERROR(MakeFolder(folder));
    return WriteSignals(trial, folder);
  }

  static absl::Status WriteSignals(const Trial& trial, const fs::path& folder) {
    TACTUS_ASSIGN_OR_RETURN(const std::string table, SignalsToCsv(trial));
    return WriteFileBytes(folder / (trial.id + ".csv"), table);
  }

  std::string format_;
  std::string out_;
  std::optional<TrialFileWriter> hdf5_;
  std::optional<SkinFolderWriter> skin_folder_;
  // CSV files of trials without taxels were written.
  bool has_signals_ = false;
  // Parts that an import of the CSV files does not give back, and how many
  // trials have them.
  std::map<std::string, int> left_out_;
};

absl::Status RunExportTrials(const ExportTrialsFlags& flags) {
  TACTUS_ASSIGN_OR_RETURN(auto reader, TrialFileReader::Open(flags.data));
  std::set<std::string> wanted(flags.trials.begin(), flags.trials.end());
  const bool all = wanted.empty();
  TACTUS_ASSIGN_OR_RETURN(Writer writer, Writer::Create(flags));
  ProgressDisplay display;
  int64_t trials = 0;
  for (size_t i = 0; i < reader.size(); ++i) {
    if (!all && wanted.erase(reader.id(i)) == 0) continue;
    TACTUS_ASSIGN_OR_RETURN(const Trial trial, reader.Read(i));
    TACTUS_RETURN_IF_ERROR(writer.Write(trial));
    display.Count("export trials", ++trials);
  }
  display.Clear();
  if (!wanted.empty()) {
    return InvalidConfig("--trial", *wanted.begin(),
                         absl::StrCat("a trial of ", flags.data));
  }
  TACTUS_RETURN_IF_ERROR(writer.Close());
  if (const std::string left_out = writer.LeftOut(); !left_out.empty()) {
    std::cerr << "trainctl: an import of the CSV files does not give back "
              << left_out << "; npz, zarr and hdf5 hold all\n";
  }
  if (flags.json) {
    std::cout << JsonText(Json{{"out", flags.out}, {"trials", trials}}) << "\n";
  } else {
    std::cout << flags.out << ": " << trials << " trials\n";
  }
  return absl::OkStatus();
}

}  // namespace

void AddExportTrials(CLI::App& app, const SelectCommand& select) {
  auto flags = std::make_shared<ExportTrialsFlags>();
  CLI::App& group =
      CommandGroup(app, "trials", "Trials as files of other programs",
                   "export mine.h5 --format=npz --out=exported");
  CLI::App* command =
      &AddVerb(group, "export", "Write the trials of a file for other programs",
               "export mine.h5 --format=npz --out=exported");
  command->add_option("data", flags->data, "Trial file")->required();
  command
      ->add_option(
          "--format", flags->format,
          "npz (one file a trial), csv (a folder of recordings with its "
          "skin.json), zarr (one group a trial), or hdf5 (one trial file)")
      ->required();
  command->add_option("--out", flags->out, "Folder to write to")->required();
  command->add_option("--trial", flags->trials,
                      "Id of a trial to write; may be repeated. All without");
  command->add_flag("--json", flags->json, "Print one JSON object on stdout");
  command->callback([=] { select([=] { return RunExportTrials(*flags); }); });
}

}  // namespace tactus::internal::client
