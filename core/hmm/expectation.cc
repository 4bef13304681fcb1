#include "core/hmm/expectation.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/hmm/smooth_kernels.h"

namespace tactus {
namespace {

// Sequences side by side.
constexpr size_t kMaxLanes = kPattern<double>;

}  // namespace

void Expectation::Compute(const GaussianHmm& model,
                          const std::vector<SequenceView>& sequences,
                          Sums sums) {
  const size_t lanes = std::min(kMaxLanes, std::bit_ceil(sequences.size()));
  Reset(model, static_cast<int>(lanes));
  // Sequences of like lengths go together.
  std::vector<const SequenceView*> order;
  for (const SequenceView& sequence : sequences) order.push_back(&sequence);
  std::ranges::stable_sort(order, [](const auto* a, const auto* b) {
    return a->frames > b->frames;
  });
  for (size_t s = 0; s < order.size(); s += lanes) {
    const int frames = order[s]->frames;
    // Lanes without a sequence look at one and never start.
    std::vector<Lane> batch(lanes, {order[s], frames});
    for (size_t k = 0; k < std::min(lanes, order.size() - s); ++k) {
      batch[k] = {order[s + k], frames - order[s + k]->frames};
    }
    AddBatch(batch, frames, sums);
  }
}

void Expectation::Reset(const GaussianHmm& model, int lanes) {
  // Buffers of another shape have their padding elsewhere.
  if (model_ &&
      (model_->shape() != ShapeOf(model) || model_->components() != lanes)) {
    frames_.clear();
  }
  model_.emplace(std::vector<const GaussianHmm*>(lanes, &model),
                 UnitScale(model.dimensions));
  const HmmShape& shape = model_->shape();
  const int n = shape.states;
  const int d = shape.dimensions;
  const int jumps = shape.last_jump - shape.first_jump + 1;
  plane_ = (static_cast<size_t>(n) * lanes + kBlock - 1) / kBlock * kBlock;
  means_.assign(plane_ * d, 0.0);
  mantissa_.assign(plane_ * jumps, 1.0);
  exponent_.assign(plane_ * jumps, Scaled<double>::kNothing);
  for (int cell = 0; cell < n * lanes; ++cell) {
    const int i = cell / lanes;
    for (int a = 0; a < d; ++a) {
      means_[a * plane_ + cell] = model.means[static_cast<size_t>(i) * d + a];
    }
    for (int q = 0; q < jumps; ++q) {
      const int j = i + shape.first_jump + q;
      if (j < 0 || j >= n) continue;
      SplitProbability(model.transition[static_cast<size_t>(i) * n + j],
                       mantissa_[q * plane_ + cell],
                       exponent_[q * plane_ + cell]);
    }
  }
  log_likelihood_ = 0;
  starts_.assign(plane_, 0.0);
  taken_.assign(plane_ * jumps, 0.0);
  moments_.assign(plane_ * MomentPlanes(d), 0.0);
  lowered_.assign(model_->period(), 0.0);
  largest_.assign(model_->period(), 0.0);
  total_.assign(model_->period(), 0.0);
  taken_out_.assign(lanes, 0.0);
  share_.assign(plane_, 0.0);
  next_share_.assign(plane_, 0.0);
  quotient_.assign(model_->padded(), 0.0);
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

void Expectation::AddBatch(const std::vector<Lane>& batch, int frames,
                           Sums sums) {
  const size_t size = static_cast<size_t>(frames) * 4 * model_->padded();
  observations_.resize(
      std::max(observations_.size(), frames * model_->observed_size()));
  if (frames_.size() < size) {
    const size_t old = frames_.size() / (4 * model_->padded());
    frames_.resize(size);
    // Padding is nothing and is never written again.
    for (int t = static_cast<int>(old); t < frames; ++t) {
      model_->Clear(Belief(t).mantissa, Belief(t).exponent, 1);
      model_->Clear(Predicted(t).mantissa, Predicted(t).exponent, 1);
    }
  }
  Forward(batch, frames);
  if (sums == Sums::kAll) Backward(batch, frames);
}

double* Expectation::Observation(int t) {
  return &observations_[static_cast<size_t>(t) * model_->observed_size()];
}

void Expectation::Forward(const std::vector<Lane>& batch, int frames) {
  const int lanes = model_->components();
  std::ranges::copy(model_->start_mantissa(), Predicted(0).mantissa);
  std::ranges::copy(model_->start_exponent(), Predicted(0).exponent);
  std::ranges::fill(largest_, 0.0);
  int started = 0;
  for (int t = 0; t < frames; ++t) {
    if (t > 0) model_->Predict(false, Belief(t - 1), Predicted(t));
    for (; started < lanes && batch[started].first == t; ++started) {
      Start(started, t);
    }
    for (int k = 0; k < lanes; ++k) {
      const auto& [sequence, first] = batch[k];
      model_->Observe(k, sequence->frame(std::max(0, t - first)),
                      Observation(t));
    }
    lowered_.swap(largest_);
    model_->Weigh(Observation(t), lowered_.data(), largest_.data(),
                  Predicted(t), Belief(t));
    for (int k = 0; k < lanes; ++k) taken_out_[k] += lowered_[k];
  }
  const Shares<double> last = Belief(frames - 1);
  Total(Reduction<double>{.best = false,
                          .cells = model_->cells(),
                          .period = model_->period(),
                          .shares = {last.mantissa + model_->front(),
                                     last.exponent + model_->front()},
                          .largest_exponent = largest_.data(),
                          .total = total_.data()});
  model_->Fold(total_.data(), [](double a, double b) { return a + b; });
  for (int k = 0; k < started; ++k) {
    log_likelihood_ += std::numbers::ln2 *
                       (taken_out_[k] + largest_[k] + std::log2(total_[k]));
  }
}

void Expectation::Start(int lane, int t) {
  for (int s = 0; s < model_->shape().states; ++s) {
    const size_t cell = model_->Cell(s, lane);
    Predicted(t).mantissa[cell] = model_->start_mantissa()[cell];
    Predicted(t).exponent[cell] = model_->start_exponent()[cell];
  }
  for (int p = lane; p < model_->period(); p += model_->stride()) {
    largest_[p] = 0;
  }
  taken_out_[lane] = 0;
}

void Expectation::Leave(int lane) {
  for (size_t j = lane; j < plane_; j += model_->components()) share_[j] = 0;
}

void Expectation::Backward(const std::vector<Lane>& batch, int frames) {
  const int lanes = model_->components();
  const size_t front = model_->front();
  const HmmShape& shape = model_->shape();
  int started = lanes;
  for (int t = frames - 1; t >= 0; --t) {
    if (t == frames - 1) {
      Normalise(NormaliseStep{
          .cells = model_->cells(),
          .shares = {Belief(t).mantissa + front, Belief(t).exponent + front},
          .total = total_.data(),
          .largest_exponent = largest_.data(),
          .share = share_.data()});
      for (; started > 0 && batch[started - 1].first == frames; --started) {
        Leave(started - 1);
      }
    } else {
      next_share_.swap(share_);
      Smooth(SmoothStep{
          .cells = model_->cells(),
          .stride = lanes,
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
    }
    AddMoments(MomentStep{.cells = model_->cells(),
                          .dimensions = shape.dimensions,
                          .full = shape.full,
                          .plane = plane_,
                          .means = means_.data(),
                          .x = Observation(t),
                          .share = share_.data(),
                          .moments = moments_.data()});
    for (; started > 0 && batch[started - 1].first == t; --started) {
      for (size_t j = started - 1; j < plane_; j += lanes) {
        starts_[j] += share_[j];
      }
      Leave(started - 1);
    }
  }
}

double Expectation::Sum(const AlignedVector<double>& planes, size_t plane,
                        size_t state) const {
  const size_t lanes = model_->components();
  const double* first = &planes[plane * plane_ + state * lanes];
  return std::accumulate(first, first + lanes, 0.0);
}

std::vector<double> Expectation::starts() const {
  std::vector<double> out;
  for (int s = 0; s < model_->shape().states; ++s) {
    out.push_back(Sum(starts_, 0, s));
  }
  return out;
}

std::vector<double> Expectation::transitions() const {
  const int n = model_->shape().states;
  std::vector<double> out(static_cast<size_t>(n) * n, 0.0);
  for (int i = 0; i < n; ++i) {
    const int first = i + model_->shape().first_jump;
    for (int j = std::max(0, first);
         j < std::min(n, i + model_->shape().last_jump + 1); ++j) {
      out[static_cast<size_t>(i) * n + j] = Sum(taken_, j - first, i);
    }
  }
  return out;
}

std::vector<double> Expectation::occupancy() const {
  std::vector<double> out;
  for (int s = 0; s < model_->shape().states; ++s) {
    out.push_back(Sum(moments_, 0, s));
  }
  return out;
}

std::vector<double> Expectation::first_moment() const {
  std::vector<double> out;
  for (int s = 0; s < model_->shape().states; ++s) {
    for (int a = 0; a < model_->shape().dimensions; ++a) {
      out.push_back(Sum(moments_, MomentPlanes(a), s));
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
        out[(s * d + a) * d + b] = Sum(moments_, plane + b - first, s);
      }
    }
  }
  return out;
}

}  // namespace tactus
