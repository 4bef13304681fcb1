// File: bounce_series.h
//
// A train of bounces as smooth functions of their number. One bounce (bounce.h)
// changes arm and object very little. So the changes by bounces that are
// `stride` apart follow a polynomial, and the exact sum of the polynomial gives
// the change by all bounces between: an Adams method for sequences (Mace and
// Thomas, 1960; Petzold, 1981).
//
//   BounceSeries series(first_change);
//   BounceChange change = series.Sum(0.5);   // of the next stride / 2 bounces
//   series.Add(change_of_the_bounce_after_the_stride);
//
// Plain numbers, no allocation. Not thread-safe.
#pragma once

#include <array>

namespace tactus::internal {

// The change of kLag to kContact by one or several bounces. Padded to a whole
// vector register.
using BounceChange = std::array<double, 6>;
inline constexpr int kLag = 0;
inline constexpr int kRate = 1;
inline constexpr int kApproach = 2;
inline constexpr int kTime = 3;
inline constexpr int kContact = 4;  // seconds in contact

class BounceSeries {
 public:
  // Number of terms of the polynomial, one more than its degree.
  static constexpr int kTerms = 6;

  // `change` is that of the next bounce. The stride is 1 at first.
  explicit BounceSeries(const BounceChange& change);

  // Bounces from one known change to the next.
  double stride() const { return stride_; }
  // The change by the next `share` (0 to 1) times stride bounces; interpolated
  // smoothly between whole bounces.
  BounceChange Sum(double share) const;
  // The share after which `time` seconds have passed, 0 < time <= Sum(1).
  double ShareAt(double time) const;
  // The difference between `change`, of the bounce one stride ahead, and the
  // polynomial's prediction.
  BounceChange Miss(const BounceChange& change) const;
  // Moves one stride ahead, to the bounce with `change`.
  void Add(const BounceChange& change);
  // Doubles the stride. Returns false if too few changes are known.
  bool Double();

 private:
  static constexpr int kKnown = 2 * kTerms - 1;

  void SetStride(double stride);
  void Differentiate(const BounceChange& change);
  void FindSums();

  double stride_ = 1;
  // Ring buffer of the changes at the last strides; the newest at `newest_`.
  std::array<BounceChange, kKnown> known_;
  int newest_ = 0;
  int count_ = 0;
  std::array<BounceChange, kTerms> differences_ = {};  // backward
  // Per difference: coefficients of the summed polynomial, for powers of the
  // share from 1 on.
  std::array<std::array<double, kTerms>, kTerms> sums_;
  std::array<BounceChange, kTerms> coefficients_ = {};
};

}  // namespace tactus::internal
