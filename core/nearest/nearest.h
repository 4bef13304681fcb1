// File: nearest.h
//
// Nearest: one nearest neighbour that answers while a contact lasts. The means
// of one view's channels over ten stretches of the contact so far (stretches.h)
// are compared with those of each recorded contact, and of its first quarter
// and half. FitNearest (fit_nearest.h) makes one.
//
//   NearestScorer scorer(&nearest);
//   for (const ContactSample& sample : contact) scorer.Step(sample.loads);
//   scorer.Score(scores);
//
// A Nearest is plain data. A scorer refers to one, which must be valid and
// outlive it; its memory is constant and nothing allocates. Not thread-safe:
// one per contact.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "absl/status/status.h"
#include "core/ridge/frame_views.h"
#include "core/ridge/stretches.h"

namespace tactus::internal {

// Samples times numbers that a model keeps at most: 32 MB.
inline constexpr size_t kMostNearestNumbers = size_t{1} << 23;

// Squared distances well below this count as 0; a typical one is 1.
inline constexpr double kEqualDistance = 1e-3;

struct Nearest {
  FrameViews views;
  // The view whose channels are compared.
  int view = 0;
  // Factors on the numbers, kHistoryStretches x channels: with them, a typical
  // contact has a squared distance of 1 to its nearest neighbour.
  std::vector<float> gain;
  // [samples][numbers], times the gain, and the class of each sample.
  std::vector<float> sample;
  std::vector<uint32_t> label;
  int classes = 0;

  size_t numbers() const {
    return static_cast<size_t>(views.channels()) * kHistoryStretches;
  }
};

// INVALID_MODEL that names what is wrong.
absl::Status Validate(const Nearest& nearest);

// One view of the contact so far.
class ViewStretches {
 public:
  ViewStretches(const FrameViews* views, int view);

  // Forgets the contact.
  void Reset() { stretches_.Reset(); }
  // Takes the touched taxels of the next touched frame.
  void Step(std::span<const TaxelLoad> loads);
  // Writes the means, kHistoryStretches x channels; zeros before a frame.
  void Write(std::span<float> numbers) const { stretches_.Write(numbers); }

 private:
  const FrameViews* views_;
  int view_;
  Stretches stretches_;
  std::vector<float> channels_;
};

class NearestScorer {
 public:
  explicit NearestScorer(const Nearest* nearest);

  void Reset() { stretches_.Reset(); }
  // Takes the touched taxels of the next touched frame.
  void Step(std::span<const TaxelLoad> loads) { stretches_.Step(loads); }
  // Writes a score per class: minus the logarithm of the squared distance to
  // its nearest sample and kEqualDistance. So what counts is how many times
  // nearer a class is than another, and a contact that is far from all says no
  // more than one that is near.
  void Score(std::span<double> scores);

 private:
  const Nearest* nearest_;
  ViewStretches stretches_;
  std::vector<float> numbers_;
};

}  // namespace tactus::internal
