#include "core/sim/skin/line_contact.h"

#include <algorithm>
#include <cmath>

namespace tactus {
namespace {

// Strips of each row of taxels, for faces that are tilted or end in a row.
constexpr int kStripsPerRow = 4;
constexpr int kMaxIterations = 100;
constexpr double kPrecision = 1e-13;

}  // namespace

double Bedding(double youngs_modulus, double edge_m, double cover_n_m3) {
  return 1 / (edge_m / youngs_modulus + 1 / cover_n_m3);
}

LineContact::LineContact(const SkinLayout& layout, const SkinPoint& centre)
    : rows_(layout.rows),
      columns_(layout.columns),
      row_pitch_(layout.row_pitch_m),
      column_pitch_(layout.column_pitch_m),
      wraps_(layout.wrap_columns),
      curvature_(wraps_ ? 0.5 / layout.CylinderRadius() : 0),
      centre_(centre),
      taxels_(layout.taxels()) {
  strips_.reserve(rows_ * kStripsPerRow);
}

void LineContact::CutStrips(double edge_m) {
  if (edge_m == edge_) return;
  edge_ = edge_m;
  const double half = edge_m / 2;
  if (wraps_) {
    high_ = std::min(half, columns_ * column_pitch_ / 4);
    low_ = -high_;
  } else {
    low_ = std::max(-half, (-0.5 - centre_.column) * column_pitch_);
    high_ = std::min(half, (columns_ - 0.5 - centre_.column) * column_pitch_);
  }
  strips_.clear();
  for (int row = 0; row < rows_; ++row) {
    const double middle = (row - centre_.row) * row_pitch_;
    const double begin = std::max(middle - row_pitch_ / 2, -half);
    const double end = std::min(middle + row_pitch_ / 2, half);
    if (end <= begin) continue;
    const double width = (end - begin) / kStripsPerRow;
    for (int i = 0; i < kStripsPerRow; ++i) {
      strips_.push_back({row, begin + (i + 0.5) * width, width});
    }
  }
}

double LineContact::Section(double depth, double low, double high,
                            double* length) const {
  *length = 0;
  if (depth <= 0) return 0;
  if (curvature_ > 0) {
    const double half = std::sqrt(depth / curvature_);
    low = std::max(low, -half);
    high = std::min(high, half);
  }
  if (high <= low) return 0;
  *length = high - low;
  return depth * (high - low) -
         curvature_ * (high * high * high - low * low * low) / 3;
}

double LineContact::Force(double d, const PressedFace& face,
                          double* slope) const {
  const double rise = std::tan(face.tilt_rad);
  double force = 0;
  *slope = 0;
  for (const Strip& strip : strips_) {
    double length = 0;
    force += strip.width * Section(d + strip.y * rise, low_, high_, &length);
    *slope += strip.width * length;
  }
  *slope *= face.bedding_n_m3;
  return force * face.bedding_n_m3;
}

double LineContact::Solve(double force, const PressedFace& face) const {
  // The force grows with d ever faster, so Newton's method comes down from any
  // d that is too large without overshooting. The sum of what a line contact
  // and a flat one would need is nearly always too large.
  double length = 0;
  for (const Strip& strip : strips_) length += strip.width;
  const double line_force = face.bedding_n_m3 * length;
  double d =
      force / (line_force * (high_ - low_)) +
      std::pow(0.75 * force * std::sqrt(curvature_) / line_force, 2.0 / 3.0) +
      edge_ * std::abs(std::tan(face.tilt_rad)) / 2;
  double slope = 0;
  while (Force(d, face, &slope) < force) d *= 2;
  for (int i = 0; i < kMaxIterations; ++i) {
    const double excess = Force(d, face, &slope) - force;
    if (excess <= kPrecision * force) break;
    d -= excess / slope;
  }
  return d;
}

void LineContact::Press(double force, const PressedFace& face) {
  CutStrips(face.edge_m);
  std::fill(taxels_.begin(), taxels_.end(), 0);
  if (force <= 0) return;
  indentation_ = Solve(force, face);
  const double rise = std::tan(face.tilt_rad);
  double sum = 0;
  for (const Strip& strip : strips_) {
    const double depth = indentation_ + strip.y * rise;
    const int first = static_cast<int>(
        std::floor(centre_.column + low_ / column_pitch_ + 0.5));
    const int last = static_cast<int>(
        std::floor(centre_.column + high_ / column_pitch_ + 0.5));
    for (int column = first; column <= last; ++column) {
      const double middle = (column - centre_.column) * column_pitch_;
      double length = 0;
      const double part =
          strip.width *
          Section(depth, std::max(low_, middle - column_pitch_ / 2),
                  std::min(high_, middle + column_pitch_ / 2), &length);
      const int here = ((column % columns_) + columns_) % columns_;
      taxels_[strip.row * columns_ + here] += part;
      sum += part;
    }
  }
  for (double& taxel : taxels_) taxel *= force / sum;
}

}  // namespace tactus
