#include "core/hmm/expectation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/hmm/smooth_kernels.h"

namespace tactus {

void Expectation::Reset(const GaussianHmm& model) {
  // Buffers of another shape have their padding elsewhere.
  if (model_ && model_->shape() != ShapeOf(model)) frames_.clear();
  model_.emplace(std::vector<const GaussianHmm*>{&model},
                 UnitScale(model.dimensions));
  const HmmShape& shape = model_->shape();
  const int n = shape.states;
  const int d = shape.dimensions;
  const int jumps = shape.last_jump - shape.first_jump + 1;
  plane_ = (static_cast<size_t>(n) + kBlock - 1) / kBlock * kBlock;
  means_.assign(plane_ * d, 0.0);
  mantissa_.assign(plane_ * jumps, 1.0);
  exponent_.assign(plane_ * jumps, Scaled<double>::kNothing);
  for (int i = 0; i < n; ++i) {
    for (int a = 0; a < d; ++a) {
      means_[a * plane_ + i] = model.means[static_cast<size_t>(i) * d + a];
    }
    for (int q = 0; q < jumps; ++q) {
      const int j = i + shape.first_jump + q;
      if (j < 0 || j >= n) continue;
      SplitProbability(model.transition[static_cast<size_t>(i) * n + j],
                       mantissa_[q * plane_ + i], exponent_[q * plane_ + i]);
    }
  }
  log_likelihood_ = 0;
  starts_.assign(plane_, 0.0);
  taken_.assign(plane_ * jumps, 0.0);
  moments_.assign(plane_ * MomentPlanes(d), 0.0);
  lowered_.assign(model_->period(), 0.0);
  largest_.assign(model_->period(), 0.0);
  total_.assign(model_->period(), 0.0);
  share_.assign(plane_, 0.0);
  next_share_.assign(plane_, 0.0);
  quotient_.assign(model_->padded(), 0.0);
  x_.assign(2 * static_cast<size_t>(d), 0.0);
}

int Expectation::MomentPlanes(int a) const {
  return 1 + (model_->shape().full ? a + a * (a + 1) / 2 : 2 * a);
}

Shares<double> Expectation::Belief(int t) {
  double* frame = &frames_[static_cast<size_t>(t) * 4 * model_->padded()];
  return {frame, frame + model_->padded()};
}

Shares<double> Expectation::Predicted(int t) {
  double* frame = Belief(t).exponent + model_->padded();
  return {frame, frame + model_->padded()};
}

void Expectation::Add(const SequenceView& sequence) {
  const size_t size =
      static_cast<size_t>(sequence.frames) * 4 * model_->padded();
  if (frames_.size() < size) {
    const size_t old = frames_.size() / (4 * model_->padded());
    frames_.resize(size);
    // Padding is nothing and is never written again.
    for (int t = static_cast<int>(old); t < sequence.frames; ++t) {
      model_->Clear(Belief(t).mantissa, Belief(t).exponent, 1);
      model_->Clear(Predicted(t).mantissa, Predicted(t).exponent, 1);
    }
  }
  Forward(sequence);
  Backward(sequence);
}

void Expectation::Forward(const SequenceView& sequence) {
  std::ranges::copy(model_->start_mantissa(), Predicted(0).mantissa);
  std::ranges::copy(model_->start_exponent(), Predicted(0).exponent);
  std::ranges::fill(largest_, 0.0);
  // Bits taken out of the shares: whole numbers, so the sum is exact.
  double taken_out = 0;
  for (int t = 0; t < sequence.frames; ++t) {
    if (t > 0) model_->Predict(false, Belief(t - 1), Predicted(t));
    model_->Split(sequence.frame(t), x_.data());
    lowered_.swap(largest_);
    model_->Weigh(x_.data(), lowered_.data(), largest_.data(), Predicted(t),
                  Belief(t));
    taken_out += lowered_[0];
  }
  const Shares<double> last = Belief(sequence.frames - 1);
  Total(Reduction<double>{.best = false,
                          .cells = model_->cells(),
                          .period = model_->period(),
                          .shares = {last.mantissa + model_->front(),
                                     last.exponent + model_->front()},
                          .largest_exponent = largest_.data(),
                          .total = total_.data()});
  model_->Fold(total_.data(), [](double a, double b) { return a + b; });
  log_likelihood_ +=
      std::numbers::ln2 * (taken_out + largest_[0] + std::log2(total_[0]));
}

void Expectation::Backward(const SequenceView& sequence) {
  const size_t front = model_->front();
  const int last = sequence.frames - 1;
  const HmmShape& shape = model_->shape();
  Normalise(NormaliseStep{
      .cells = model_->cells(),
      .shares = {Belief(last).mantissa + front, Belief(last).exponent + front},
      .total = total_[0],
      .largest_exponent = largest_[0],
      .share = share_.data()});
  AddFrame(sequence.frame(last).data());
  for (int t = last - 1; t >= 0; --t) {
    next_share_.swap(share_);
    Smooth(SmoothStep{
        .cells = model_->cells(),
        .first_jump = shape.first_jump,
        .jumps = shape.last_jump - shape.first_jump + 1,
        .plane = plane_,
        .mantissa = mantissa_.data(),
        .exponent = exponent_.data(),
        .belief = {Belief(t).mantissa + front, Belief(t).exponent + front},
        .predicted = {Predicted(t + 1).mantissa + front,
                      Predicted(t + 1).exponent + front},
        .share_next = next_share_.data(),
        .quotient = quotient_.data() + front,
        .share = share_.data(),
        .taken = taken_.data()});
    AddFrame(sequence.frame(t).data());
  }
  for (size_t j = 0; j < plane_; ++j) starts_[j] += share_[j];
}

void Expectation::AddFrame(const double* frame) {
  AddMoments(MomentStep{.cells = model_->cells(),
                        .dimensions = model_->shape().dimensions,
                        .full = model_->shape().full,
                        .plane = plane_,
                        .means = means_.data(),
                        .x = frame,
                        .share = share_.data(),
                        .moments = moments_.data()});
}

std::vector<double> Expectation::starts() const {
  return {starts_.begin(), starts_.begin() + model_->shape().states};
}

std::vector<double> Expectation::transitions() const {
  const int n = model_->shape().states;
  std::vector<double> out(static_cast<size_t>(n) * n, 0.0);
  for (int i = 0; i < n; ++i) {
    const int first = i + model_->shape().first_jump;
    for (int j = std::max(0, first);
         j < std::min(n, i + model_->shape().last_jump + 1); ++j) {
      out[static_cast<size_t>(i) * n + j] = taken_[(j - first) * plane_ + i];
    }
  }
  return out;
}

std::vector<double> Expectation::occupancy() const {
  return {moments_.begin(), moments_.begin() + model_->shape().states};
}

std::vector<double> Expectation::first_moment() const {
  const int d = model_->shape().dimensions;
  std::vector<double> out;
  for (int s = 0; s < model_->shape().states; ++s) {
    for (int a = 0; a < d; ++a) {
      out.push_back(moments_[MomentPlanes(a) * plane_ + s]);
    }
  }
  return out;
}

std::vector<double> Expectation::second_moment() const {
  const size_t n = model_->shape().states;
  const size_t d = model_->shape().dimensions;
  std::vector<double> out(n * d * d, 0.0);
  for (size_t s = 0; s < n; ++s) {
    for (size_t a = 0; a < d; ++a) {
      const size_t plane = MomentPlanes(static_cast<int>(a)) + 1;
      const size_t first = model_->shape().full ? 0 : a;
      for (size_t b = first; b <= a; ++b) {
        out[(s * d + a) * d + b] = moments_[(plane + b - first) * plane_ + s];
      }
    }
  }
  return out;
}

}  // namespace tactus
