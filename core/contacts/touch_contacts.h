// File: touch_contacts.h
//
// The contacts of a trial of several touches (Trial::touches), found and
// followed as a server does, each with what is known of the touch that it
// belongs to; and how many touches were found, broken, merged and switched.
//
//   TACTUS_ASSIGN_OR_RETURN(TouchContacts found,
//                           ExtractContacts(trial, {.max_contacts = 8}));
//   found.counts.merged;
//   found.contacts[0].label;  // of its touch
//
// In each frame in which a contact touches the skin, it is at the touch whose
// centre is nearest, of those that press at that time; of touches without a
// centre, at any. It belongs to the touch at which it is in most frames, the
// earliest of several.
//
// Thread-safe: free functions without state.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "core/contacts/labelled_contact.h"
#include "core/data/trial.h"
#include "core/skin/layout.h"

namespace tactus::internal {

// All but `spurious` count touches.
struct TouchCounts {
  uint64_t touches = 0;
  // Some contact belongs to it.
  uint64_t found = 0;
  // Several do.
  uint64_t broken = 0;
  // None does, but a contact of another touch was at it or covered its centre.
  uint64_t merged = 0;
  // A contact left it for another one for 0.1 s while it still pressed.
  uint64_t switched = 0;
  // Contacts that were at no touch: they began where nothing pressed.
  uint64_t spurious = 0;

  TouchCounts& operator+=(const TouchCounts& other);
};

struct TouchContacts {
  // In the order of their beginnings; those that were at a touch.
  std::vector<LabelledContact> contacts;
  TouchCounts counts;
};

struct ExtractContactsOptions {
  // For trials that carry no skin (LayoutOfTrial). May be null.
  const SkinLayout* layout = nullptr;
  // As SkinTracker::Options.
  double release_after_s = 0.5;
  int max_contacts = 1;
  // As ExtractOptions.
  bool whole_skin = true;
};

// Frames are those from the onset to the release or the end of the trial; while
// the contact is merged they are untouched. Its label says how its object is at
// the end; its object has not moved before the touch, and rests after it.
// INVALID_TRAINING_DATA for a trial without touches or without taxels.
absl::StatusOr<TouchContacts> ExtractContacts(
    const Trial& trial, const ExtractContactsOptions& options);

}  // namespace tactus::internal
