#include "core/contacts/touch_contacts.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/data/trial_layout.h"
#include "core/features/skin_tracker.h"

namespace tactus::internal {
namespace {

// A contact that is at another touch for a shorter time has not left its own.
constexpr double kSwitchedS = 0.1;

// A contact as it is followed.
struct Followed {
  LabelledContact contact;
  // The frame of the trial of each of the contact's frames.
  std::vector<size_t> at;
  // Frames at each touch, and those in which it covers its centre.
  std::vector<size_t> frames_at;
  std::vector<bool> covers;
  // The touch that it is at, and for how long in a row.
  int stays_at = -1;
  size_t stays_for = 0;
  // The touch at which it stayed long enough last.
  int settled_at = -1;
};

class TouchFollower {
 public:
  TouchFollower(const Trial& trial, const SkinLayout& layout,
                const ExtractContactsOptions& options)
      : trial_(trial),
        layout_(layout),
        tracker_(layout, {.sample_rate_hz = trial.sample_rate_hz,
                          .release_after_s = options.release_after_s,
                          .max_contacts = options.max_contacts,
                          .load_profile = options.whole_skin,
                          .taxel_loads = options.whole_skin,
                          .taxel_components = true,
                          .load_spread = true,
                          .shear = true}),
        least_stay_(
            static_cast<size_t>(std::ceil(kSwitchedS * trial.sample_rate_hz))),
        switched_(trial.touches.size()) {}

  TouchContacts Run() {
    std::vector<float> taxels(layout_.values());
    for (size_t t = 0; t < trial_.taxels.frames(); ++t) {
      trial_.taxels.Decode(t, taxels.data());
      FrameView frame{.taxels = taxels};
      if (!trial_.poses.empty()) frame.pose = &trial_.poses[t];
      tracker_.Step(frame);
      for (const TrackedContact* contact : tracker_.contacts()) {
        if (contact->phase != TouchPhase::kReleased) Follow(*contact, t);
      }
    }
    return Result();
  }

 private:
  bool Presses(const Touch& touch, size_t frame) const {
    return trial_.time[frame] >= touch.begin_s &&
           trial_.time[frame] <= touch.end_s;
  }

  // The touch nearest to `place` of those that press; -1 if none does.
  int Nearest(const SkinPoint& place, size_t frame) const {
    int nearest = -1;
    double best = 0;
    for (size_t k = 0; k < trial_.touches.size(); ++k) {
      const Touch& touch = trial_.touches[k];
      if (!Presses(touch, frame)) continue;
      const double distance =
          touch.centre ? SkinDistance(layout_, *touch.centre, place) : 0;
      if (nearest >= 0 && distance >= best) continue;
      best = distance;
      nearest = static_cast<int>(k);
    }
    return nearest;
  }

  bool Covers(const TrackedContact& contact, const Touch& touch) {
    if (!touch.centre) return true;
    const auto row = std::lround(touch.centre->row);
    const auto column = std::lround(touch.centre->column) % layout_.columns;
    if (row < 0 || row >= layout_.rows || column < 0) return false;
    return (tracker_.RowsOf(contact.slot)[row] >> column & 1) != 0;
  }

  void Follow(const TrackedContact& contact, size_t t) {
    Followed& followed = contacts_[contact.id()];
    if (contact.onset) {
      followed.frames_at.resize(trial_.touches.size());
      followed.covers.resize(trial_.touches.size());
    }
    const FrameFeatures& features = contact.features();
    followed.contact.frames.push_back({features.sample(), features.touched});
    followed.at.push_back(t);
    if (!features.touched) return;
    for (size_t k = 0; k < trial_.touches.size(); ++k) {
      if (followed.covers[k] || !Presses(trial_.touches[k], t)) continue;
      followed.covers[k] = Covers(contact, trial_.touches[k]);
    }
    const int at = Nearest(features.centroid, t);
    if (at < 0) return;
    ++followed.frames_at[at];
    Stay(at, t, followed);
  }

  void Stay(int at, size_t t, Followed& followed) {
    followed.stays_for = at == followed.stays_at ? followed.stays_for + 1 : 1;
    followed.stays_at = at;
    if (followed.stays_for < least_stay_) return;
    const int from = std::exchange(followed.settled_at, at);
    if (from >= 0 && from != at && Presses(trial_.touches[from], t)) {
      switched_[from] = true;
    }
  }

  // The touch that a contact belongs to; the count of touches if to none.
  static size_t TouchOf(const Followed& followed) {
    const auto most = std::ranges::max_element(followed.frames_at);
    if (most == followed.frames_at.end() || *most == 0) {
      return followed.frames_at.size();
    }
    return static_cast<size_t>(most - followed.frames_at.begin());
  }

  TouchContacts Result() {
    const size_t touches = trial_.touches.size();
    TouchContacts result;
    std::vector<size_t> owned(touches);
    std::vector<bool> shared(touches);
    for (auto& [id, followed] : contacts_) {
      const size_t touch = TouchOf(followed);
      if (touch == touches) {
        ++result.counts.spurious;
        continue;
      }
      ++owned[touch];
      for (size_t k = 0; k < touches; ++k) {
        if (k == touch) continue;
        shared[k] =
            shared[k] || followed.covers[k] || followed.frames_at[k] > 0;
      }
      SayOf(touch, followed);
      result.contacts.push_back(std::move(followed.contact));
    }
    result.counts.touches = touches;
    for (size_t k = 0; k < touches; ++k) {
      result.counts.found += owned[k] > 0;
      result.counts.broken += owned[k] > 1;
      result.counts.merged += owned[k] == 0 && shared[k];
      result.counts.switched += switched_[k];
    }
    return result;
  }

  // Says of the contact what is known of its touch.
  void SayOf(size_t index, Followed& followed) const {
    const Touch& touch = trial_.touches[index];
    LabelledContact& contact = followed.contact;
    contact.id = trial_.id;
    contact.source = trial_.source;
    contact.touch = index;
    contact.label = touch.label;
    contact.condition = trial_.condition;
    contact.material = touch.material;
    contact.stiffness = touch.stiffness;
    contact.sample_rate_hz = trial_.sample_rate_hz;
    contact.layout = layout_;
    contact.with_poses = !trial_.poses.empty();
    if (touch.object_motion.empty()) return;
    const auto first = std::ranges::lower_bound(trial_.time, touch.begin_s) -
                       trial_.time.begin();
    const auto last = static_cast<ptrdiff_t>(touch.object_motion.size()) - 1;
    for (const size_t t : followed.at) {
      const ptrdiff_t i = static_cast<ptrdiff_t>(t) - first;
      contact.object_motion.push_back(
          i < 0 ? 0 : touch.object_motion[std::min(i, last)]);
    }
  }

  const Trial& trial_;
  const SkinLayout& layout_;
  SkinTracker tracker_;
  const size_t least_stay_;
  // By their ids.
  std::map<uint64_t, Followed> contacts_;
  std::vector<bool> switched_;
};

}  // namespace

TouchCounts& TouchCounts::operator+=(const TouchCounts& other) {
  touches += other.touches;
  found += other.found;
  broken += other.broken;
  merged += other.merged;
  switched += other.switched;
  spurious += other.spurious;
  return *this;
}

absl::StatusOr<TouchContacts> ExtractContacts(
    const Trial& trial, const ExtractContactsOptions& options) {
  if (trial.touches.empty() || trial.taxels.empty()) {
    return InvalidTrainingData(
        absl::StrCat("trial ", trial.id, " has ",
                     trial.touches.empty() ? "no touches" : "no taxels",
                     "; contacts are followed on trials with both"));
  }
  TACTUS_ASSIGN_OR_RETURN(const SkinLayout layout,
                          LayoutOfTrial(trial, options.layout));
  return TouchFollower(trial, layout, options).Run();
}

}  // namespace tactus::internal
