// File: time_warp.h
//
// A contact as if the arm had moved faster or slower. The lumped element model
// (paper, eqs. 1 to 7) is quasi-static but for its ringing: what force, area
// and motion do depends on how far the equilibrium point has come, so another
// speed plays the same signals at another pace. Of an arm of another stiffness
// the same is true until the object slides. Models trained on such copies too
// learn to hold at speeds and stiffnesses that were never recorded.
//
//   Contact faster = AtPace(contact, 1.4);
//
// Thread-safe: a free function.
#pragma once

#include "core/eval/contact.h"

namespace tactus {

// Frame k is `contact` at k x pace, between frames interpolated; as long as the
// contact lasts and no longer than its frames are many. Where touch is lost on
// either side, and for the load profile, the frame before counts. `pace` > 0.
Contact AtPace(const Contact& contact, double pace);

}  // namespace tactus
