#include "core/contacts/contact_frames.h"

namespace tactus {

void ContactFrames::clear() {
  features_.clear();
  net_force_.clear();
  profile_.clear();
  touched_.clear();
  loads_.clear();
  load_ends_.clear();
}

void ContactFrames::shrink_to_fit() {
  features_.shrink_to_fit();
  net_force_.shrink_to_fit();
  profile_.shrink_to_fit();
  touched_.shrink_to_fit();
  loads_.shrink_to_fit();
  load_ends_.shrink_to_fit();
}

void ContactFrames::MakeRoomFor(const ContactFrame& frame) {
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
}

void ContactFrames::push_back(const ContactFrame& frame) {
  features_.push_back(frame.sample.features);
  MakeRoomFor(frame);
  // A part that has room for this frame was made for it.
  const auto put = [&](auto& part, const auto& value) {
    if (part.empty()) return;
    part.resize(size() - 1);
    part.push_back(value);
  };
  put(net_force_, frame.sample.net_force);
  put(profile_, frame.sample.profile);
  put(touched_, frame.touched);
  const auto& loads = frame.sample.loads;
  if (loads_.empty() && loads.empty()) return;
  // Frames before the first one with taxels have none.
  load_ends_.resize(size() - 1);
  loads_.insert(loads_.end(), loads.begin(), loads.end());
  load_ends_.push_back(static_cast<uint32_t>(loads_.size()));
}

void ContactFrames::Set(size_t t, const ContactFrame& frame) {
  MakeRoomFor(frame);
  features_[t] = frame.sample.features;
  if (!net_force_.empty()) net_force_[t] = frame.sample.net_force;
  if (!profile_.empty()) profile_[t] = frame.sample.profile;
  if (!touched_.empty()) touched_[t] = frame.touched;
}

}  // namespace tactus
