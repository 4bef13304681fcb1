// File: contact_tracker.h
//
// ContactTracker: a skin that is touched in one place at a time, as in a trial
// with one label: SkinTracker with all that touches the skin as one contact.
//
//   ContactTracker tracker(layout, {.sample_rate_hz = 100});
//   for (const FrameView& frame : frames) {
//     const FrameFeatures& features = tracker.Step(frame);
//     if (tracker.onset()) model.Reset();
//     if (tracker.state() == ContactState::kInContact) {
//       model.Step(features.sample());
//     }
//   }
//
// Step() allocates nothing. Not thread-safe; one per stream.
#pragma once

#include "core/features/skin_tracker.h"
#include "core/skin/frame.h"
#include "core/skin/layout.h"

namespace tactus::internal {

enum class ContactState { kNoContact, kInContact, kReleased };

class ContactTracker {
 public:
  // max_contacts must be 1.
  using Options = SkinTracker::Options;

  // `layout` must be valid.
  ContactTracker(const SkinLayout& layout, const Options& options)
      : tracker_(layout, options) {}

  // Forgets everything, as if new.
  void Reset();

  // Takes the next frame of rows x columns taxels. The result lives until the
  // next call. Outside of a contact all features are 0 except `touched` and
  // `region_count`.
  const FrameFeatures& Step(const FrameView& frame);

  // The results of the last Step(); kNoContact before the first.
  const FrameFeatures& features() const { return *features_; }
  ContactState state() const { return state_; }
  // True on the frame at which a contact began.
  bool onset() const { return contact_ != nullptr && contact_->onset; }
  // True on the frame at which a contact ended.
  bool released() const {
    return contact_ != nullptr && contact_->phase == TouchPhase::kReleased;
  }
  // True if the last frame's taxels equalled those of the frame before.
  bool reused() const { return tracker_.reused(); }
  // Rows of the last frame whose regions were not summed.
  int quiet_rows() const { return tracker_.quiet_rows(); }
  // The segmentation of the last frame.
  const Segmenter& segmenter() const { return tracker_.segmenter(); }

 private:
  SkinTracker tracker_;
  ContactState state_ = ContactState::kNoContact;
  // The contact in the last frame; null without one.
  const TrackedContact* contact_ = nullptr;
  FrameFeatures outside_;
  const FrameFeatures* features_ = &outside_;
};

}  // namespace tactus::internal
