#include "core/eval/time_warp.h"

namespace tactus {
namespace {

double Between(double before, double after, double share) {
  return before + share * (after - before);
}

ContactFrame Between(const ContactFrame& before, const ContactFrame& after,
                     double share) {
  ContactFrame frame = before;
  if (!before.touched || !after.touched) return frame;
  for (int f = 0; f < kFeatureCount; ++f) {
    frame.sample.features[f] =
        Between(before.sample.features[f], after.sample.features[f], share);
  }
  frame.sample.net_force =
      Between(before.sample.net_force, after.sample.net_force, share);
  return frame;
}

}  // namespace

Contact AtPace(const Contact& contact, double pace) {
  Contact warped = contact;
  warped.frames.clear();
  warped.object_motion.clear();
  for (size_t k = 0; k < contact.frames.size(); ++k) {
    const double place = static_cast<double>(k) * pace;
    const auto before = static_cast<size_t>(place);
    if (before + 1 >= contact.frames.size()) break;
    const double share = place - static_cast<double>(before);
    warped.frames.push_back(
        Between(contact.frames[before], contact.frames[before + 1], share));
    if (contact.object_motion.empty()) continue;
    warped.object_motion.push_back(Between(contact.object_motion[before],
                                           contact.object_motion[before + 1],
                                           share));
  }
  return warped;
}

}  // namespace tactus
