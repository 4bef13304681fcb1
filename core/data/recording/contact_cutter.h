// File: contact_cutter.h
//
// ContactCutter: cuts the frames of a recording into contacts, at the onsets
// and releases that a stream would report (ContactTracker). A contact begins 1
// s before its onset, but after the contact before it, and ends with its
// release.
//
//   ContactCutter cutter("run.mcap", config, layout);
//   TACTUS_ASSIGN_OR_RETURN(const bool ended, cutter.Add(frame));
//   if (ended) Use(cutter.Take());
//   if (cutter.EndTrial()) Use(cutter.Take());
//
// Not thread-safe.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/data/trial.h"
#include "core/features/contact_tracker.h"
#include "core/skin/layout.h"
#include "tactus/v1/contact.pb.h"

namespace tactus::internal {

class ContactCutter {
 public:
  // `path` is for error messages. `layout` has the shape of the frames.
  ContactCutter(std::string path, const v1::StreamConfig& config,
                const SkinLayout& layout);

  // Takes a frame that RecordingReader returned. True if a contact ended with
  // it. TRIAL_FILE_INVALID for a value that no skin has, and for a contact that
  // is too long for a trial.
  absl::StatusOr<bool> Add(const v1::FrameBatch& frame);
  // Forgets the trial. True if a contact was still open; it ends here.
  bool EndTrial();

  // The contact that ended, without id and label; once.
  Trial Take();
  // Seconds from the recording's first frame to the onset of that contact.
  double onset_s() const { return onset_s_; }
  // Frames that are missing in that contact.
  uint64_t missing() const { return missing_; }

 private:
  absl::Status Decode(const v1::FrameBatch& frame);
  // Keeps the frames of the contact that ended.
  void Cut();

  const std::string path_;
  const SkinLayout layout_;
  const double scale_;
  const v1::TaxelType type_;
  const double rate_hz_;
  ContactTracker tracker_;
  std::vector<float> taxels_;
  Pose pose_;
  bool has_first_ = false;
  int64_t first_ns_ = 0;
  // The trial has a frame; the last one's sequence number.
  bool in_trial_ = false;
  uint64_t sequence_ = 0;
  // Before the onset, the frames of the last second; then all. And those of the
  // contact that ended.
  std::deque<v1::FrameBatch> frames_;
  std::deque<v1::FrameBatch> contact_;
  double onset_s_ = 0;
  uint64_t missing_ = 0;
};

}  // namespace tactus::internal
