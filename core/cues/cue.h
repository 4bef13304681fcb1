// File: cue.h
//
// A cue is a number that the inputs of sequence models are made from, derived
// from the frames of a contact so far (docs/cues.md). This header names cues;
// core/cues/cue_tracker.h computes them.
//
//   std::optional<Cue> cue = ParseCue("log_spring");
//   if (NeedsFeature(*cue, Feature::kMotion)) {
//     return CueName(*cue);
//   }
//
// Each group of cues is one file of this folder (core/cues/cue_group.h). Which
// groups there are, and so the numbers of the cues, is known when the program
// starts; files and messages name cues. Thread-safe: free functions.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "absl/strings/string_view.h"
#include "core/features/feature.h"

namespace tactus::internal {

// The raw features are the first cues. All others are known by their names.
enum class Cue : uint16_t { kForce, kArea, kMotion };

// A set of groups: bit i stands for the group in line i of cue_groups.inc.
using CueGroups = uint32_t;
inline constexpr CueGroups kAllCueGroups = ~CueGroups{0};

// What cues are computed from, besides the features. A set is a sum of these.
using CueSources = unsigned;
inline constexpr CueSources kFromProfile = 1;    // ContactSample::profile
inline constexpr CueSources kFromSpread = 2;     // ContactSample::spread
inline constexpr CueSources kFromTaxels = 4;     // ContactSample::loads
inline constexpr CueSources kFromEmbedding = 8;  // loads and a TaxelEmbedding
inline constexpr CueSources kFromShear = 16;     // ContactSample::shear

int CueCount();

// "log_spring".
absl::string_view CueName(Cue cue);

// Returns nothing if no cue has that name.
std::optional<Cue> ParseCue(absl::string_view name);

// The cue of a name that is known to exist; ends the program otherwise.
Cue NamedCue(absl::string_view name);

// Returns the raw feature as a cue.
Cue RawCue(Feature feature);

// True if the cue is computed from this feature.
bool NeedsFeature(Cue cue, Feature feature);

// The group of a cue, as a set; what it, or all of a set, is computed from.
CueGroups GroupOf(Cue cue);
CueSources SourcesOf(Cue cue);
CueSources SourcesOf(CueGroups groups);

// The place of a cue in its group, from 0.
int PlaceInGroup(Cue cue);

// All cues of a group ("springs"); none if no group has that name.
std::vector<Cue> CuesOfGroup(absl::string_view group);

// The cues that LSTMs take by default: those of all standard groups.
std::vector<Cue> StandardCues();

}  // namespace tactus::internal
