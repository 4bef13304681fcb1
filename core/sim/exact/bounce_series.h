// File: bounce_series.h
//
// A train of bounces as smooth functions of their number. One bounce (bounce.h)
// changes arm and object very little, so the changes of bounces `stride` apart
// follow a polynomial, whose exact sum leads over as many bounces at once: an
// Adams method for sequences (Mace and Thomas, 1960; Petzold, 1981).
//
//   BounceSeries series(first_change);
//   BounceChange change = series.Sum(0.5);   // of the next stride / 2 bounces
//   series.Add(change_of_the_bounce_after_the_stride);
//
// Plain numbers, no allocation. Not thread-safe.
#pragma once

#include <array>

namespace tactus {

// What one bounce changes, or several: by kLag to kContact. Padded for the
// processor's vectors.
using BounceChange = std::array<double, 6>;
inline constexpr int kLag = 0;
inline constexpr int kRate = 1;
inline constexpr int kApproach = 2;
inline constexpr int kTime = 3;
inline constexpr int kContact = 4;  // seconds in contact

class BounceSeries {
 public:
  // Of the polynomial: terms, one more than its degree.
  static constexpr int kTerms = 6;

  // `change` is that of the bounce the series stands before; stride 1.
  explicit BounceSeries(const BounceChange& change);

  // Bounces from one known change to the next.
  double stride() const { return stride_; }
  // The change of the next `share` (0 to 1) times stride bounces; between whole
  // bounces their smooth interpolation.
  BounceChange Sum(double share) const;
  // The share after which `time` seconds have passed, 0 < time <= Sum(1).
  double ShareAt(double time) const;
  // By how much `change`, of the bounce one stride on, differs from what the
  // polynomial says.
  BounceChange Miss(const BounceChange& change) const;
  // Moves one stride on, to the bounce with `change`.
  void Add(const BounceChange& change);
  // Doubles the stride, if enough is known; else false.
  bool Double();

 private:
  static constexpr int kKnown = 2 * kTerms - 1;

  void SetStride(double stride);
  void Differentiate(const BounceChange& change);
  void FindSums();

  double stride_ = 1;
  // Changes at the last strides, newest at `newest_`, in a ring.
  std::array<BounceChange, kKnown> known_;
  int newest_ = 0;
  int count_ = 0;
  std::array<BounceChange, kTerms> differences_ = {};  // backward
  // Sum of the polynomial that belongs to a difference, by powers of the
  // share from 1 on.
  std::array<std::array<double, kTerms>, kTerms> sums_;
  std::array<BounceChange, kTerms> coefficients_ = {};
};

}  // namespace tactus
