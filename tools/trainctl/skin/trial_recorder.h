// File: trial_recorder.h
//
// TrialRecorder: cuts labelled trials out of a skin's frames, as an operator's
// keys say.
//
//   TrialRecorder recorder(info, nullptr, {.labels = {"HU", "HM"}});
//   RecorderStep step = recorder.Key('1');
//   step = recorder.Frame(frame, nullptr);
//   if (step.trial) Keep(*step.trial);
//
// A key chooses the label of the contacts to come, and of the one that is going
// on. The onset and the release of a contact, as a server with the same skin
// would find them, cut the trial: it begins `pre_roll_s` before the onset,
// because motion uses the poses before it, and ends `release_after_s` after the
// last touch. What the frames before the onset belong to, such as the contact
// before, is not part of the trial. Contacts without a label are not kept, and
// `news` says so. A skin that sends nothing for `release_after_s` ends a
// contact too.
//
// It reads no clock and writes no file. Not thread-safe.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "client/stream/skin_frame.h"
#include "core/data/trial.h"
#include "core/features/contact_tracker.h"

namespace tactus::internal::client {

struct RecorderOptions {
  // 1 to 9 different names.
  std::vector<std::string> labels = {};
  // Fields of all trials.
  std::string condition = {};
  std::string object = {};
  std::string group = {};
  double pre_roll_s = 0.5;
  double release_after_s = 0.5;
  // A contact that is shorter or longer is not kept.
  double shortest_s = 0.2;
  double longest_s = 60;
};

struct RecordedTrial {
  Trial trial;
  // The same frames as the skin sent them, if they were given.
  std::optional<Trial> raw;
};

// What a key or a frame led to.
struct RecorderStep {
  // For the operator; empty if there is nothing to say.
  std::string news;
  std::optional<RecordedTrial> trial;
  // The trial before is to be removed; the operator wants to end.
  bool undo = false;
  bool quit = false;
};

class TrialRecorder {
 public:
  // `raw_info`: what the raw frames are like; null if there are none.
  TrialRecorder(const SkinInfo& info, const SkinInfo* raw_info,
                const RecorderOptions& options);

  // 1 to 9, or the first letter of a label if no other label and no command
  // has it: chooses a label. u: the last trial is removed. s: the contact that
  // is going on, or if there is none, every contact until the next label, is
  // not kept. q: end.
  RecorderStep Key(char key);
  // Takes the next frame, and the same as the skin sent it.
  RecorderStep Frame(const SkinFrame& frame, const SkinFrame* raw);

  bool in_contact() const {
    return tracker_.state() == ContactState::kInContact;
  }
  // Label of the contacts to come; nothing if they are not kept.
  const std::optional<size_t>& label() const { return label_; }
  // The contact that is going on is kept if it ends now.
  bool keeping() const { return in_contact() && label_ && !skipped_; }
  // How long the contact lasts, or lasted; 0 before the first.
  double contact_s() const;
  // Features of the last frame, and the number of contacts so far.
  const FrameFeatures& features() const { return tracker_.features(); }
  uint64_t contacts() const { return contacts_; }
  // Trials of each label that were cut and not removed.
  const std::vector<int>& counts() const { return counts_; }
  // "1 HU, 2 HM; u undo, s skip, q quit".
  std::string KeysText() const;

 private:
  struct Stored {
    SkinFrame frame;
    SkinFrame raw;
  };

  void Store(const SkinFrame& frame, const SkinFrame* raw);
  // Forgets all frames captured before `time_ns`.
  void ForgetBefore(int64_t time_ns);
  std::optional<size_t> LabelOf(char key) const;
  RecorderStep End();
  // From the onset to the last touch.
  // From the onset to the end of the frame at this time.
  double SecondsUntil(int64_t time_ns) const;
  double touched_s() const { return SecondsUntil(last_touch_ns_); }
  Trial MakeTrial(const SkinInfo& info, bool raw) const;

  const SkinInfo info_;
  const std::optional<SkinInfo> raw_info_;
  const RecorderOptions options_;
  ContactTracker tracker_;
  std::vector<float> values_;
  std::deque<Stored> stored_;
  std::optional<size_t> label_;
  bool skipped_ = false;
  // The contact is longer than longest_s; its frames are not stored.
  bool too_long_ = false;
  int64_t onset_ns_ = 0;
  int64_t last_touch_ns_ = 0;
  int64_t now_ns_ = 0;
  uint64_t missing_ = 0;
  uint64_t contacts_ = 0;
  std::vector<int> counts_;
  // Labels of the trials, for undo.
  std::vector<size_t> history_;
};

}  // namespace tactus::internal::client
