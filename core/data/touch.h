// File: touch.h
//
// Touch: one of several contacts in a trial, with its label and what else is
// known of it. Touches may overlap in time, as when two objects press at once.
//
//   Touch& touch = trial.touches.emplace_back();
//   touch.begin_s = 1.2;
//   touch.end_s = 3.4;
//   touch.label = "HU";
//
// Plain data; owns its texts and array. Safe to read from several threads.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/skin/geometry.h"

namespace tactus::internal {

struct Touch {
  // The first and the last time with force, s, on Trial::time: the truth of a
  // simulation, or as a user annotated them.
  double begin_s = 0;
  double end_s = 0;
  // Class name, as Trial::label.
  std::string label;
  // Where it is on the skin; nothing if unknown.
  std::optional<SkinPoint> centre;
  std::string object;
  std::string material;
  // Stiffness of the object, N/m; 0 if unknown.
  double stiffness = 0;
  // Empty, or one for each time from begin_s to end_s: how far the object has
  // moved, m; truth, never an input.
  std::vector<double> object_motion;
};

// What files call touch `index`: "00" to "63".
std::string TouchName(size_t index);

// Says which touch is wrong and how, "2: end_s is 3 s; ...": touches must be in
// the order of their beginnings and lie within `time`, with texts and numbers
// in range. Empty if all is well. `time` increases and is not empty.
std::string TouchesFault(const std::vector<Touch>& touches,
                         const std::vector<double>& time);

}  // namespace tactus::internal
