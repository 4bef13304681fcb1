// File: trial_journal.h
//
// TrialJournal: keeps the trials of a recording session safe. Each one is a
// file on the disk as soon as it is added; Finish puts all of them into one
// trial file, behind those that it holds already.
//
//   TACTUS_ASSIGN_OR_RETURN(TrialJournal journal,
//                           TrialJournal::Open("mine.h5", info, nullptr));
//   TACTUS_RETURN_IF_ERROR(journal.Add(trial));
//   TACTUS_ASSIGN_OR_RETURN(const size_t trials, journal.Finish());
//
// The files lie in the folder "mine.h5.parts". If the program ends before
// Finish, the next journal of the same trial file continues with them. Raw
// frames go to "mine.raw.h5" under the same ids. Not thread-safe; one journal
// per trial file.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/stream/skin_frame.h"
#include "tools/trainctl/skin/trial_recorder.h"

namespace tactus::internal::client {

class TrialJournal {
 public:
  // `raw_info`: what raw frames are like; null if there are none.
  // INVALID_TRAINING_DATA if the trial file or the folder holds trials of
  // another skin or rate; IO or TRIAL_FILE_INVALID if they cannot be read.
  static absl::StatusOr<TrialJournal> Open(const std::string& path,
                                           const SkinInfo& info,
                                           const SkinInfo* raw_info);

  // The trial gets the next free id, and is on the disk after that. IO.
  absl::Status Add(const RecordedTrial& recorded);
  // Removes the trial added last, in this session. INVALID_CONFIG if there is
  // none. IO.
  absl::Status Undo();
  // Writes the trial file and removes the folder. Returns the number of trials
  // in the file. Without trials nothing is written.
  absl::StatusOr<size_t> Finish();

  // Trials of an interrupted session; of the trial file.
  size_t recovered() const { return recovered_; }
  size_t present() const { return present_; }
  // File of raw frames: "mine.raw.h5".
  const std::string& raw_path() const { return raw_path_; }

 private:
  TrialJournal(std::string path, bool with_raw);

  std::string PartPath(const std::string& id, bool raw) const;
  // Adds the parts to a trial file, if it does not hold them.
  absl::Status WriteAll(const std::string& path, bool raw) const;
  // Finds the parts of an interrupted session. Those that the trial file holds,
  // because the session ended in Finish, are none.
  absl::Status FindParts(const std::set<std::string>& present,
                         const SkinInfo& info);

  std::string path_;
  std::string raw_path_;
  std::string folder_;
  bool with_raw_;
  size_t present_ = 0;
  size_t recovered_ = 0;
  // The id of the next trial.
  int next_id_ = 0;
  // Ids of the parts, rising.
  std::vector<std::string> parts_;
};

}  // namespace tactus::internal::client
