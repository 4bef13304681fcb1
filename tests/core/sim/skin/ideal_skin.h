// File: ideal_skin.h
//
// A skin that measures what presses it.
#pragma once

#include "core/sim/skin/skin_model.h"

namespace tactus::internal::testing {

// "good" without noise and steps.
inline SkinModel IdealSkin() {
  SkinModel skin = *SkinModelNamed("good");
  skin.noise_n = 0;
  skin.step_n = 0;
  return skin;
}

}  // namespace tactus::internal::testing
