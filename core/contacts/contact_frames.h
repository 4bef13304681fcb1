// File: contact_frames.h
//
// ContactFrames: the frames of a contact in little memory. A frame has 25
// numbers and the touched taxels, but contacts of ideal signals need three
// numbers: the net force is the force, and there are no taxels.
//
//   ContactFrames frames;
//   frames.push_back({IdealSample(signals), true});
//   const ContactFrame first = frames[0];
//
// Frames are returned as copies, whose taxels refer to this object. Owns its
// numbers; copyable. Thread-safe while
// no thread changes it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>
#include <vector>

#include "core/features/feature.h"

namespace tactus::internal {

class ContactFrames {
 public:
  // Iterates over copies.
  class Iterator {
   public:
    using iterator_category = std::input_iterator_tag;
    using value_type = ContactFrame;
    using difference_type = ptrdiff_t;
    using pointer = const ContactFrame*;
    using reference = ContactFrame;

    Iterator(const ContactFrames* frames, size_t at)
        : frames_(frames), at_(at) {}

    ContactFrame operator*() const { return (*frames_)[at_]; }
    Iterator& operator++() {
      ++at_;
      return *this;
    }
    Iterator operator++(int) { return Iterator(frames_, at_++); }
    bool operator==(const Iterator& other) const { return at_ == other.at_; }

   private:
    const ContactFrames* frames_;
    size_t at_;
  };

  size_t size() const { return features_.size(); }
  bool empty() const { return features_.empty(); }
  Iterator begin() const { return {this, 0}; }
  Iterator end() const { return {this, size()}; }
  // Inline, so that a caller that drops a part of the frame does not copy it.
  ContactFrame operator[](size_t t) const {
    return {{features_[t], net_force(t),
             profile_.empty() ? LoadProfile{} : profile_[t], loads(t),
             spread(t), shear(t)},
            touched(t)};
  }
  ContactFrame front() const { return (*this)[0]; }
  ContactFrame back() const { return (*this)[size() - 1]; }
  bool touched(size_t t) const { return touched_.empty() || touched_[t]; }
  const FeatureVector& features(size_t t) const { return features_[t]; }
  double net_force(size_t t) const {
    return net_force_.empty() ? features_[t][kForceAt] : net_force_[t];
  }

  LoadSpread spread(size_t t) const {
    return spread_.empty() ? LoadSpread{} : spread_[t];
  }

  Shear shear(size_t t) const { return shear_.empty() ? Shear{} : shear_[t]; }

  std::span<const TaxelLoad> loads(size_t t) const {
    if (load_ends_.empty()) return {};
    const size_t begin = t == 0 ? 0 : load_ends_[t - 1];
    return std::span(loads_).subspan(begin, load_ends_[t] - begin);
  }

  // The numbers of a frame that has no load profile and no taxels.
  struct Numbers {
    FeatureVector features = {};
    double net_force = 0;
    bool touched = true;
    LoadSpread spread = {};
    Shear shear = {};
  };
  // True if numbers() is all there is of each frame.
  bool plain() const { return profile_.empty() && load_ends_.empty(); }
  Numbers numbers(size_t t) const {
    return {features_[t], net_force(t), touched(t), spread(t), shear(t)};
  }
  // Appends a plain frame.
  void push_back_numbers(const Numbers& numbers);
  // Replaces the numbers, and nothing else, of any frame.
  void SetNumbers(size_t t, const Numbers& numbers);

  // Size of all numbers and taxels.
  size_t bytes() const;

  // Keeps the memory.
  void clear();
  // Releases memory that is not used.
  void shrink_to_fit();
  void push_back(const ContactFrame& frame);
  // Replaces all of a frame but its taxels.
  void Set(size_t t, const ContactFrame& frame);

 private:
  // Makes room for those parts of a frame that are not numbers of a touched
  // frame of ideal signals, if there is none yet.
  void MakeRoomFor(const ContactFrame& frame);
  void MakeRoomFor(const Numbers& numbers);

  static constexpr int kForceAt = static_cast<int>(Feature::kForce);

  std::vector<FeatureVector> features_;
  // Each is empty as long as its numbers are those of a touched frame of ideal
  // signals.
  std::vector<double> net_force_;
  std::vector<LoadProfile> profile_;
  std::vector<bool> touched_;
  std::vector<LoadSpread> spread_;
  std::vector<Shear> shear_;
  // The taxels of all frames, and where those of each frame end.
  std::vector<TaxelLoad> loads_;
  std::vector<uint32_t> load_ends_;
};

}  // namespace tactus::internal
