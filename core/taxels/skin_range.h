// File: skin_range.h
//
// SkinRange: what each taxel read in the contacts of training, and
// SkinRangeWatch: whether a stream's contacts read unlike any of them, because
// of another gain, an offset, a dead or stuck taxel, or unknown objects.
//
//   SkinRangeWatch watch(&range);
//   for (const auto loads : frames) watch.Step(loads);
//   if (watch.EndContact()) Tell(watch.differing());
//
// A range is plain data. A watch refers to one, which must be valid and outlive
// it; it allocates nothing after construction, and a step costs as much as
// there are touched taxels. Not thread-safe.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "absl/status/status.h"
#include "core/taxels/taxel_load.h"

namespace tactus::internal {

// Per taxel the least and the largest mean load over the touched frames of a
// contact, in the skin's unit.
struct SkinRange {
  std::vector<float> least;
  std::vector<float> most;
};

// INVALID_MODEL unless both have `taxels` numbers, the least not above the
// largest.
absl::Status Validate(const SkinRange& range, int taxels);

// Mean loads of the taxels over the touched frames of a contact.
class ContactLoads {
 public:
  explicit ContactLoads(size_t taxels) : sum_(taxels) {}

  void Reset();
  // Takes the touched taxels of the next touched frame. Others than those of
  // the skin must not occur.
  void Step(std::span<const TaxelLoad> loads);
  uint64_t frames() const { return frames_; }
  // There must be a frame.
  float Mean(size_t taxel) const {
    return static_cast<float>(sum_[taxel] / static_cast<double>(frames_));
  }

 private:
  uint64_t frames_ = 0;
  std::vector<double> sum_;
};

class SkinRangeWatch {
 public:
  // Contacts in a row in which a taxel must differ.
  static constexpr int kContacts = 5;

  explicit SkinRangeWatch(const SkinRange* range);

  // Takes the touched taxels of the next touched frame of a contact.
  void Step(std::span<const TaxelLoad> loads) { loads_.Step(loads); }
  // Ends a contact. True once: some taxels differ.
  bool EndContact();

  // A taxel that differs, and what it read in the last contact.
  struct Reading {
    uint32_t taxel = 0;
    float load = 0;
  };
  // Those that differ, the most distant from their range first; after
  // EndContact() was true.
  std::span<const Reading> differing() const { return differing_; }

 private:
  // How far beyond its range a load is; 0 within it and a margin.
  float Distance(size_t taxel, float load) const;

  const SkinRange* range_;
  // Half the width of the range, and a little for taxels without width.
  float least_margin_ = 0;
  ContactLoads loads_;
  // Contacts in a row in which each taxel differed.
  std::vector<uint8_t> differed_;
  std::vector<Reading> differing_;
  bool told_ = false;
};

}  // namespace tactus::internal
