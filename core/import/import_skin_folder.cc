#include "core/import/import_skin_folder.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <set>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/data/similar_names.h"
#include "core/data/trial_id.h"
#include "core/files/array_file.h"
#include "core/import/file_names.h"
#include "core/import/idle_noise.h"
#include "core/import/import_notes.h"
#include "core/import/mistakes.h"
#include "core/import/rate_check.h"
#include "core/import/recorded_frames.h"
#include "core/import/ros2/read_ros2_bag.h"
#include "core/import/ros2/ros2_bag.h"
#include "core/import/ros_bag.h"
#include "core/import/skin_file.h"
#include "core/import/trial_table.h"
#include "nlohmann/json.hpp"

namespace tactus::internal {
namespace {

namespace fs = std::filesystem;

constexpr char kNoRate[] =
    "is missing, and there are no times to tell it; give it in skin.json or as "
    "a column of the table. By it models know how long a contact lasts, when "
    "it is over, and when to take a step";

class SkinFolder {
 public:
  SkinFolder(std::string folder, SkinFile skin, TrialTable table,
             const ImportOptions& options)
      : folder_(std::move(folder)),
        skin_(std::move(skin)),
        table_(std::move(table)),
        options_(options) {}

  size_t trials() const { return table_.rows(); }
  SkinFile& skin() { return skin_; }
  // Names the file of a trial's frames.
  std::string File(size_t row) const { return table_.Text(row, "frames"); }
  absl::Status Error(size_t row, absl::string_view field,
                     absl::string_view message) const {
    return table_.Error(row, field, message);
  }
  // What the trials that were read give to remark on.
  const ImportNotes& notes() const { return notes_; }
  void ForgetNotes() {
    notes_ = {};
    NoteRate();
  }

  // A trial with everything but checked thresholds.
  absl::StatusOr<Trial> Read(size_t row) {
    Trial trial;
    TACTUS_RETURN_IF_ERROR(TakeTexts(row, trial));
    TACTUS_RETURN_IF_ERROR(TakeNumbers(row, trial));
    TACTUS_ASSIGN_OR_RETURN(RecordedFrames frames,
                            ReadFrames(row, trial.sample_rate_hz));
    trial.taxels = std::move(frames.taxels);
    trial.time = std::move(frames.time);
    trial.poses = std::move(frames.poses);
    if (trial.taxels.frames() == 0) {
      return table_.Error(row, "frames", "the file holds no frame");
    }
    TACTUS_RETURN_IF_ERROR(TakeTime(row, trial));
    TACTUS_RETURN_IF_ERROR(TakePoses(row, trial));
    if (skin_.repeated_times == RepeatedTimes::kDropped) DropRepeated(trial);
    TACTUS_RETURN_IF_ERROR(CheckTime(row, trial));
    notes_.AddNames(trial);
    trial.layout = skin_.layout.name;
    trial.unit = UnitText(skin_.layout.unit);
    return trial;
  }

  // With the skin, and checked as a whole.
  absl::Status Finish(size_t row, Trial& trial) const {
    SetSkin(skin_.layout, trial);
    if (const absl::Status status = Validate(trial, File(row)); !status.ok()) {
      return table_.Error(row, "frames", status.message());
    }
    return absl::OkStatus();
  }

 private:
  void NoteRate() {
    if (rate_from_.empty()) return;
    notes_.SetEstimatedRate(rate_from_, skin_.sample_rate_hz);
  }

  absl::Status TakeTexts(size_t row, Trial& trial) const {
    trial.id = table_.Has("id") ? table_.Text(row, "id")
                                : absl::StrFormat("%06d", row);
    if (const std::string fault = TrialIdFault(trial.id); !fault.empty()) {
      return table_.Error(row, "id", fault);
    }
    trial.source = table_.Text(row, "frames");
    if (!TextFault(trial.source, limits::kMaxTrialTextBytes).empty()) {
      trial.source.clear();
    }
    if (table_.Has("group") && table_.Has("material")) {
      return table_.Error(row, "group",
                          "is given with material; both name what is left out "
                          "together, so give one");
    }
    const std::pair<const char*, std::string*> texts[] = {
        {"label", &trial.label},
        {"condition", &trial.condition},
        {"object", &trial.object},
        {"material", &trial.material}};
    for (const auto& [field, value] : texts) {
      *value = TrimmedName(table_.Text(row, field));
    }
    if (table_.Has("group")) {
      trial.material = TrimmedName(table_.Text(row, "group"));
    }
    for (const auto& [field, value] : texts) {
      const std::string fault = TextFault(*value, limits::kMaxTrialTextBytes);
      if (!fault.empty()) return table_.Error(row, field, fault);
    }
    NameUnnamed(options_, trial);
    if (trial.label.empty()) {
      return table_.Error(row, "label", "is empty; every trial has a class");
    }
    if (absl::EqualsIgnoreCase(trial.label, "nan")) {
      return table_.Error(row, "label",
                          "is NaN, which stands for a missing label; every "
                          "trial has a class");
    }
    return absl::OkStatus();
  }

  absl::Status TakeNumbers(size_t row, Trial& trial) const {
    TACTUS_ASSIGN_OR_RETURN(trial.stiffness,
                            table_.Number(row, "stiffness", 0));
    TACTUS_ASSIGN_OR_RETURN(trial.velocity, table_.Number(row, "velocity", 0));
    for (const auto& [field, value] : {std::pair("stiffness", trial.stiffness),
                                       std::pair("velocity", trial.velocity)}) {
      if (value < 0) {
        return table_.Error(
            row, field, absl::StrCat("is ", value, "; it must be at least 0"));
      }
    }
    TACTUS_ASSIGN_OR_RETURN(
        trial.sample_rate_hz,
        table_.Number(row, "sample_rate_hz", skin_.sample_rate_hz));
    // Times may tell it, but events become frames by it.
    if (trial.sample_rate_hz == 0 && skin_.events == EventRule::kNone) {
      return absl::OkStatus();
    }
    if (trial.sample_rate_hz >= limits::kMinSampleRateHz &&
        trial.sample_rate_hz <= limits::kMaxSampleRateHz) {
      return absl::OkStatus();
    }
    return table_.Error(
        row, "sample_rate_hz",
        trial.sample_rate_hz == 0
            ? std::string(kNoRate)
            : absl::StrCat("is ", trial.sample_rate_hz, "; it must be ",
                           limits::kMinSampleRateHz, " to ",
                           limits::kMaxSampleRateHz));
  }

  // The array that a field names, "FILE", "FILE:DATASET", or of either the part
  // "...#INDEX" along the first axis. The file lies within the folder.
  absl::StatusOr<ArrayFile> ReadFile(size_t row,
                                     const std::string& field) const {
    std::string file = table_.Text(row, field);
    std::string dataset = field == "frames" ? skin_.dataset : "";
    const size_t hash = file.rfind('#');
    uint32_t index = 0;
    const bool sliced = hash != std::string::npos &&
                        absl::SimpleAtoi(file.substr(hash + 1), &index);
    if (sliced) file.resize(hash);
    for (const char* ending :
         {".npz:", ".h5:", ".hdf5:", ".bag:", ".mcap:", ".db3:"}) {
      const size_t at = file.find(ending);
      if (at == std::string::npos) continue;
      const size_t colon = file.find(':', at);
      dataset = file.substr(colon + 1);
      file.resize(colon);
    }
    const fs::path path(file);
    if (file.empty() || path.is_absolute() ||
        std::find(path.begin(), path.end(), "..") != path.end()) {
      return table_.Error(row, field,
                          absl::StrCat("is ", Quoted(file),
                                       "; it must be a file in ", folder_));
    }
    const bool ros2 =
        path.extension() == ".mcap" || IsRos2Bag(fs::path(folder_) / path);
    if (ros2 || path.extension() == ".bag") {
      if (sliced || field != "frames") {
        return table_.Error(row, field,
                            "is a bag; a bag holds the frames of one trial");
      }
      auto array = ros2 ? ReadRos2(path, dataset) : ReadRos1(path, dataset);
      if (array.ok() || ReasonOf(array.status()) == "INVALID_CONFIG") {
        return array;
      }
      return table_.Error(row, field, array.status().message());
    }
    if (!sliced) {
      auto array =
          ReadArrayFile(fs::path(folder_) / path, dataset, skin_.format);
      if (!array.ok()) {
        return table_.Error(row, field, array.status().message());
      }
      return array;
    }
    // One file for many trials is read once.
    const std::string whole =
        dataset.empty() ? file : absl::StrCat(file, ":", dataset);
    if (whole != whole_name_) {
      auto array =
          ReadArrayFile(fs::path(folder_) / path, dataset, skin_.format);
      if (!array.ok()) {
        return table_.Error(row, field, array.status().message());
      }
      whole_ = *std::move(array);
      whole_name_ = whole;
    }
    const std::vector<size_t>& shape = whole_.array.shape;
    if (shape.size() < 2 || index >= shape.front()) {
      return table_.Error(
          row, field,
          absl::StrCat("asks for part ", index, " of ", whole, ", which has ",
                       shape.size() < 2 ? 0 : shape.front(), " parts"));
    }
    return whole_.Slice(index);
  }

  absl::StatusOr<ArrayFile> ReadRos1(const fs::path& file,
                                     const std::string& topic) const {
    return ReadBag(fs::path(folder_) / file, {.frames = topic,
                                              .values = skin_.bag_values,
                                              .pose = skin_.pose_topic});
  }

  absl::StatusOr<ArrayFile> ReadRos2(const fs::path& file,
                                     const std::string& topic) const {
    if (topic.empty()) {
      return TrialFileInvalid(file.string(),
                              "needs a topic: \"dataset\" of the skin.json");
    }
    // The default is about bags of ROS 1.
    const bool chosen = skin_.bag_values != SkinFile().bag_values;
    return ReadRos2Bag(fs::path(folder_) / file,
                       {.frames = topic,
                        .values = chosen ? skin_.bag_values : "",
                        .pose = skin_.pose_topic});
  }

  absl::StatusOr<RecordedFrames> ReadFrames(size_t row, double rate_hz) {
    TACTUS_ASSIGN_OR_RETURN(const ArrayFile file, ReadFile(row, "frames"));
    const std::string name = File(row);
    auto frames = MakeFrames(name, file, skin_, rate_hz);
    if (!frames.ok()) {
      return table_.Error(row, "frames", frames.status().message());
    }
    notes_.AddFound(name, file.found, frames->found);
    notes_.AddRising(frames->rising, frames->taxels.frames());
    return frames;
  }

  absl::Status TakeTime(size_t row, Trial& trial) const {
    const size_t frames = trial.taxels.frames();
    if (table_.Has("time")) {
      TACTUS_ASSIGN_OR_RETURN(const ArrayFile file, ReadFile(row, "time"));
      const std::vector<size_t>& shape = file.array.shape;
      if (shape.empty() || shape.front() != frames) {
        return table_.Error(
            row, "time",
            absl::StrCat("the file has ", shape.empty() ? 0 : shape.front(),
                         " times; there are ", frames, " frames"));
      }
      // The first of several columns is the time.
      trial.time.clear();
      const size_t width = file.size() / frames;
      for (size_t t = 0; t < frames; ++t) {
        trial.time.push_back(file.Number(t * width) * skin_.time_scale_s);
      }
    }
    if (trial.time.empty()) {
      if (trial.sample_rate_hz == 0) {
        return table_.Error(row, "sample_rate_hz", kNoRate);
      }
      for (size_t t = 0; t < frames; ++t) {
        trial.time.push_back(static_cast<double>(t) / trial.sample_rate_hz);
      }
    }
    return absl::OkStatus();
  }

  // Takes frames away that have the time of the one before.
  void DropRepeated(Trial& trial) {
    const size_t frames = trial.taxels.frames();
    const size_t size = trial.taxels.frame_size();
    const auto move = [](auto& list, size_t from, size_t to, size_t each) {
      if (list.empty()) return;
      const auto begin = list.begin() + static_cast<ptrdiff_t>(from * each);
      std::copy(begin, begin + static_cast<ptrdiff_t>(each),
                list.begin() + static_cast<ptrdiff_t>(to * each));
    };
    size_t kept = 1;
    for (size_t t = 1; t < frames; ++t) {
      if (trial.time[t] == trial.time[kept - 1]) continue;
      move(trial.time, t, kept, 1);
      move(trial.poses, t, kept, 1);
      move(trial.taxels.u16, t, kept, size);
      move(trial.taxels.f32, t, kept, size);
      ++kept;
    }
    if (kept == frames) return;
    notes_.AddDropped(frames - kept);
    const auto cut = [&](auto& list, size_t each) {
      if (!list.empty()) list.resize(kept * each);
    };
    cut(trial.time, 1);
    cut(trial.poses, 1);
    cut(trial.taxels.u16, size);
    cut(trial.taxels.f32, size);
  }

  // Takes the rate of this trial's times, to three digits, for all trials that
  // state none: a model is fitted to one rate.
  absl::Status EstimateRate(size_t row, Trial& trial) {
    constexpr int kDigits = 3;
    const double measured =
        CheckRate(trial.time, limits::kMinSampleRateHz).measured_hz;
    if (!(measured >= limits::kMinSampleRateHz &&
          measured <= limits::kMaxSampleRateHz)) {
      return table_.Error(
          row, "sample_rate_hz",
          absl::StrCat("is missing, and the times of ", File(row), " say ",
                       measured, " Hz; a rate is ", limits::kMinSampleRateHz,
                       " to ", limits::kMaxSampleRateHz, " Hz"));
    }
    // Digits before the point count too.
    const double unit =
        std::pow(10.0, std::floor(std::log10(measured)) + 1 - kDigits);
    skin_.sample_rate_hz = std::round(measured / unit) * unit;
    trial.sample_rate_hz = skin_.sample_rate_hz;
    rate_from_ = File(row);
    NoteRate();
    return absl::OkStatus();
  }

  absl::Status CheckTime(size_t row, Trial& trial) {
    const std::vector<double>& time = trial.time;
    for (size_t t = 1; t < time.size(); ++t) {
      if (time[t] > time[t - 1]) continue;
      size_t repeated = 0;
      for (size_t k = 1; k < time.size(); ++k) {
        repeated += time[k] == time[k - 1];
      }
      return table_.Error(
          row, "time",
          absl::StrCat(
              "that of frame ", t, " is ", time[t],
              " s; it must be above the one before, ", time[t - 1], " s, in ",
              File(row),
              time[t] < time[t - 1]
                  ? ""
                  : absl::StrCat(", where ", repeated, " of ", time.size(),
                                 " frames have the time of the one before. If "
                                 "such frames may go, say \"repeated_times\": "
                                 "\"dropped\" in skin.json")));
    }
    if (trial.sample_rate_hz == 0) {
      TACTUS_RETURN_IF_ERROR(EstimateRate(row, trial));
    }
    const RateCheck check = CheckRate(time, trial.sample_rate_hz);
    if (!check.error.empty()) {
      return table_.Error(
          row, "sample_rate_hz",
          absl::StrCat(check.error, ", in ", File(row), check.advice));
    }
    if (check.remarkable) {
      notes_.AddRate(File(row), trial.sample_rate_hz, check.measured_hz);
    }
    return absl::OkStatus();
  }

  absl::Status TakePoses(size_t row, Trial& trial) const {
    if (!table_.Has("pose")) return absl::OkStatus();
    TACTUS_ASSIGN_OR_RETURN(const ArrayFile file, ReadFile(row, "pose"));
    auto poses = MakePoses(table_.Text(row, "pose"), file);
    if (!poses.ok()) return table_.Error(row, "pose", poses.status().message());
    if (poses->size() != trial.taxels.frames()) {
      return table_.Error(
          row, "pose",
          absl::StrCat("the file has ", poses->size(), " poses; there are ",
                       trial.taxels.frames(), " frames"));
    }
    trial.poses = *std::move(poses);
    return absl::OkStatus();
  }

  const std::string folder_;
  SkinFile skin_;
  const TrialTable table_;
  const ImportOptions& options_;
  ImportNotes notes_;
  // The recording whose times tell the rate; empty if it is stated.
  std::string rate_from_;
  // The file of many trials that was read last.
  mutable std::string whole_name_;
  mutable ArrayFile whole_;
};

// Reads all trials for the thresholds alone.
absl::Status TakeThresholds(const std::string& skin_path,
                            const std::string& table_path,
                            const ImportOptions& options, SkinFolder& folder) {
  SkinFile& skin = folder.skin();
  IdleNoise noise({skin.idle_frames, skin.idle_taxels});
  Mistakes mistakes(table_path);
  for (size_t row = 0; row < folder.trials(); ++row) {
    auto trial = folder.Read(row);
    if (!trial.ok()) {
      TACTUS_RETURN_IF_ERROR(mistakes.Add(folder.File(row), trial.status()));
      continue;
    }
    // For its mask.
    trial->skin = skin.layout;
    noise.Add(*trial);
  }
  TACTUS_RETURN_IF_ERROR(mistakes.Status());
  folder.ForgetNotes();
  const auto found = noise.Estimate();
  if (!found.ok()) {
    return TrialFileInvalid(
        skin_path, absl::StrCat("thresholds: ", found.status().message()));
  }
  skin.layout.contact_threshold = found->contact_threshold;
  skin.layout.onset_threshold = found->onset_threshold;
  if (options.remark) {
    // With all digits: a model refuses a skin with other thresholds.
    options.remark(absl::StrCat(
        "for other recordings of this skin, instead of thresholds: "
        "\"contact_threshold\": ",
        nlohmann::json(found->contact_threshold).dump(),
        ", \"onset_threshold\": ",
        nlohmann::json(found->onset_threshold).dump()));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<size_t> ImportSkinFolder(const std::string& folder,
                                        const ImportOptions& options,
                                        TrialSink sink,
                                        const std::string& only) {
  const std::string skin_path = options.skin.empty()
                                    ? (fs::path(folder) / "skin.json").string()
                                    : options.skin;
  TACTUS_ASSIGN_OR_RETURN(SkinFile skin, ReadSkinFile(skin_path));
  std::string table_path = options.table;
  if (table_path.empty()) {
    const fs::path beside = fs::path(skin_path).parent_path() / skin.table;
    std::error_code error;
    table_path =
        fs::exists(beside, error) ? beside : fs::path(folder) / skin.table;
  }
  std::optional<FileNamePattern> names;
  if (!options.file_names.empty()) skin.file_names = options.file_names;
  if (!skin.file_names.empty()) {
    TACTUS_ASSIGN_OR_RETURN(names, FileNamePattern::Parse(skin.file_names));
  }
  std::error_code no_table;
  const bool from_names = only.empty() && names && options.table.empty() &&
                          !fs::exists(table_path, no_table);
  if (from_names || !only.empty()) table_path = folder;
  std::vector<std::string> left_out;
  TACTUS_ASSIGN_OR_RETURN(
      TrialTable table,
      !only.empty() ? TrialTable::OfOne(folder, only)
      : from_names  ? TrialTable::FromNames(folder, *names, &left_out,
                                            !options.label.empty())
                    : TrialTable::Read(table_path, skin_path, skin.fields,
                                      names ? &*names : nullptr,
                                       !options.label.empty()));
  if (!left_out.empty() && options.remark) {
    options.remark(absl::StrCat(
        left_out.size(), " files are left out, because their names do not fit ",
        Quoted(skin.file_names), ": ", Quoted(left_out.front()),
        left_out.size() > 1 ? " and others" : ""));
  }
  if (table.rows() == 0) {
    return TrialFileInvalid(table_path, "names no trial");
  }
  SkinFolder source(folder, std::move(skin), std::move(table), options);
  if (source.skin().thresholds_from_idle) {
    TACTUS_RETURN_IF_ERROR(
        TakeThresholds(skin_path, table_path, options, source));
  }
  Mistakes mistakes(table_path);
  std::set<std::string> ids;
  for (size_t row = 0; row < source.trials(); ++row) {
    auto trial = source.Read(row);
    absl::Status status = trial.status();
    if (status.ok()) status = source.Finish(row, *trial);
    if (status.ok() && !ids.insert(trial->id).second) {
      status = source.Error(row, "id",
                            absl::StrCat(Quoted(trial->id), " is repeated"));
    }
    TACTUS_RETURN_IF_ERROR(mistakes.Add(source.File(row), status));
    // Nothing is imported once there is a mistake.
    if (mistakes.empty()) TACTUS_RETURN_IF_ERROR(sink(*std::move(trial)));
  }
  TACTUS_RETURN_IF_ERROR(mistakes.Add("", source.notes().Check(skin_path)));
  source.notes().Tell(options.remark);
  TACTUS_RETURN_IF_ERROR(mistakes.Status());
  return source.trials();
}

}  // namespace tactus::internal
