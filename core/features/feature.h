// File: feature.h
//
// The three contact features of the paper (Section "Preprocessing and Feature
// Selection"), in natural units, subsets of them, and what else a frame says.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace tactus {

enum class Feature { kForce = 0, kArea = 1, kMotion = 2 };
inline constexpr int kFeatureCount = 3;

// Force (layout's unit), area (m^2), motion (m); indexed by Feature.
using FeatureVector = std::array<double, kFeatureCount>;

// Load on the whole skin by place, in the square root of the layout's unit:
// kRowBands bands of rows, then kColumnBands bands of columns; see
// load_profile.h.
inline constexpr int kRowBands = 6;
inline constexpr int kColumnBands = 10;
inline constexpr int kProfileSize = kRowBands + kColumnBands;
using LoadProfile = std::array<double, kProfileSize>;

// What one touched frame of a contact says.
struct ContactSample {
  FeatureVector features = {};
  // Force on the whole region, in the layout's unit: the three features know
  // only its largest taxel. An ideal signal's force is both.
  double net_force = 0;
  // Zero for an ideal signal, which knows no place.
  LoadProfile profile = {};
};

// One frame of a contact.
struct ContactFrame {
  ContactSample sample = {};
  // False while touch is lost. Such a frame takes time, but models do not see
  // its sample.
  bool touched = true;
};

// "force", "area" or "motion".
absl::string_view FeatureName(Feature feature);

// Parses "f,m,a" (or full names, any order, no repeats) into the order given.
absl::StatusOr<std::vector<Feature>> ParseFeatures(absl::string_view text);

// The short form, e.g. "f,m,a".
std::string FeaturesToString(const std::vector<Feature>& features);

}  // namespace tactus
