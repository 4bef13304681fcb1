#include "tools/trainctl/skin/trial_journal.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "absl/algorithm/container.h"
#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/strip.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/data/trial_file.h"
#include "core/data/trial_record.h"
#include "core/files/draft_file.h"
#include "core/files/file_bytes.h"

namespace tactus::internal::client {
namespace {

namespace fs = std::filesystem;

constexpr char kPart[] = ".trial";
constexpr char kRawPart[] = ".raw";
// A part larger than any contact that a recorder keeps.
constexpr size_t kMaxPartBytes = size_t{1} << 30;
constexpr double kMostRateDifference = 0.05;

absl::Status CheckSkin(const Trial& trial, const std::string& path,
                       const SkinInfo& info) {
  const auto complain = [&](const std::string& what) {
    return InvalidTrainingData(absl::StrCat(path,
                                            ": holds trials of another skin (",
                                            what, "); give another --out"));
  };
  if (!trial.skin) return complain("which they do not describe");
  const SkinLayout& skin = *trial.skin;
  if (skin.name != info.layout.name || skin.rows != info.layout.rows ||
      skin.columns != info.layout.columns) {
    return complain(
        absl::StrCat(skin.name, ", ", skin.rows, " x ", skin.columns));
  }
  const std::string difference = SkinDifference(skin, info.layout);
  if (!difference.empty()) return complain(difference);
  if (std::abs(trial.sample_rate_hz / info.sample_rate_hz - 1) >
      kMostRateDifference) {
    return complain(absl::StrCat(trial.sample_rate_hz, " Hz"));
  }
  return absl::OkStatus();
}

absl::StatusOr<Trial> ReadPart(const std::string& path) {
  TACTUS_ASSIGN_OR_RETURN(const std::string bytes,
                          ReadFileBytes(path, kMaxPartBytes));
  v1::TrialRecord record;
  if (!record.ParseFromString(bytes)) {
    return TrialFileInvalid(path, "is no trial");
  }
  auto trial = FromRecord(record);
  if (!trial.ok()) return Annotate(trial.status(), path);
  return trial;
}

// The number that an id of six digits or more is; -1 for other ids.
int NumberOf(const std::string& id) {
  int number = -1;
  const bool digits = id.size() >= 6 && absl::c_all_of(id, absl::ascii_isdigit);
  return digits && absl::SimpleAtoi(id, &number) ? number : -1;
}

absl::Status Remove(const std::string& path) {
  std::error_code error;
  fs::remove(path, error);
  if (error) return IoError(path, error.message());
  return absl::OkStatus();
}

}  // namespace

TrialJournal::TrialJournal(std::string path, bool with_raw)
    : path_(std::move(path)),
      raw_path_(absl::StrCat(absl::StripSuffix(path_, ".h5"), ".raw.h5")),
      folder_(path_ + ".parts"),
      with_raw_(with_raw) {}

std::string TrialJournal::PartPath(const std::string& id, bool raw) const {
  return absl::StrCat(folder_, "/", id, raw ? kRawPart : kPart);
}

absl::StatusOr<TrialJournal> TrialJournal::Open(const std::string& path,
                                                const SkinInfo& info,
                                                const SkinInfo* raw_info) {
  TrialJournal journal(path, raw_info != nullptr);
  std::set<std::string> present;
  if (fs::exists(path)) {
    TACTUS_ASSIGN_OR_RETURN(const auto reader, TrialFileReader::Open(path));
    journal.present_ = reader.size();
    for (size_t i = 0; i < reader.size(); ++i) {
      present.insert(reader.id(i));
      journal.next_id_ = std::max(journal.next_id_, NumberOf(reader.id(i)) + 1);
    }
    if (reader.size() > 0) {
      TACTUS_ASSIGN_OR_RETURN(const Trial first, reader.Read(0));
      TACTUS_RETURN_IF_ERROR(CheckSkin(first, path, info));
    }
  }
  TACTUS_RETURN_IF_ERROR(journal.FindParts(present, info));
  return journal;
}

absl::Status TrialJournal::FindParts(const std::set<std::string>& present,
                                     const SkinInfo& info) {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) return IoError(folder_, error.message());
  for (const auto& entry : fs::directory_iterator(folder_, error)) {
    const std::string name = entry.path().filename();
    const std::string id(absl::StripSuffix(name, kPart));
    if (id == name || NumberOf(id) < 0 || present.contains(id)) continue;
    TACTUS_ASSIGN_OR_RETURN(const Trial trial, ReadPart(entry.path()));
    TACTUS_RETURN_IF_ERROR(CheckSkin(trial, entry.path(), info));
    next_id_ = std::max(next_id_, NumberOf(id) + 1);
    parts_.push_back(id);
  }
  if (error) return IoError(folder_, error.message());
  std::ranges::sort(parts_);
  recovered_ = parts_.size();
  return absl::OkStatus();
}

absl::Status TrialJournal::Add(const RecordedTrial& recorded) {
  RecordedTrial named = recorded;
  named.trial.id = absl::StrFormat("%06d", next_id_);
  // The raw part first: the other one makes both count.
  if (named.raw && with_raw_) {
    named.raw->id = named.trial.id;
    TACTUS_RETURN_IF_ERROR(Validate(*named.raw, raw_path_));
    TACTUS_RETURN_IF_ERROR(
        WriteFileBytes(PartPath(named.trial.id, true),
                       ToRecord(*named.raw).SerializeAsString()));
  }
  TACTUS_RETURN_IF_ERROR(Validate(named.trial, path_));
  TACTUS_RETURN_IF_ERROR(
      WriteFileBytes(PartPath(named.trial.id, false),
                     ToRecord(named.trial).SerializeAsString()));
  parts_.push_back(named.trial.id);
  ++next_id_;
  return absl::OkStatus();
}

absl::Status TrialJournal::Undo() {
  if (parts_.size() == recovered_) {
    return InvalidConfig("trials of this session", 0, "1 or more to undo");
  }
  TACTUS_RETURN_IF_ERROR(Remove(PartPath(parts_.back(), false)));
  TACTUS_RETURN_IF_ERROR(Remove(PartPath(parts_.back(), true)));
  parts_.pop_back();
  --next_id_;
  return absl::OkStatus();
}

absl::Status TrialJournal::WriteAll(const std::string& path, bool raw) const {
  std::vector<Trial> trials;
  std::set<std::string> present;
  if (fs::exists(path)) {
    TACTUS_ASSIGN_OR_RETURN(const auto reader, TrialFileReader::Open(path));
    TACTUS_ASSIGN_OR_RETURN(trials, reader.ReadAll());
    for (const Trial& trial : trials) present.insert(trial.id);
  }
  TACTUS_ASSIGN_OR_RETURN(auto writer,
                          TrialFileWriter::Create(path, {.overwrite = true}));
  for (const Trial& trial : trials) {
    TACTUS_RETURN_IF_ERROR(writer.Append(trial));
  }
  for (const std::string& id : parts_) {
    const std::string part = PartPath(id, raw);
    // A session without a calibration has no raw frames.
    if (present.contains(id) || (raw && !fs::exists(part))) continue;
    TACTUS_ASSIGN_OR_RETURN(const Trial trial, ReadPart(part));
    TACTUS_RETURN_IF_ERROR(writer.Append(trial));
  }
  return writer.Close();
}

absl::StatusOr<size_t> TrialJournal::Finish() {
  if (!parts_.empty()) {
    const bool any_raw = std::ranges::any_of(
        parts_, [&](const auto& id) { return fs::exists(PartPath(id, true)); });
    if (any_raw) TACTUS_RETURN_IF_ERROR(WriteAll(raw_path_, true));
    TACTUS_RETURN_IF_ERROR(WriteAll(path_, false));
  }
  present_ += parts_.size();
  recovered_ = 0;
  parts_.clear();
  std::error_code error;
  fs::remove_all(folder_, error);
  if (error) return IoError(folder_, error.message());
  return present_;
}

}  // namespace tactus::internal::client
