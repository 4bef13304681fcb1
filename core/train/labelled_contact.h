// File: labelled_contact.h
//
// LabelledContact: one contact of a labelled trial, as the frames from its
// onset to the end of the trial. Models are fitted and evaluated on these.
//
//   TACTUS_ASSIGN_OR_RETURN(auto contact, ExtractContact(trial));
//   if (!contact.has_value()) ++undetectable;
//
// Plain data and free functions without state; thread-safe.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/data/trial.h"
#include "core/features/feature.h"
#include "core/skin/layout.h"

namespace tactus {

struct LabelledContact {
  std::string id;
  std::string label;
  std::string condition;
  std::string material;
  double sample_rate_hz = 100;
  // Of the object, N/m; 0 if unknown.
  double stiffness = 0;
  // Name, rows and columns of the skin; an empty name for ideal signals.
  SkinLayout layout;
  // How far the object has moved, m, one a frame; empty if unknown.
  std::vector<double> object_motion;
  // From onset to the end of the trial; the first is touched.
  std::vector<ContactFrame> frames;
};

// An ideal signal as a frame: its force is both peak and net force.
ContactSample IdealSample(const FeatureVector& signals);

// True if the contact has no skin, only signals.
inline bool IsIdeal(const LabelledContact& contact) {
  return contact.layout.name.empty();
}

// Takes the taxels, if there are any, through the feature path (the contact
// ends with the trial), else the stored signals. Nothing if no taxel ever
// reaches the onset threshold: the trial is undetectable.
//
// `layout` is the skin of trials whose layout class has this name; other
// trials' classes must be presets. Null for none.
absl::StatusOr<std::optional<LabelledContact>> ExtractContact(
    const Trial& trial, const SkinLayout* layout = nullptr);

}  // namespace tactus
