#include "core/import/import_notes.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/errors.h"

namespace tactus::internal {
namespace {

constexpr size_t kShownKinds = 10;
constexpr size_t kShownColumns = 10;

std::string Names(const std::vector<RisingColumn>& columns, bool steady) {
  std::vector<std::string> names;
  size_t more = 0;
  for (const RisingColumn& column : columns) {
    if (column.steady != steady) continue;
    if (names.size() < kShownColumns) {
      names.push_back(column.name);
    } else {
      ++more;
    }
  }
  return absl::StrCat(absl::StrJoin(names, ", "),
                      more > 0 ? absl::StrCat(" and ", more, " more") : "");
}

}  // namespace

void ImportNotes::AddFound(const std::string& name, const std::string& file,
                           const std::string& columns) {
  if (file.empty()) return;
  const std::string text =
      columns.empty() ? file : absl::StrCat(file, "; ", columns);
  auto& [first, files] = found_[text];
  if (files++ == 0) first = name;
}

void ImportNotes::AddRising(const std::vector<RisingColumn>& rising,
                            size_t frames) {
  rising_.Add(rising, frames);
}

void ImportNotes::AddDropped(size_t frames) {
  dropped_frames_ += frames;
  ++dropped_trials_;
}

void ImportNotes::AddRate(const std::string& name, double stated_hz,
                          double measured_hz) {
  rates_.Add(name, stated_hz, measured_hz);
}

void ImportNotes::SetEstimatedRate(const std::string& name, double rate_hz) {
  estimated_rate_ = absl::StrCat(
      "sample_rate_hz is taken from the times of ", name, ": ", rate_hz,
      " Hz for all trials; a skin that streams must have that rate within 5 %");
}

void ImportNotes::AddNames(const Trial& trial) {
  labels_.Add(trial.label);
  conditions_.Add(trial.condition);
  groups_.Add(trial.material);
}

absl::Status ImportNotes::Check(const std::string& skin_path) const {
  const std::string steady = Names(rising_.Always(), true);
  if (steady.empty()) return absl::OkStatus();
  return TrialFileInvalid(
      skin_path,
      absl::StrCat("the recordings would have taxels that rise in steady steps "
                   "in every file, as times and counters do: ",
                   steady,
                   ". Say which column is the time, \"time_column\", or which "
                   "are the taxels, \"taxel_columns\""));
}

void ImportNotes::Tell(
    const std::function<void(const std::string&)>& remark) const {
  if (!remark) return;
  size_t shown = 0;
  for (const auto& [text, files] : found_) {
    if (++shown > kShownKinds) {
      remark(absl::StrCat("and ", found_.size() - kShownKinds,
                          " more kinds of files"));
      break;
    }
    remark(absl::StrCat(
        files.first,
        files.second > 1 ? absl::StrCat(" and ", files.second - 1, " like it")
                         : "",
        ": ", text));
  }
  const std::string rising = Names(rising_.Always(), false);
  if (!rising.empty()) {
    remark(
        absl::StrCat("these taxels rise from each frame to the next in "
                     "every file: ",
                     rising,
                     ". If one is no taxel, say \"time_column\" or "
                     "\"taxel_columns\" in skin.json"));
  }
  for (const SimilarNames* names : {&labels_, &conditions_, &groups_}) {
    for (const std::string& text : names->Remarks()) remark(text);
  }
  if (dropped_frames_ > 0) {
    remark(absl::StrCat(dropped_frames_, " frames of ", dropped_trials_,
                        " trials were dropped, because they have the time of "
                        "the frame before"));
  }
  if (!estimated_rate_.empty()) remark(estimated_rate_);
  if (!rates_.empty()) remark(rates_.Remark());
}

}  // namespace tactus::internal
