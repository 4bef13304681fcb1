// File: feature.h
//
// The three contact features of the paper (Section "Preprocessing and Feature
// Selection") in SI units, subsets of them, and the other numbers of a frame.
//
//   TACTUS_ASSIGN_OR_RETURN(auto features, ParseFeatures("f,m"));
//   sample.features[static_cast<int>(Feature::kForce)];
//
// Plain data and free functions without state; thread-safe.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/skin/normal_loads.h"
#include "core/taxels/taxel_load.h"

namespace tactus::internal {

enum class Feature { kForce = 0, kArea = 1, kMotion = 2 };
inline constexpr int kFeatureCount = 3;

// Force (layout's unit), area (m^2), motion (m); indexed by Feature.
using FeatureVector = std::array<double, kFeatureCount>;

// Load on bands of the whole skin, in the square root of the layout's unit:
// kRowBands bands of rows, then kColumnBands bands of columns (load_profile.h).
inline constexpr int kRowBands = 6;
inline constexpr int kColumnBands = 10;
inline constexpr int kProfileSize = kRowBands + kColumnBands;
using LoadProfile = std::array<double, kProfileSize>;

// Mean squared distance of a region's load from its middle, m^2: across the
// rows and across the columns of the skin. Each taxel counts with its load. 0
// if the load is in one row, or in one column.
struct LoadSpread {
  float rows = 0;
  float columns = 0;

  bool operator==(const LoadSpread&) const = default;
};

// The numbers of one touched frame of a contact.
struct ContactSample {
  FeatureVector features = {};
  // Force on the whole region, in the layout's unit; the feature kForce is that
  // of its largest taxel. For ideal signals they are equal.
  double net_force = 0;
  // Zero for ideal signals, which have no place on a skin.
  LoadProfile profile = {};
  // The touched taxels of the whole skin, by rising index, and then the frame's
  // components (core/taxels/components.h) if somebody needs them. Empty for
  // ideal signals, and if nobody needs taxels. Refers to the memory of whoever
  // made the sample.
  std::span<const TaxelLoad> loads = {};
  // Spread of the whole region. Zero for ideal signals, and if not needed.
  LoadSpread spread = {};
  // Shear on the whole region. Zero for ideal signals, on skins of one axis,
  // and if not needed.
  Shear shear = {};
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

}  // namespace tactus::internal
