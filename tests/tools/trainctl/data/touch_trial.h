// File: touch_trial.h
//
// A trial whose frames are known: a square patch on the forearm's skin that is
// touched, pressed harder, and perhaps released. Test-only.
//
//   const Trial trial = TouchTrial(/*frames=*/80, /*touched_until=*/60);
#pragma once

#include <algorithm>

#include "core/data/trial.h"
#include "core/skin/layout.h"

namespace tactus::internal::client {

// Frames of the layout "cody-forearm" at 100 Hz. Rows 5 to 7 and columns 9 to
// 11 are touched from frame 10 on: frame i by (i - 9) / 20 N, at most 2 N, and
// from frame `touched_until` on by nothing.
inline Trial TouchTrial(int frames, int touched_until) {
  const SkinLayout layout = *LayoutPreset("cody-forearm");
  Trial trial;
  trial.id = "000007";
  trial.label = "HM";
  trial.condition = "k900-v0.012";
  trial.layout = layout.name;
  trial.taxels.rows = layout.rows;
  trial.taxels.columns = layout.columns;
  for (int i = 0; i < frames; ++i) {
    trial.time.push_back(0.01 * i);
    for (int taxel = 0; taxel < layout.taxels(); ++taxel) {
      const int row = taxel / layout.columns;
      const int column = taxel % layout.columns;
      const bool touched = i >= 10 && i < touched_until && row >= 5 &&
                           row <= 7 && column >= 9 && column <= 11;
      trial.taxels.f32.push_back(
          touched ? std::min(2.f, 0.05f * static_cast<float>(i - 9)) : 0.f);
    }
  }
  return trial;
}

}  // namespace tactus::internal::client
