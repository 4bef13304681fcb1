// File: skin_tracker.h
//
// SkinTracker: follows all contacts on one skin, each from its onset to its
// release, with a number that stays.
//
//   SkinTracker tracker(layout, {.sample_rate_hz = 100, .max_contacts = 8});
//   for (const FrameView& frame : frames) {
//     tracker.Step(frame);
//     for (const TrackedContact* contact : tracker.contacts()) {
//       Use(contact->id(), contact->phase, contact->features());
//     }
//   }
//
// Step() allocates nothing. Not thread-safe; one per stream.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/base/limits.h"
#include "core/features/contact_track.h"
#include "core/features/recent_poses.h"
#include "core/features/region_owners.h"
#include "core/features/taxel_rows.h"
#include "core/features/touch_finder.h"
#include "core/skin/frame.h"
#include "core/skin/layout.h"
#include "core/skin/normal_loads.h"

namespace tactus::internal {

enum class TouchPhase {
  // The contact touches the skin, or has lost touch for a moment.
  kInContact,
  // Its region has joined that of another contact (merged_into): it has no
  // features of its own. When the regions part, it goes on.
  kMerged,
  // It ended with this frame. The features are 0.
  kReleased,
};

struct TrackedContact {
  TrackedContact(int slot, const SkinLayout& layout,
                 const ContactTrack::Options& options)
      : slot(slot), track(layout, options) {}

  // The place of the contact's models, below max_contacts. Two contacts that
  // are there at the same time have different ones.
  int slot;
  ContactTrack track;
  TouchPhase phase = TouchPhase::kReleased;
  // It began with this frame.
  bool onset = false;
  // The contact of whose region this one was a part; 0 if none.
  uint64_t parent = 0;
  // The contact that it is merged into, or with which it is one again; 0 if
  // none.
  uint64_t merged_into = 0;

  // Counts the skin's contacts from 1.
  uint64_t id() const { return track.id(); }
  const FrameFeatures& features() const { return track.features(); }

  // Its taxels at the last frame in which it touched; all that it had in this
  // stretch of its time and in the one before (kStretchS); and how long this
  // stretch has been.
  TaxelRows rows = {};
  TaxelRows stretch_rows = {};
  TaxelRows earlier_rows = {};
  int stretch_frames = 0;
  // How far its centroid moves in a frame.
  SkinPoint velocity = {};
  // Its largest region in the frame, if it touched.
  int region = 0;
  // The slot of the contact that it is merged into.
  int host = RegionOwners::kNobody;
  // False once it has ended and that was told.
  bool active = false;
};

// With max_contacts 1, all that touches the skin is one contact, and its
// largest region gives the features. It begins when TouchFinder says so,
// continues through losses of touch, and is released. The next contact begins
// on a later frame.
//
// With several contacts, a region belongs to the contact that it overlaps most,
// after that contact's region has moved on as before and grown by one taxel.
//   - A region that overlaps none is a new contact if it can begin
//     (TouchFinder::Begins) and is more than kGap taxels away from all contacts
//     that are felt; nearer, it is a part of the nearest. While there are other
//     contacts, it must last for some frames, and for 0.5 s if only light touch
//     feels it.
//   - A contact that is not felt (ContactTrack::Options) comes back where it
//     was of late, and has no right to a region of one that is.
//   - What light touch still feels of a contact that has ended begins none.
//   - A contact whose region falls into parts keeps the largest. Another part
//     becomes a contact of its own, with this one as `parent`, once it has been
//     more than kGap taxels away for kPartFrames frames and can begin.
//   - Of contacts that overlap one region the largest goes on, and the others
//     are merged into it. When the region falls into parts, the part nearest to
//     where a merged contact was is that contact again.
// All taxels that no other contact has count for a contact's load profile.
//
// Motion: with poses it has a sign, so that the errors of the poses have a mean
// of 0. It is measured from where the poses of the last 0.2 s put the contact
// at onset (RecentPoses), because an error of one pose at onset would stay in
// the whole contact. As long as the region still covers the place where the
// contact began, the motion is the motion of that place. A growing region moves
// its centroid by whole taxels, and poses are a hundred times finer. After the
// region has left the place, the motion is that of its centroid. So a contact
// that travels over the skin while the link rests moves on a cylinder by how
// much lower the new place lies along the normal, and on a flat skin not at
// all; a link that rolls over an object at rest does not move.
//
// The length of a loss counts its untouched frames and the frames that went
// missing in it. Frames that go missing between two touched frames do not end a
// contact. While touch is lost, force and area are 0. The last touched point
// stays fixed to the skin: it moves with the pose, and does not move without
// poses.
class SkinTracker {
 public:
  struct Options {
    // Above 0.
    double sample_rate_hz = 100;
    // Seconds without touch that end a contact; below 0 none ends.
    double release_after_s = 0.5;
    // 1 to limits::kMaxContacts.
    int max_contacts = 1;
    // If false, the load profile stays 0. For models that do not use it.
    bool load_profile = true;
    // If true, `loads` has the touched taxels.
    bool taxel_loads = false;
    // If true, `loads` has the components too (core/taxels/components.h).
    bool taxel_components = false;
    // If true, `spread` is measured.
    bool load_spread = false;
    // If true, `shear` is measured, on skins of three axes.
    bool shear = false;
    // Skips that change no bit: those of TouchFinder, and reuse_unchanged: a
    // frame whose taxels equal those of the touched frame before it keeps the
    // features, except for the motion.
    bool skip_untouched = true;
    bool reuse_unchanged = true;
    bool skip_quiet_rows = true;
  };

  // `layout` must be valid.
  SkinTracker(const SkinLayout& layout, const Options& options);

  // Forgets everything but the number of contacts.
  void Reset();

  // Takes the next frame of rows x columns x axes values.
  void Step(const FrameView& frame);

  // The contacts of the last frame, with those that it ended: the one with the
  // largest area first, then by age. Valid until the next Step().
  std::span<const TrackedContact* const> contacts() const {
    return {contacts_.data(), contact_count_};
  }
  // The taxels of the largest region of a contact that touched in the last
  // frame, one word per row.
  std::span<const uint64_t> RowsOf(int slot);
  // The middle of the load of these taxels; nothing if they read no load at
  // this moment. The last frame's taxels must still be there.
  std::optional<SkinPoint> CentreOfPressure(int slot);

  // Contacts so far.
  uint64_t contacts_begun() const { return begun_; }

  // True if some taxel was touched in the last frame.
  bool touched() const { return touched_; }
  // Regions of the last frame, also those that are no contacts.
  int regions() const { return regions_; }
  // True if the last frame's taxels equalled those of the frame before.
  bool reused() const { return reused_; }
  // Rows of the last frame whose regions were not summed.
  int quiet_rows() const { return finder_.quiet_rows(); }
  // The segmentation of the last frame.
  const Segmenter& segmenter() const { return finder_.segmenter(); }

 private:
  // A region that may become a contact.
  struct Candidate {
    TaxelRows rows;
    int frames = 0;
    // It was there in this frame.
    bool seen = false;
  };

  // What light touch still feels of a contact that has ended.
  struct Residue {
    TaxelRows rows;
    // What is left of the largest mean.
    double light_peak = 0;
  };

  bool Unchanged(std::span<const float> taxels) const;
  void StepUnchanged(const FrameView& frame);
  // For max_contacts 1.
  void StepOne(const FrameView& frame);
  void StepSeveral(const FrameView& frame);
  void FindOwners();
  // Takes all contacts that were there to this frame.
  void MoveOn(const FrameView& frame);
  void BeginNew(const FrameView& frame);
  // Begins one with the largest region that is none of an ended contact.
  void BeginFirst(const FrameView& frame);
  // True if a region that belongs to nobody, or is a part of another contact,
  // has lasted long enough to be a contact.
  bool IsContact(const RegionPlace& place, bool is_part);
  void KeepResidue(const TrackedContact& contact);
  // Adds the taxels that the contact had of late.
  void AddRecentRows(const TrackedContact& contact, TaxelRows& rows) const;
  void FadeResidues();
  // True if the region is what is left of contacts that have ended, or of one
  // of which a mean of `left` is left.
  bool IsResidue(const RegionPlace& place, double left);
  void Begin(const FrameView& frame, int region, uint64_t parent);
  TrackedContact* FreeSlot();
  // What the frame shows of a contact with this largest region.
  ContactTouch TouchOf(int slot, int region);
  // Fills own_rows_ with all touched taxels that no other contact has.
  void FindOwnRows(int slot);
  // Keeps a touched contact's taxels and where they move.
  void Follow(TrackedContact& contact, const Region& region);
  void FollowRows(TrackedContact& contact, const SkinPoint& moved);
  void End(TrackedContact& contact);
  // Fills contacts(), and whether the next frame may be compared.
  void Finish(const FrameView& frame);

  const SkinLayout layout_;
  const Options options_;
  NormalLoads loads_;
  TouchFinder finder_;
  RecentPoses recent_poses_;
  const ContactTrack::Options track_options_;
  TaxelSets sets_;
  RegionOwners owners_;
  const int stretch_frames_;
  const int light_frames_;
  const float contact_threshold_;
  // Made when they are first needed.
  std::array<std::unique_ptr<TrackedContact>, limits::kMaxContacts> slots_;
  uint64_t begun_ = 0;

  bool touched_ = false;
  int regions_ = 0;
  bool reused_ = false;
  // The values of the frame that is taken, as the caller holds them.
  std::span<const float> axis_values_;
  // The values of the last frame, if all its contacts touched. Empty if frames
  // are never compared, as on a skin with light touch, whose means change with
  // every frame.
  std::vector<float> measured_taxels_;
  bool measured_ = false;
  // The frame has no region that may become a contact.
  bool settled_ = false;

  // The frame's largest regions and how many there are of them, what was known
  // of the contacts, and the taxels that count for a contact.
  std::array<RegionPlace, RegionOwners::kMaxRegions> places_;
  int place_count_ = 0;
  std::array<KnownContact, limits::kMaxContacts> known_;
  TaxelRows own_rows_ = {};
  std::array<Candidate, RegionOwners::kMaxRegions> candidates_;
  size_t candidate_count_ = 0;
  std::array<Residue, limits::kMaxContacts> residues_;
  size_t residue_count_ = 0;
  std::array<const TrackedContact*, limits::kMaxContacts> contacts_ = {};
  size_t contact_count_ = 0;
};

}  // namespace tactus::internal
