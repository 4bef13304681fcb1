#include "core/features/skin_tracker.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace tactus::internal {
namespace {

// Frames for which a region must be there until it is a contact of its own:
// one that touches elsewhere while others touch, and a part of another one.
constexpr int kNewFrames = 2;
constexpr int kPartFrames = 3;
// The same in seconds for one that only light touch feels.
constexpr double kLightS = 0.5;
// What is less of the least mean that is felt is nothing.
constexpr double kLeastLeft = 0.1;
// A contact that has lost touch comes back where it was in the last two
// stretches of its time.
constexpr double kStretchS = 0.5;
// Weight of the newest frame in a contact's velocity.
constexpr double kNewest = 0.5;

ContactTrack::Options TrackOptions(const SkinTracker::Options& options,
                                   const SkinLayout& layout,
                                   const TouchFinder& finder) {
  return {.sample_rate_hz = options.sample_rate_hz,
          .release_after_s = options.release_after_s,
          .load_profile = options.load_profile,
          .taxel_loads = options.taxel_loads,
          .taxel_components = options.taxel_components,
          .load_spread = options.load_spread,
          .shear = options.shear && layout.axes == 3,
          .release_by_evidence =
              options.max_contacts > 1 && options.release_after_s >= 0,
          .fading = finder.fading(),
          .least_light = finder.least_light()};
}

}  // namespace

SkinTracker::SkinTracker(const SkinLayout& layout, const Options& options)
    : layout_(layout),
      options_(options),
      loads_(layout),
      finder_(layout, {.sample_rate_hz = options.sample_rate_hz,
                       .skip_untouched = options.skip_untouched,
                       .skip_quiet_rows = options.skip_quiet_rows}),
      recent_poses_(options.sample_rate_hz),
      track_options_(TrackOptions(options, layout, finder_)),
      sets_(layout),
      owners_(layout),
      stretch_frames_(
          static_cast<int>(std::ceil(kStretchS * options.sample_rate_hz))),
      light_frames_(
          static_cast<int>(std::ceil(kLightS * options.sample_rate_hz))),
      contact_threshold_(TaxelThreshold(layout.contact_threshold)),
      measured_taxels_(options.reuse_unchanged && !layout.light_touch
                           ? layout.values()
                           : 0) {
  slots_[0] = std::make_unique<TrackedContact>(0, layout_, track_options_);
}

void SkinTracker::Reset() {
  for (const auto& contact : slots_) {
    if (contact != nullptr) contact->active = false;
  }
  touched_ = false;
  regions_ = 0;
  reused_ = false;
  measured_ = false;
  candidate_count_ = 0;
  residue_count_ = 0;
  contact_count_ = 0;
  recent_poses_.Reset();
  finder_.Reset();
}

bool SkinTracker::Unchanged(std::span<const float> taxels) const {
  return measured_ && std::memcmp(taxels.data(), measured_taxels_.data(),
                                  taxels.size_bytes()) == 0;
}

void SkinTracker::Step(const FrameView& frame) {
  recent_poses_.Add(frame.pose, frame.missing_before);
  reused_ = Unchanged(frame.taxels);
  if (reused_) {
    StepUnchanged(frame);
    return;
  }
  for (const auto& contact : slots_) {
    if (contact == nullptr) continue;
    contact->active &= contact->phase != TouchPhase::kReleased;
    contact->onset = false;
  }
  axis_values_ = frame.taxels;
  regions_ = finder_.Find(loads_.Of(frame.taxels));
  touched_ = regions_ > 0;
  if (options_.max_contacts == 1) {
    StepOne(frame);
  } else {
    StepSeveral(frame);
  }
  Finish(frame);
}

void SkinTracker::StepUnchanged(const FrameView& frame) {
  finder_.Repeat(loads_.Of(frame.taxels));
  for (size_t i = 0; i < contact_count_; ++i) {
    TrackedContact& contact = *slots_[contacts_[i]->slot];
    contact.onset = false;
    contact.track.StepUnchanged(frame);
    FollowRows(contact, {});
  }
}

void SkinTracker::StepOne(const FrameView& frame) {
  settled_ = true;
  TrackedContact& contact = *slots_[0];
  ContactTouch touch;
  if (touched_) {
    touch = {.region = &finder_.segmenter().largest(),
             .rows = finder_.segmenter().LargestRows(),
             .all_rows = finder_.segmenter().rows(),
             .values = finder_.values(),
             .axis_values = axis_values_,
             .segmenter = &finder_.segmenter()};
  }
  if (contact.active) {
    if (!contact.track.Step(frame, touched_ ? &touch : nullptr,
                            recent_poses_)) {
      End(contact);
    }
  } else if (touched_ && finder_.begins()) {
    contact.active = true;
    contact.phase = TouchPhase::kInContact;
    contact.onset = true;
    contact.track.Begin(++begun_, frame, touch, recent_poses_);
  }
}

void SkinTracker::StepSeveral(const FrameView& frame) {
  place_count_ =
      touched_ ? finder_.segmenter().FindLargest(finder_.values(), places_) : 0;
  FindOwners();
  FadeResidues();
  MoveOn(frame);
  BeginNew(frame);
}

void SkinTracker::FindOwners() {
  for (size_t slot = 0; slot < slots_.size(); ++slot) {
    KnownContact& known = known_[slot];
    known.active = slots_[slot] != nullptr && slots_[slot]->active;
    if (!known.active) continue;
    const TrackedContact& contact = *slots_[slot];
    known.id = contact.id();
    known.touched = contact.features().touched && !contact.track.is_lost();
    known.lost = contact.track.is_lost();
    known.host = contact.host;
    known.rows = contact.rows;
    if (!known.touched) AddRecentRows(contact, known.rows);
    known.centroid = contact.features().centroid;
    known.velocity = contact.velocity;
  }
  owners_.Find({places_.data(), static_cast<size_t>(place_count_)}, known_);
}

void SkinTracker::MoveOn(const FrameView& frame) {
  for (const auto& slot : slots_) {
    if (slot == nullptr || !slot->active) continue;
    TrackedContact& contact = *slot;
    contact.host = known_[contact.slot].host;
    if (contact.host != RegionOwners::kNobody) {
      contact.merged_into = slots_[contact.host]->id();
      if (contact.parent == contact.merged_into) {
        // It was a part of that contact, and is one again.
        End(contact);
        continue;
      }
      contact.phase = TouchPhase::kMerged;
      contact.track.Pause(frame);
      continue;
    }
    contact.phase = TouchPhase::kInContact;
    contact.merged_into = 0;
    const int region = owners_.main_region(contact.slot);
    if (region == RegionOwners::kNobody) {
      if (!contact.track.Step(frame, nullptr, recent_poses_)) {
        KeepResidue(contact);
        End(contact);
      }
      continue;
    }
    contact.region = region;
    const ContactTouch touch = TouchOf(contact.slot, region);
    if (contact.track.Step(frame, &touch, recent_poses_)) {
      Follow(contact, *touch.region);
    } else {
      KeepResidue(contact);
      End(contact);
    }
  }
  // A contact that ends takes those with it that can't be told from it.
  for (const auto& slot : slots_) {
    if (slot != nullptr && slot->active && slot->phase == TouchPhase::kMerged &&
        slots_[slot->host]->phase == TouchPhase::kReleased) {
      End(*slot);
    }
  }
}

ContactTouch SkinTracker::TouchOf(int slot, int region) {
  const Segmenter& segmenter = finder_.segmenter();
  ContactTouch touch = {.region = &places_[region].region,
                        .rows = places_[region].rows.words(),
                        .values = finder_.values(),
                        .axis_values = axis_values_,
                        .segmenter = &segmenter};
  for (int r = 0; r < place_count_; ++r) {
    if (owners_.owner(r) != slot) continue;
    touch.max_value = std::max(touch.max_value, places_[r].region.max_value);
  }
  if (track_options_.load_profile || track_options_.taxel_loads) {
    FindOwnRows(slot);
    touch.all_rows = own_rows_.words();
  }
  if (touch.max_value >= contact_threshold_) return touch;
  for (int r = 0; r < place_count_; ++r) {
    if (owners_.owner(r) != slot) continue;
    touch.light_peak =
        std::max(touch.light_peak, finder_.LightPeak(places_[r]));
  }
  return touch;
}

void SkinTracker::FindOwnRows(int slot) {
  own_rows_.Clear();
  const std::span<const uint64_t> touched = finder_.segmenter().rows();
  for (int row = 0; row < layout_.rows; ++row) own_rows_.Add(row, touched[row]);
  for (int r = 0; r < place_count_; ++r) {
    const int owner = owners_.owner(r);
    if (owner == slot || owner == RegionOwners::kNobody) continue;
    sets_.Remove(places_[r].rows, own_rows_);
  }
}

void SkinTracker::Follow(TrackedContact& contact, const Region& region) {
  contact.rows.Clear();
  for (int r = 0; r < place_count_; ++r) {
    if (owners_.owner(r) == contact.slot) {
      sets_.Add(places_[r].rows, contact.rows);
    }
  }
  const KnownContact& known = known_[contact.slot];
  double columns = region.centroid_column - known.centroid.column;
  if (layout_.wrap_columns) {
    columns -= layout_.columns * std::round(columns / layout_.columns);
  }
  // How far it has come in a loss does not say how fast it is.
  if (!known.touched) contact.velocity = {};
  FollowRows(contact,
             known.touched
                 ? SkinPoint{region.centroid_row - known.centroid.row, columns}
                 : SkinPoint());
}

void SkinTracker::FollowRows(TrackedContact& contact, const SkinPoint& moved) {
  if (++contact.stretch_frames > stretch_frames_) {
    contact.earlier_rows = contact.stretch_rows;
    contact.stretch_rows.Clear();
    contact.stretch_frames = 1;
  }
  sets_.Add(contact.rows, contact.stretch_rows);
  SkinPoint& velocity = contact.velocity;
  velocity.row += kNewest * (moved.row - velocity.row);
  velocity.column += kNewest * (moved.column - velocity.column);
}

void SkinTracker::End(TrackedContact& contact) {
  contact.phase = TouchPhase::kReleased;
  contact.host = RegionOwners::kNobody;
  contact.track.ForgetFeatures();
}

void SkinTracker::BeginNew(const FrameView& frame) {
  const bool none = std::ranges::none_of(
      slots_, [](const auto& slot) { return slot != nullptr && slot->active; });
  if (none) {
    candidate_count_ = 0;
    settled_ = regions_ <= 1;
    if (touched_ && finder_.begins()) BeginFirst(frame);
    return;
  }
  for (size_t i = 0; i < candidate_count_; ++i) candidates_[i].seen = false;
  for (int r = 0; r < place_count_; ++r) {
    const int owner = owners_.owner(r);
    const bool was_ended = owner != RegionOwners::kNobody &&
                           slots_[owner]->phase == TouchPhase::kReleased;
    const bool is_part = owner != RegionOwners::kNobody && !was_ended;
    const bool is_fading_part = is_part && slots_[owner]->track.unfelt();
    if (IsResidue(places_[r],
                  is_fading_part ? slots_[owner]->track.light_left() : 0)) {
      continue;
    }
    if (is_part) {
      const int main = owners_.main_region(owner);
      if (r == main || !owners_.Apart(places_[r].rows, places_[main].rows)) {
        continue;
      }
    }
    if (!finder_.Begins(places_[r]) || !IsContact(places_[r], is_part)) {
      continue;
    }
    Begin(frame, r, is_part ? slots_[owner]->id() : 0);
  }
  size_t kept = 0;
  for (size_t i = 0; i < candidate_count_; ++i) {
    if (candidates_[i].seen) candidates_[kept++] = candidates_[i];
  }
  candidate_count_ = kept;
  settled_ = kept == 0;
}

void SkinTracker::BeginFirst(const FrameView& frame) {
  if (residue_count_ == 0) {
    // All that the skin feels may be one contact.
    Begin(frame, 0, 0);
    return;
  }
  for (int r = 0; r < place_count_; ++r) {
    if (IsResidue(places_[r], 0) || !finder_.Begins(places_[r])) continue;
    Begin(frame, r, 0);
    return;
  }
}

bool SkinTracker::IsContact(const RegionPlace& place, bool is_part) {
  const bool alone = std::ranges::none_of(slots_, [](const auto& slot) {
    return slot != nullptr && slot->active &&
           slot->phase == TouchPhase::kInContact && slot->features().touched &&
           !slot->track.is_lost();
  });
  if (alone) return true;
  const bool is_light = place.region.max_value < contact_threshold_;
  const int needed = is_light  ? light_frames_
                     : is_part ? kPartFrames
                               : kNewFrames;
  for (size_t i = 0; i < candidate_count_; ++i) {
    Candidate& candidate = candidates_[i];
    if (candidate.seen || !sets_.Overlaps(candidate.rows, place.rows)) continue;
    candidate.rows = place.rows;
    candidate.seen = ++candidate.frames < needed;
    return candidate.frames >= needed;
  }
  if (candidate_count_ < candidates_.size()) {
    candidates_[candidate_count_++] = {
        .rows = place.rows, .frames = 1, .seen = true};
  }
  return false;
}

void SkinTracker::Begin(const FrameView& frame, int region, uint64_t parent) {
  TrackedContact* contact = FreeSlot();
  if (contact == nullptr) return;
  for (const auto& slot : slots_) {
    if (slot != nullptr && slot->active) {
      sets_.Remove(places_[region].rows, slot->rows);
    }
  }
  contact->active = true;
  contact->phase = TouchPhase::kInContact;
  contact->onset = true;
  contact->parent = parent;
  contact->merged_into = 0;
  contact->host = RegionOwners::kNobody;
  contact->velocity = {};
  contact->region = region;
  contact->rows = places_[region].rows;
  contact->stretch_rows = contact->rows;
  contact->earlier_rows.Clear();
  contact->stretch_frames = 1;
  owners_.Give(region, contact->slot);
  const ContactTouch touch = TouchOf(contact->slot, region);
  contact->track.Begin(++begun_, frame, touch, recent_poses_);
}

void SkinTracker::KeepResidue(const TrackedContact& contact) {
  const double left = contact.track.light_left();
  if (left == 0 || residue_count_ == residues_.size()) return;
  Residue& residue = residues_[residue_count_++];
  residue = {.rows = contact.rows, .light_peak = left};
  AddRecentRows(contact, residue.rows);
}

void SkinTracker::AddRecentRows(const TrackedContact& contact,
                                TaxelRows& rows) const {
  sets_.Add(contact.stretch_rows, rows);
  sets_.Add(contact.earlier_rows, rows);
}

void SkinTracker::FadeResidues() {
  size_t kept = 0;
  for (size_t i = 0; i < residue_count_; ++i) {
    Residue& residue = residues_[i];
    residue.light_peak *= finder_.fading();
    if (residue.light_peak < kLeastLeft * finder_.least_light()) continue;
    residues_[kept++] = residue;
  }
  residue_count_ = kept;
}

bool SkinTracker::IsResidue(const RegionPlace& place, double left) {
  if (place.region.max_value >= contact_threshold_) return false;
  for (size_t i = 0; i < residue_count_; ++i) {
    if (!sets_.Overlaps(residues_[i].rows, place.rows)) continue;
    left = std::max(left, residues_[i].light_peak);
  }
  // The rule by which ContactTrack::Step decides whether a contact is felt.
  return left > 0 &&
         finder_.LightPeak(place) <=
             ContactTrack::kAboveFading * left + finder_.least_light();
}

std::span<const uint64_t> SkinTracker::RowsOf(int slot) {
  if (options_.max_contacts == 1) return finder_.segmenter().LargestRows();
  return places_[slots_[slot]->region].rows.words().first(layout_.rows);
}

std::optional<SkinPoint> SkinTracker::CentreOfPressure(int slot) {
  const std::span<const uint64_t> rows = RowsOf(slot);
  const SkinPoint& centroid = slots_[slot]->features().centroid;
  double load = 0;
  double row_sum = 0;
  double column_sum = 0;
  for (int row = 0; row < layout_.rows; ++row) {
    for (uint64_t rest = rows[row]; rest != 0; rest &= rest - 1) {
      const int place = std::countr_zero(rest);
      const double value =
          std::max(finder_.values()[row * layout_.columns + place], 0.0F);
      // From the centroid, the short way round.
      double column = place - centroid.column;
      if (layout_.wrap_columns) {
        column -= layout_.columns * std::round(column / layout_.columns);
      }
      load += value;
      row_sum += value * row;
      column_sum += value * column;
    }
  }
  if (!(load > 0)) return std::nullopt;
  double column = centroid.column + column_sum / load;
  if (layout_.wrap_columns) {
    column -= layout_.columns * std::floor(column / layout_.columns);
  }
  return SkinPoint{row_sum / load, column};
}

TrackedContact* SkinTracker::FreeSlot() {
  for (int slot = 0; slot < options_.max_contacts; ++slot) {
    if (slots_[slot] == nullptr) {
      slots_[slot] =
          std::make_unique<TrackedContact>(slot, layout_, track_options_);
    }
    if (!slots_[slot]->active) return slots_[slot].get();
  }
  return nullptr;
}

void SkinTracker::Finish(const FrameView& frame) {
  contact_count_ = 0;
  bool all_touch = touched_ && settled_;
  for (const auto& slot : slots_) {
    if (slot == nullptr || !slot->active) continue;
    contacts_[contact_count_++] = slot.get();
    all_touch &=
        slot->phase == TouchPhase::kInContact && slot->features().touched;
    // Else it is sought elsewhere in the next frame.
    all_touch &= std::abs(slot->velocity.row) < 0.5 &&
                 std::abs(slot->velocity.column) < 0.5;
  }
  std::sort(contacts_.begin(), contacts_.begin() + contact_count_,
            [](const TrackedContact* a, const TrackedContact* b) {
              const int more =
                  a->features().area_taxels - b->features().area_taxels;
              return more != 0 ? more > 0 : a->id() < b->id();
            });
  measured_ = all_touch && contact_count_ > 0 && !measured_taxels_.empty();
  if (measured_) std::ranges::copy(frame.taxels, measured_taxels_.begin());
}

}  // namespace tactus::internal
