// File: import_notes.h
//
// ImportNotes: what users should know of an import that made no mistake: how
// text files were read, which taxels rise as times do, other rates, frames and
// names.
//
//   ImportNotes notes;
//   notes.AddFound("0.csv", file.found, frames.found);
//   TACTUS_RETURN_IF_ERROR(notes.Check("skin.json"));
//   notes.Tell([](const std::string& text) { std::cerr << text << "\n"; });
//
// Not thread-safe.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "core/data/similar_names.h"
#include "core/data/trial.h"
#include "core/import/odd_rates.h"
#include "core/import/rising_columns.h"

namespace tactus::internal {

class ImportNotes {
 public:
  // How the text file `name` was read, and what its columns are.
  void AddFound(const std::string& name, const std::string& file,
                const std::string& columns);
  void AddRising(const std::vector<RisingColumn>& rising, size_t frames);
  // A trial lost frames with the time of the one before.
  void AddDropped(size_t frames);
  // The times of `name` have another rate than the stated one.
  void AddRate(const std::string& name, double stated_hz, double measured_hz);
  // No rate was stated; that of the times of `name` is taken for all trials.
  void SetEstimatedRate(const std::string& name, double rate_hz);
  // The names of a trial's class, condition and group.
  void AddNames(const Trial& trial);

  // TRIAL_FILE_INVALID with `skin_path` if a taxel rises steadily in every
  // file, as times and counters do.
  absl::Status Check(const std::string& skin_path) const;
  // Hands each text to `remark`, if that is set. Kinds of files beyond the
  // first 10 are counted.
  void Tell(const std::function<void(const std::string&)>& remark) const;

 private:
  // By what was found: the first file, and how many there are.
  std::map<std::string, std::pair<std::string, size_t>> found_;
  RisingColumns rising_;
  SimilarNames labels_{"label"};
  SimilarNames conditions_{"condition"};
  SimilarNames groups_{"group"};
  size_t dropped_frames_ = 0;
  size_t dropped_trials_ = 0;
  OddRates rates_;
  std::string estimated_rate_;
};

}  // namespace tactus::internal
