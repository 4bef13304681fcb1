#include "core/features/contact_tracker.h"

namespace tactus::internal {

void ContactTracker::Reset() {
  tracker_.Reset();
  state_ = ContactState::kNoContact;
  contact_ = nullptr;
  outside_ = {};
  features_ = &outside_;
}

const FrameFeatures& ContactTracker::Step(const FrameView& frame) {
  tracker_.Step(frame);
  contact_ = tracker_.contacts().empty() ? nullptr : tracker_.contacts()[0];
  if (contact_ != nullptr) {
    state_ = contact_->phase == TouchPhase::kReleased
                 ? ContactState::kReleased
                 : ContactState::kInContact;
  }
  if (state_ == ContactState::kInContact) {
    features_ = &contact_->features();
  } else {
    outside_.touched = tracker_.touched();
    outside_.region_count = tracker_.regions();
    features_ = &outside_;
  }
  return *features_;
}

}  // namespace tactus::internal
