#include "core/train/contact_frames.h"

namespace tactus {

ContactFrame ContactFrames::operator[](size_t t) const {
  ContactFrame frame;
  frame.sample.features = features_[t];
  frame.sample.net_force = net_force(t);
  if (!profile_.empty()) frame.sample.profile = profile_[t];
  frame.touched = touched(t);
  return frame;
}

void ContactFrames::clear() {
  features_.clear();
  net_force_.clear();
  profile_.clear();
  touched_.clear();
}

void ContactFrames::shrink_to_fit() {
  features_.shrink_to_fit();
  net_force_.shrink_to_fit();
  profile_.shrink_to_fit();
  touched_.shrink_to_fit();
}

void ContactFrames::push_back(const ContactFrame& frame) {
  features_.push_back(frame.sample.features);
  if (!net_force_.empty()) net_force_.emplace_back();
  if (!profile_.empty()) profile_.emplace_back();
  if (!touched_.empty()) touched_.push_back(true);
  Set(size() - 1, frame);
}

void ContactFrames::Set(size_t t, const ContactFrame& frame) {
  const ContactSample& sample = frame.sample;
  if (net_force_.empty() && sample.net_force != sample.features[kForceAt]) {
    for (const FeatureVector& features : features_) {
      net_force_.push_back(features[kForceAt]);
    }
  }
  if (profile_.empty() && sample.profile != LoadProfile{}) {
    profile_.resize(size());
  }
  if (touched_.empty() && !frame.touched) touched_.assign(size(), true);
  features_[t] = sample.features;
  if (!net_force_.empty()) net_force_[t] = sample.net_force;
  if (!profile_.empty()) profile_[t] = sample.profile;
  if (!touched_.empty()) touched_[t] = frame.touched;
}

}  // namespace tactus
