#include "core/import/import.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <system_error>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/data/trial_file.h"
#include "core/data/trial_id.h"
#include "core/data/trial_npz.h"
#include "core/data/trial_zarr.h"
#include "core/files/csv.h"
#include "core/files/file_bytes.h"
#include "core/files/zarr.h"
#include "core/import/import_recording.h"
#include "core/import/import_skin_folder.h"
#include "core/import/odd_rates.h"
#include "core/import/rate_check.h"
#include "core/import/ros2/ros2_bag.h"
#include "core/import/skin_file.h"

namespace tactus::internal {
namespace {

namespace fs = std::filesystem;

constexpr std::array<absl::string_view, 4> kSignalColumns = {"time", "force",
                                                             "area", "motion"};

bool IsNpz(const fs::path& path) { return path.extension() == ".npz"; }

absl::StatusOr<std::vector<std::string>> TrialFiles(const std::string& folder) {
  std::vector<std::string> files;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end;
       it.increment(error)) {
    if (it->path().extension() == ".csv" || IsNpz(it->path())) {
      files.push_back(it->path());
    }
  }
  if (error) return IoError(folder, error.message());
  if (files.empty()) {
    return TrialFileInvalid(
        folder,
        "holds neither a skin.json nor CSV or .npz files of trials, and is no "
        "group of Zarr, version 2");
  }
  std::sort(files.begin(), files.end());
  return files;
}

// The rate of a file's times must be that which the file states.
absl::Status CheckTimes(const std::string& path, const Trial& trial) {
  const RateCheck check = CheckRate(trial.time, trial.sample_rate_hz);
  if (check.error.empty()) return absl::OkStatus();
  return TrialFileInvalid(
      path, absl::StrCat("trial ", TrialName(trial.id, trial.source),
                         ": sample_rate_hz ", check.error));
}

// One trial of a .npz file, whose name is the source unless the file has one;
// without the ending it becomes the id.
absl::StatusOr<Trial> ImportNpz(const std::string& path) {
  TACTUS_ASSIGN_OR_RETURN(const std::string bytes,
                          ReadFileBytes(path, limits::kMaxTrialArrayBytes));
  TACTUS_ASSIGN_OR_RETURN(Trial trial, TrialFromNpz(path, bytes));
  trial.id = fs::path(path).stem().string();
  if (trial.source.empty()) trial.source = fs::path(path).filename().string();
  TACTUS_RETURN_IF_ERROR(CheckTimes(path, trial));
  return trial;
}

absl::StatusOr<size_t> ImportFiles(const std::vector<std::string>& files,
                                   TrialSink sink) {
  for (size_t i = 0; i < files.size(); ++i) {
    TACTUS_ASSIGN_OR_RETURN(Trial trial, IsNpz(files[i])
                                             ? ImportNpz(files[i])
                                             : ImportSignalsCsv(files[i], i));
    TACTUS_RETURN_IF_ERROR(sink(std::move(trial)));
  }
  return files.size();
}

// One group of Zarr, whose name is the id.
absl::StatusOr<Trial> ImportZarrTrial(const fs::path& folder) {
  TACTUS_ASSIGN_OR_RETURN(Trial trial, TrialFromZarr(folder));
  trial.id = folder.filename().string();
  if (trial.source.empty()) trial.source = trial.id;
  TACTUS_RETURN_IF_ERROR(CheckTimes(folder, trial));
  return trial;
}

// A group that is a trial, or the groups in it.
absl::StatusOr<size_t> ImportZarr(const std::string& path, TrialSink sink) {
  fs::path folder(path);
  // "out/" has no name.
  if (!folder.has_filename()) folder = folder.parent_path();
  std::vector<fs::path> trials;
  if (IsZarrArray(folder / "time")) trials.push_back(folder);
  std::error_code error;
  if (trials.empty()) {
    for (fs::directory_iterator it(folder, error), end; !error && it != end;
         it.increment(error)) {
      if (IsZarrGroup(it->path())) trials.push_back(it->path());
    }
  }
  if (error) return IoError(path, error.message());
  if (trials.empty()) {
    return TrialFileInvalid(path, "is a group of Zarr without trials");
  }
  std::sort(trials.begin(), trials.end());
  for (const fs::path& one : trials) {
    TACTUS_ASSIGN_OR_RETURN(Trial trial, ImportZarrTrial(one));
    TACTUS_RETURN_IF_ERROR(sink(std::move(trial)));
  }
  return trials.size();
}

absl::Status SetMetadata(const std::string& path, const CsvTable& table,
                         Trial* trial) {
  const std::pair<absl::string_view, std::string*> texts[] = {
      {"source", &trial->source},       {"label", &trial->label},
      {"condition", &trial->condition}, {"object", &trial->object},
      {"material", &trial->material},   {"unit", &trial->unit},
  };
  const std::pair<absl::string_view, double*> numbers[] = {
      {"stiffness", &trial->stiffness},
      {"velocity", &trial->velocity},
      {"sample_rate_hz", &trial->sample_rate_hz},
  };
  for (const auto& [key, value] : table.metadata()) {
    bool known = false;
    for (const auto& [name, target] : texts) {
      if (key != name) continue;
      *target = value;
      known = true;
    }
    for (const auto& [name, target] : numbers) {
      if (key != name) continue;
      if (!ParseNumber(value, target)) {
        return TrialFileInvalid(path, absl::StrCat("# ", key, " is \"", value,
                                                   "\"; it must be a number"));
      }
      known = true;
    }
    if (!known) {
      return TrialFileInvalid(
          path, absl::StrCat("# ", key,
                             " is not known; use source, label, condition, "
                             "object, material, stiffness, velocity, "
                             "sample_rate_hz or unit"));
    }
  }
  return absl::OkStatus();
}

absl::Status RefuseOptions(const std::string& path,
                           const ImportOptions& options) {
  for (const std::string& file : {options.skin, options.table}) {
    if (file.empty()) continue;
    return InvalidConfig(
        "skin or table of the import", file,
        absl::StrCat("absent: ", path, " has no place for it"));
  }
  if (!options.file_names.empty()) {
    return InvalidConfig("pattern of file names", options.file_names,
                         "absent: only folders with a skin.json take one");
  }
  return absl::OkStatus();
}

// Trials as they are, or with another skin of the same shape.
absl::StatusOr<size_t> ImportTrialFile(const std::string& path,
                                       const ImportOptions& options,
                                       TrialSink sink) {
  if (!options.table.empty()) {
    return InvalidConfig("table of the import", options.table,
                         "absent: a trial file has its labels");
  }
  std::optional<SkinFile> skin;
  if (!options.skin.empty()) {
    TACTUS_ASSIGN_OR_RETURN(skin, ReadSkinFile(options.skin));
    if (skin->thresholds_from_idle) {
      return TrialFileInvalid(options.skin,
                              "thresholds: must be numbers for a trial file");
    }
  }
  TACTUS_ASSIGN_OR_RETURN(const auto reader, TrialFileReader::Open(path));
  OddRates rates;
  for (size_t i = 0; i < reader.size(); ++i) {
    TACTUS_ASSIGN_OR_RETURN(Trial trial, reader.Read(i));
    TACTUS_RETURN_IF_ERROR(CheckTimes(path, trial));
    rates.Add(trial);
    if (skin && !trial.taxels.empty()) {
      SetSkin(skin->layout, trial);
      TACTUS_RETURN_IF_ERROR(Validate(trial, path));
    }
    TACTUS_RETURN_IF_ERROR(sink(std::move(trial)));
  }
  if (options.remark && !rates.empty()) options.remark(rates.Remark());
  return reader.size();
}

}  // namespace

absl::StatusOr<Trial> ImportSignalsCsv(const std::string& path, size_t number) {
  TACTUS_ASSIGN_OR_RETURN(const CsvTable table, CsvTable::Read(path));
  if (!std::equal(table.header().begin(), table.header().end(),
                  kSignalColumns.begin(), kSignalColumns.end())) {
    return TrialFileInvalid(
        path,
        absl::StrCat("has the header \"", absl::StrJoin(table.header(), ","),
                     "\"; it must be ", absl::StrJoin(kSignalColumns, ","),
                     ". If these are taxels, describe the skin in a skin.json "
                     "beside them (docs/your-own-skin.md)"));
  }
  Trial trial;
  trial.id = absl::StrFormat("%06d", number);
  trial.source = fs::path(path).filename().string();
  for (size_t row = 0; row < table.rows(); ++row) {
    std::array<double, 4> values;
    for (size_t column = 0; column < values.size(); ++column) {
      TACTUS_ASSIGN_OR_RETURN(values[column], table.Number(row, column));
    }
    if (row > 0 && values[0] <= trial.time.back()) {
      return table.RowError(row, "time must be above the one before");
    }
    trial.time.push_back(values[0]);
    trial.signals.push_back({values[1], values[2], values[3]});
  }
  if (trial.time.size() > 1) {
    trial.sample_rate_hz = static_cast<double>(trial.time.size() - 1) /
                           (trial.time.back() - trial.time.front());
  }
  TACTUS_RETURN_IF_ERROR(SetMetadata(path, table, &trial));
  TACTUS_RETURN_IF_ERROR(Validate(trial, path));
  TACTUS_RETURN_IF_ERROR(CheckTimes(path, trial));
  return trial;
}

namespace {

absl::Status MappingIsAbsent(const std::string& path, absl::string_view what,
                             const std::string& bag) {
  return InvalidConfig("mapping of the import", "absent",
                       absl::StrCat("a skin.json that names a topic, because ",
                                    path, " ", what, "; trainctl import ", bag,
                                    " --list prints one to start from"));
}

// A bag of ROS 2 as one trial, or a folder of bags.
absl::StatusOr<size_t> ImportBags(const std::string& path, TrialSink sink,
                                  const ImportOptions& options) {
  ImportOptions with_skin = options;
  if (with_skin.skin.empty()) with_skin.skin = options.mapping;
  if (!options.table.empty() || !options.file_names.empty()) {
    return ImportSkinFolder(path, with_skin, sink);
  }
  const fs::path inside = fs::path(path) / "skin.json";
  std::error_code error;
  if (with_skin.skin.empty() && fs::exists(inside, error)) {
    with_skin.skin = inside;
  }
  if (with_skin.skin.empty()) {
    return MappingIsAbsent(path, "is a bag of ROS 2", path);
  }
  if (!IsRos2Bag(path) && !FirstBagIn(path).empty()) {
    return InvalidConfig(
        "table of the import", "absent",
        absl::StrCat("one that names bags and their labels, because ", path,
                     " is a folder of bags; or their names say it: "
                     "--file-names='{label}_{}/{}.mcap'"));
  }
  if (options.label.empty()) {
    return InvalidConfig("label of the import", "absent",
                         absl::StrCat("the class of the trial, because ", path,
                                      " is one bag and does not say it"));
  }
  fs::path bag(path);
  // "run1/" has no name.
  if (!bag.has_filename()) bag = bag.parent_path();
  return ImportSkinFolder(bag.has_parent_path() ? bag.parent_path() : ".",
                          with_skin, sink, bag.filename());
}

absl::StatusOr<size_t> ImportFrom(const std::string& path, TrialSink sink,
                                  const ImportOptions& options) {
  std::error_code error;
  if (!options.mapping.empty() && !options.skin.empty()) {
    return InvalidConfig("mapping of the import", options.mapping,
                         "absent: a skin.json is given");
  }
  const bool in_folder = !options.table.empty() || !options.file_names.empty();
  if (!options.mapping.empty() || (!in_folder && IsRos2Bag(path))) {
    return ImportBags(path, sink, options);
  }
  if (fs::is_directory(path, error)) {
    if (!options.skin.empty() || fs::exists(fs::path(path) / "skin.json")) {
      return ImportSkinFolder(path, options, sink);
    }
    if (const std::string bag = FirstBagIn(path); !bag.empty()) {
      return MappingIsAbsent(path, "holds bags of ROS 2", bag);
    }
    TACTUS_RETURN_IF_ERROR(RefuseOptions(path, options));
    if (IsZarrGroup(path)) return ImportZarr(path, sink);
    TACTUS_ASSIGN_OR_RETURN(const auto files, TrialFiles(path));
    return ImportFiles(files, sink);
  }
  if (absl::EndsWith(path, ".h5")) {
    return ImportTrialFile(path, options, sink);
  }
  if (absl::EndsWith(path, ".mcap")) {
    return ImportRecording(path, options, sink);
  }
  TACTUS_RETURN_IF_ERROR(RefuseOptions(path, options));
  if (absl::EndsWith(path, ".json")) {
    ImportOptions with_skin = options;
    with_skin.skin = path;
    return ImportSkinFolder(fs::path(path).parent_path(), with_skin, sink);
  }
  return ImportFiles({path}, sink);
}

}  // namespace

void NameUnnamed(const ImportOptions& options, Trial& trial) {
  // The first of several contacts has the names of its trial.
  if (!trial.touches.empty()) return;
  if (trial.label.empty()) trial.label = options.label;
  if (trial.condition.empty()) trial.condition = options.condition;
}

absl::StatusOr<size_t> ImportTrials(const std::string& path, TrialSink sink,
                                    const ImportOptions& options) {
  for (const auto& [what, name] :
       {std::pair("label of the import", options.label),
        std::pair("condition of the import", options.condition)}) {
    const std::string fault = TextFault(name, limits::kMaxTrialTextBytes);
    if (!fault.empty()) return InvalidConfig(what, Quoted(name), fault);
  }
  TrialIds ids;
  return ImportFrom(
      path,
      [&](Trial trial) {
        NameUnnamed(options, trial);
        std::string id = ids.Unique(trial.id);
        if (id != trial.id && trial.source.empty()) trial.source = trial.id;
        trial.id = std::move(id);
        return sink(std::move(trial));
      },
      options);
}

}  // namespace tactus::internal
