#include "core/contacts/contact_frames.h"

namespace tactus::internal {
namespace {

// Puts the last frame's value into a part of the frames, if there is such a
// part. It may have been made for this frame, with room for it.
template <typename Part, typename Value>
void PutLast(size_t frames, const Value& value, Part& part) {
  if (part.empty()) return;
  part.resize(frames - 1);
  part.push_back(value);
}

}  // namespace

size_t ContactFrames::bytes() const {
  return std::span(features_).size_bytes() +
         std::span(net_force_).size_bytes() + std::span(profile_).size_bytes() +
         touched_.size() / 8 + std::span(spread_).size_bytes() +
         std::span(shear_).size_bytes() + std::span(loads_).size_bytes() +
         std::span(load_ends_).size_bytes();
}

void ContactFrames::clear() {
  features_.clear();
  net_force_.clear();
  profile_.clear();
  touched_.clear();
  spread_.clear();
  shear_.clear();
  loads_.clear();
  load_ends_.clear();
}

void ContactFrames::shrink_to_fit() {
  features_.shrink_to_fit();
  net_force_.shrink_to_fit();
  profile_.shrink_to_fit();
  touched_.shrink_to_fit();
  spread_.shrink_to_fit();
  shear_.shrink_to_fit();
  loads_.shrink_to_fit();
  load_ends_.shrink_to_fit();
}

void ContactFrames::MakeRoomFor(const Numbers& numbers) {
  if (net_force_.empty() && numbers.net_force != numbers.features[kForceAt]) {
    for (const FeatureVector& features : features_) {
      net_force_.push_back(features[kForceAt]);
    }
  }
  if (touched_.empty() && !numbers.touched) touched_.assign(size(), true);
  if (spread_.empty() && numbers.spread != LoadSpread{}) {
    spread_.resize(size());
  }
  if (shear_.empty() && numbers.shear != Shear{}) shear_.resize(size());
}

void ContactFrames::MakeRoomFor(const ContactFrame& frame) {
  const ContactSample& sample = frame.sample;
  MakeRoomFor(Numbers{sample.features, sample.net_force, frame.touched,
                      sample.spread, sample.shear});
  if (profile_.empty() && sample.profile != LoadProfile{}) {
    profile_.resize(size());
  }
}

void ContactFrames::push_back_numbers(const Numbers& numbers) {
  features_.push_back(numbers.features);
  MakeRoomFor(numbers);
  PutLast(size(), numbers.net_force, net_force_);
  PutLast(size(), numbers.touched, touched_);
  PutLast(size(), numbers.spread, spread_);
  PutLast(size(), numbers.shear, shear_);
}

void ContactFrames::SetNumbers(size_t t, const Numbers& numbers) {
  MakeRoomFor(numbers);
  features_[t] = numbers.features;
  if (!net_force_.empty()) net_force_[t] = numbers.net_force;
  if (!touched_.empty()) touched_[t] = numbers.touched;
  if (!spread_.empty()) spread_[t] = numbers.spread;
  if (!shear_.empty()) shear_[t] = numbers.shear;
}

void ContactFrames::push_back(const ContactFrame& frame) {
  features_.push_back(frame.sample.features);
  MakeRoomFor(frame);
  PutLast(size(), frame.sample.net_force, net_force_);
  PutLast(size(), frame.sample.profile, profile_);
  PutLast(size(), frame.touched, touched_);
  PutLast(size(), frame.sample.spread, spread_);
  PutLast(size(), frame.sample.shear, shear_);
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
  if (!spread_.empty()) spread_[t] = frame.sample.spread;
  if (!shear_.empty()) shear_[t] = frame.sample.shear;
}

}  // namespace tactus::internal
