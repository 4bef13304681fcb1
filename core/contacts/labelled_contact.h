// File: labelled_contact.h
//
// LabelledContact: one contact of a labelled trial, as the frames from its
// onset to the end of the trial. Models are fitted and evaluated on these.
//
//   TACTUS_ASSIGN_OR_RETURN(auto contact, ExtractContact(trial));
//   if (!contact.has_value()) ++never_felt;
//
// Plain data and free functions without state; thread-safe.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/contacts/contact_frames.h"
#include "core/data/trial.h"
#include "core/data/trial_id.h"
#include "core/features/feature.h"
#include "core/skin/layout.h"

namespace tactus::internal {

struct LabelledContact {
  std::string id;
  // Trial::source.
  std::string source;
  // Which one of several touches of the trial it is (touch_contacts.h).
  std::optional<size_t> touch;
  // FrameFingerprint of the trial, by which folds keep equal recordings
  // together; set by whoever read the trial. Empty: like no other.
  std::string fingerprint;
  std::string label;
  std::string condition;
  std::string material;
  double sample_rate_hz = 100;
  // Stiffness of the object, N/m; 0 if unknown.
  double stiffness = 0;
  // The skin; an empty name for ideal signals.
  SkinLayout layout;
  // The motion comes from poses of the arm, as that of ideal signals does, and
  // not from the centroid on the skin.
  bool with_poses = true;
  // Distance that the object has moved at each frame, m; empty if unknown.
  std::vector<double> object_motion;
  // From onset to the end of the trial; the first is touched.
  ContactFrames frames;
};

// Makes a sample from an ideal signal. Its force is both peak and net force.
ContactSample IdealSample(const FeatureVector& signals);

// What reports call the contact: the recording, or the trial's id, and the
// touch: "000012/01".
std::string ContactName(const LabelledContact& contact);

// True if the contact comes from ideal signals and not from a skin.
inline bool IsIdeal(const LabelledContact& contact) {
  return contact.layout.name.empty();
}

// An object that has moved by at most this is unmoved so far, m.
inline constexpr double kMovedM = 0.001;

// The label while the object is at rest: HU of HM, SU of SM; others stay.
std::string LabelAtRest(const std::string& label);

// The label as far as frame `frame` shows it: a contact that ends as HM or SM
// is HU or SU until its object has moved by more than kMovedM. Other labels,
// and contacts whose object's motion is unknown, keep their label.
std::string LabelSoFar(const LabelledContact& contact, size_t frame);

// `release_after_s` of a contact that only the end of its trial ends.
inline constexpr double kNeverReleased = -1;

// Extracts the contact of a trial. Taxels, if the trial has them, go through
// the feature path; else the stored signals are taken. Returns nothing if no
// taxel reaches the onset threshold: the trial is never felt.
//
// Models are trained on whole trials: the contact ends with the trial. With
// another `release_after_s` (seconds without touch) a trial may have several
// contacts, and the last one is extracted: a server's final answer is about
// that one.
//
// INVALID_TRAINING_DATA for a trial with several touches (Trial::touches): its
// label is that of the first alone.
struct ExtractOptions {
  // For trials that carry no skin (LayoutOfTrial). May be null.
  const SkinLayout* layout = nullptr;
  double release_after_s = kNeverReleased;
  // Without it, a frame takes a third of the memory or less, and models cannot
  // use the load profile and the taxels.
  bool whole_skin = true;
};
absl::StatusOr<std::optional<LabelledContact>> ExtractContact(
    const Trial& trial, const ExtractOptions& options = {});

}  // namespace tactus::internal
