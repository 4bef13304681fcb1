#include "core/hmm/forward_backward.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/hmm/smooth_kernels.h"

namespace tactus::internal {
namespace {

// Number of frames whose moments are added at once. They and their shares stay
// in the first-level cache.
constexpr int kMomentFrames = 16;

}  // namespace

void ForwardBackward::SetModel(const GaussianHmm& model) {
  // Frames of another shape have their padding at other places.
  if (model_ && model_->shape() != ShapeOf(model)) frames_.clear();
  model_.emplace(std::vector<const GaussianHmm*>(lanes_, &model),
                 UnitScale(model.dimensions));
  const HmmShape& shape = model_->shape();
  const int d = shape.dimensions;
  const size_t jumps = shape.last_jump - shape.first_jump + 1;
  plane_ = model_->padded() - 2 * model_->front();
  means_.assign(plane_ * d, 0.0);
  for (int cell = 0; cell < model_->cells(); ++cell) {
    for (int a = 0; a < d; ++a) {
      means_[a * plane_ + cell] = model.means[cell / lanes_ * d + a];
    }
  }
  log_likelihood_ = 0;
  starts_.assign(plane_, 0.0);
  taken_.assign(jumps * model_->padded(), 0.0);
  moments_.assign(plane_ * MomentPlanes(d), 0.0);
  taken_out_.resize(lanes_);
  lowered_.resize(model_->period());
  largest_.resize(model_->period());
  total_.resize(model_->period());
  cleared_.resize(2 * model_->padded());
  model_->Clear(cleared_.data(), cleared_.data() + model_->padded(), 1);
  predicted_ = cleared_;
  taken_now_.assign(jumps * model_->padded(), 0.0);
  last_share_.resize(plane_);
}

int ForwardBackward::MomentPlanes(int a) const {
  return 1 + (model_->shape().full ? a + a * (a + 1) / 2 : 2 * a);
}

Shares<double> ForwardBackward::Belief(int t) {
  double* frame = &frames_[static_cast<size_t>(t) * 2 * model_->padded()];
  return {frame, frame + model_->padded()};
}

void ForwardBackward::Add(const SequenceBatch& batch, Counts wanted) {
  // Shares of zero. The padding keeps them because nothing writes to it again.
  if (const size_t frames = batch.frames();
      frames_.size() < frames * cleared_.size()) {
    frames_.reserve(frames * cleared_.size());
    while (frames_.size() < frames * cleared_.size()) {
      frames_.insert(frames_.end(), cleared_.begin(), cleared_.end());
    }
  }
  Forward(batch);
  if (wanted == Counts::kAll) Backward(batch);
}

void ForwardBackward::Forward(const SequenceBatch& batch) {
  std::ranges::fill(taken_out_, 0.0);
  for (int t = 0; t < batch.frames(); ++t) {
    const double* x = batch.frame(t);
    if (t == 0 ||
        !model_->Advance(false, x, largest_.data(), Belief(t - 1), Belief(t))) {
      StepLowered(x, t);
    }
    if (EndsAt(batch, t)) AddLogLikelihoods(batch, t);
  }
}

void ForwardBackward::StepLowered(const double* x, int t) {
  const Shares<double> predicted = {predicted_.data(),
                                    predicted_.data() + model_->padded()};
  if (t == 0) {
    std::ranges::copy(model_->start_mantissa(), predicted.mantissa);
    std::ranges::copy(model_->start_exponent(), predicted.exponent);
    std::ranges::fill(lowered_, 0.0);
  } else {
    Reduce(t - 1);
    lowered_.swap(largest_);
    model_->Predict(false, Belief(t - 1), predicted);
  }
  model_->Weigh(x, lowered_.data(), largest_.data(), predicted, Belief(t));
  for (int k = 0; k < lanes_; ++k) taken_out_[k] += lowered_[k];
}

void ForwardBackward::Reduce(int t) {
  const Reduction<double> step = {
      .best = false,
      .cells = model_->cells(),
      .period = model_->period(),
      .shares = {Share(t), Belief(t).exponent + model_->front()},
      .largest_exponent = largest_.data(),
      .total = total_.data()};
  FindLargest(step);
  model_->Fold(largest_.data(),
               [](double a, double b) { return std::max(a, b); });
  Total(step);
  model_->Fold(total_.data(), [](double a, double b) { return a + b; });
}

bool ForwardBackward::EndsAt(const SequenceBatch& batch, int t) {
  return std::ranges::find(batch.lengths, t + 1) != batch.lengths.end();
}

void ForwardBackward::AddLogLikelihoods(const SequenceBatch& batch, int t) {
  Reduce(t);
  for (int k = 0; k < lanes_; ++k) {
    if (batch.lengths[k] != t + 1) continue;
    log_likelihood_ += std::numbers::ln2 *
                       (taken_out_[k] + largest_[k] + std::log2(total_[k]));
  }
}

void ForwardBackward::Backward(const SequenceBatch& batch) {
  for (int t = batch.frames() - 1; t >= 0; --t) {
    const bool ends = EndsAt(batch, t);
    if (ends) NormaliseBelief(t);
    if (t + 1 == batch.frames()) {
      std::fill_n(Share(t), plane_, 0.0);
    } else {
      Smooth(
          SmoothStep{.predict = model_->Prediction(false, Belief(t), Belief(t)),
                     .share_next = Share(t + 1),
                     .pitch = model_->padded(),
                     .taken_now = taken_now_.data() + model_->front(),
                     .taken = taken_.data() + model_->front(),
                     .share = Share(t)});
    }
    if (ends) TakeLastShares(batch, t);
    if (t % kMomentFrames == 0) {
      AddMoments(batch, t, std::min(kMomentFrames, batch.frames() - t));
    }
  }
  const double* first = Share(0);
  for (size_t cell = 0; cell < plane_; ++cell) starts_[cell] += first[cell];
}

void ForwardBackward::NormaliseBelief(int t) {
  Reduce(t);
  Normalise(
      NormaliseStep{.cells = model_->cells(),
                    .shares = {Share(t), Belief(t).exponent + model_->front()},
                    .total = total_.data(),
                    .largest_exponent = largest_.data(),
                    .share = last_share_.data()});
}

void ForwardBackward::TakeLastShares(const SequenceBatch& batch, int t) {
  for (int cell = 0; cell < model_->cells(); ++cell) {
    if (batch.lengths[cell % lanes_] == t + 1) {
      Share(t)[cell] = last_share_[cell];
    }
  }
}

void ForwardBackward::AddMoments(const SequenceBatch& batch, int first,
                                 int frames) {
  tactus::internal::AddMoments(
      MomentStep{.cells = model_->cells(),
                 .dimensions = model_->shape().dimensions,
                 .full = model_->shape().full,
                 .frames = frames,
                 .x = batch.frame(first),
                 .share = Share(first),
                 .share_pitch = 2 * model_->padded(),
                 .plane = plane_,
                 .means = means_.data(),
                 .moments = moments_.data()});
}

double ForwardBackward::Sum(const double* first) const {
  return std::accumulate(first, first + lanes_, 0.0);
}

void ForwardBackward::AddTo(ExpectedCounts& counts) const {
  const HmmShape& shape = model_->shape();
  const int n = shape.states;
  const int d = shape.dimensions;
  counts.log_likelihood += log_likelihood_;
  for (int s = 0; s < n; ++s) {
    const auto moment = [&](int plane) {
      return Sum(&moments_[plane * plane_ + size_t(s) * lanes_]);
    };
    counts.starts[s] += Sum(&starts_[static_cast<size_t>(s) * lanes_]);
    for (int q = 0; q <= shape.last_jump - shape.first_jump; ++q) {
      const int from = s - shape.first_jump - q;
      if (from < 0 || from >= n) continue;
      counts.transitions[static_cast<size_t>(from) * n + s] +=
          Sum(&taken_[q * model_->padded() + model_->Cell(s, 0)]);
    }
    counts.occupancy[s] += moment(0);
    for (int a = 0; a < d; ++a) {
      const size_t row = static_cast<size_t>(s) * d + a;
      int plane = MomentPlanes(a);
      counts.first_moment[row] += moment(plane);
      for (int b = shape.full ? 0 : a; b <= a; ++b) {
        counts.second_moment[row * d + b] += moment(++plane);
      }
    }
  }
}

}  // namespace tactus::internal
