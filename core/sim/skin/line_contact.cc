#include "core/sim/skin/line_contact.h"

#include <algorithm>
#include <cmath>

namespace tactus::internal {
namespace {

// Strips of each row of taxels, for faces that are tilted or end in a row.
constexpr int kStripsPerRow = 4;
constexpr int kMaxIterations = 100;
constexpr double kPrecision = 1e-13;

size_t WholeVectors(size_t strips) {
  constexpr size_t kStrips = dent_kernels::kStrips;
  return (strips + kStrips - 1) / kStrips * kStrips;
}

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
  const size_t strips = WholeVectors(rows_ * kStripsPerRow);
  places_.reserve(strips);
  widths_.reserve(strips);
  volumes_.resize(strips);
  areas_.resize(strips);
  // The ends of the face may be rounded into columns next to the skin.
  const size_t columns = columns_ + 2;
  column_volumes_.resize(strips * columns);
  touched_.reserve(columns);
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
  places_.clear();
  widths_.clear();
  for (int row = 0; row < rows_; ++row) {
    const double middle = (row - centre_.row) * row_pitch_;
    const double begin = std::max(middle - row_pitch_ / 2, -half);
    const double end = std::min(middle + row_pitch_ / 2, half);
    if (end <= begin) continue;
    if (places_.empty()) first_row_ = row;
    const double width = (end - begin) / kStripsPerRow;
    for (int i = 0; i < kStripsPerRow; ++i) {
      places_.push_back(begin + (i + 0.5) * width);
      widths_.push_back(width);
    }
  }
  strips_ = places_.size();
  places_.resize(WholeVectors(strips_));
  widths_.resize(places_.size());
}

double LineContact::Force(const dent_kernels::Dent& dent, double bedding,
                          double* slope) {
  dent_kernels::Cut(dent, places_, widths_.data(), volumes_.data(),
                    areas_.data());
  double force = 0;
  *slope = 0;
  for (size_t i = 0; i < strips_; ++i) {
    force += volumes_[i];
    *slope += areas_[i];
  }
  *slope *= bedding;
  return force * bedding;
}

void LineContact::Solve(double force, double bedding,
                        dent_kernels::Dent& dent) {
  // The force grows with the depth ever faster, so Newton's method comes down
  // from any depth that is too large without overshooting. The sum of what a
  // line contact and a flat one would need is nearly always too large.
  double length = 0;
  for (size_t i = 0; i < strips_; ++i) length += widths_[i];
  const double line_force = bedding * length;
  dent.depth =
      force / (line_force * (high_ - low_)) +
      std::pow(0.75 * force * std::sqrt(curvature_) / line_force, 2.0 / 3.0) +
      edge_ * std::abs(dent.rise) / 2;
  double slope = 0;
  double reached = Force(dent, bedding, &slope);
  while (reached < force) {
    dent.depth *= 2;
    reached = Force(dent, bedding, &slope);
  }
  for (int i = 0; i < kMaxIterations; ++i) {
    const double excess = reached - force;
    if (excess <= kPrecision * force) break;
    dent.depth -= excess / slope;
    reached = Force(dent, bedding, &slope);
  }
}

void LineContact::FindColumns(const dent_kernels::Dent& dent) {
  const double deepest =
      dent.depth +
      std::max(places_[0] * dent.rise, places_[strips_ - 1] * dent.rise);
  // No strip's dent is longer. Infinite on a flat skin.
  const double half = std::sqrt(deepest / curvature_);
  const int first =
      static_cast<int>(std::floor(centre_.column + low_ / column_pitch_ + 0.5));
  const int last = static_cast<int>(
      std::floor(centre_.column + high_ / column_pitch_ + 0.5));
  touched_.clear();
  for (int column = first; column <= last; ++column) {
    const double middle = (column - centre_.column) * column_pitch_;
    const double low = std::max(low_, middle - column_pitch_ / 2);
    const double high = std::min(high_, middle + column_pitch_ / 2);
    if (std::max(low, -half) >= std::min(high, half)) continue;
    const int number = ((column % columns_) + columns_) % columns_;
    touched_.push_back({number, low, high});
  }
}

void LineContact::Press(double force, const PressedFace& face) {
  if (force == force_ && face == face_) return;
  force_ = force;
  face_ = face;
  std::fill(taxels_.begin(), taxels_.end(), 0);
  if (force <= 0) return;
  CutStrips(face.edge_m);
  dent_kernels::Dent dent = {.rise = std::tan(face.tilt_rad),
                             .curvature = curvature_,
                             .low = low_,
                             .high = high_};
  Solve(force, face.bedding_n_m3, dent);
  indentation_ = dent.depth;
  FindColumns(dent);
  double* volumes = column_volumes_.data();
  for (const Column& column : touched_) {
    dent.low = column.low;
    dent.high = column.high;
    dent_kernels::Cut(dent, places_, widths_.data(), volumes, areas_.data());
    volumes += places_.size();
  }
  double sum = 0;
  for (size_t i = 0; i < strips_; ++i) {
    double* const row = &taxels_[(first_row_ + i / kStripsPerRow) * columns_];
    volumes = &column_volumes_[i];
    for (const Column& column : touched_) {
      row[column.number] += *volumes;
      sum += *volumes;
      volumes += places_.size();
    }
  }
  for (double& taxel : taxels_) taxel *= force / sum;
}

}  // namespace tactus::internal
