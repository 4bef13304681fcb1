// File: file_journal.h
//
// FileJournal: the checkpoints of a fit as files of a folder, so that a fit
// goes on where an earlier process ended.
//
//   FileJournal journal(PosixFileSystem(), folder + "/parts", &events);
//   FitModel(contacts, options, parallel, events.progress(), &journal);
//
// Thread-safe. What it is given must outlive it.
#pragma once

#include <atomic>
#include <optional>
#include <string>

#include "core/store/file_system.h"
#include "core/train/fit_journal.h"
#include "server/trainer/event_writer.h"

namespace tactus::internal::server {

class FileJournal final : public FitJournal {
 public:
  // `folder` must exist.
  FileJournal(FileSystem& files, std::string folder, EventWriter* events)
      : files_(files), folder_(std::move(folder)), events_(events) {}

  std::optional<std::string> Find(absl::string_view part) override;
  // IO or STORAGE_FULL if the part cannot be written.
  absl::Status Put(absl::string_view part, std::string bytes) override;
  void OnPoint(const LearningPoint& point) override;
  bool Cancelled() override { return cancelled_; }

  // May be called by a signal handler.
  void Cancel() { cancelled_ = true; }

 private:
  // "fold/2/hmm/SU" -> the file "fold_2_hmm_SU" of the folder. Other bytes than
  // letters, digits and - become %XX. A name that is too long for a file
  // becomes its SHA-256.
  std::string PathOf(absl::string_view part) const;

  FileSystem& files_;
  const std::string folder_;
  EventWriter* const events_;
  std::atomic<bool> cancelled_ = false;
  static_assert(std::atomic<bool>::is_always_lock_free);
};

}  // namespace tactus::internal::server
