#include "core/hmm/scaled_filter.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>

namespace tactus {
namespace {

// A frame's largest share must not fall below this many bits.
template <typename T>
constexpr T kTrusted = std::is_same_v<T, float> ? T{-0x1p20} : T{-0x1p40};

}  // namespace

template <typename T>
ScaledFilter<T>::ScaledFilter(const ScaledModel<T>& model,
                              std::span<const ScaledModel<double>> exact,
                              Score score)
    : model_(&model),
      exact_(exact),
      score_(score),
      mantissa_(3 * model.padded()),
      exponent_(3 * model.padded()),
      largest_(model.period()),
      lowered_(model.period()),
      total_(model.period()),
      taken_out_(model.period()),
      x_(2 * static_cast<size_t>(model.shape().dimensions)) {
  model.Clear(mantissa_.data(), exponent_.data(), 3);
  if constexpr (std::is_same_v<T, float>) {
    redo_ = std::make_unique<ScaledFilter<double>>(
        exact.front(), std::span<const ScaledModel<double>>(), score);
  }
  Reset();
}

template <typename T>
void ScaledFilter<T>::Reset() {
  started_ = false;
  std::ranges::copy(model_->start_mantissa(), Buffer(now_).mantissa);
  std::ranges::copy(model_->start_exponent(), Buffer(now_).exponent);
  std::ranges::fill(taken_out_, 0.0);
  std::ranges::fill(largest_, T{0});
}

// Buffer now_ becomes the distribution of the next frame's state, the other one
// that before. Before the first frame that is the start distribution.
template <typename T>
void ScaledFilter<T>::PredictNext() {
  const Shares<T> from = Buffer(now_);
  now_ = 1 - now_;
  const Shares<T> to = Buffer(now_);
  if (started_) {
    model_->Predict(score_ == Score::kViterbi, from, to);
  } else {
    std::copy_n(from.mantissa, model_->padded(), to.mantissa);
    std::copy_n(from.exponent, model_->padded(), to.exponent);
    started_ = true;
  }
}

template <typename T>
template <typename Combine>
void ScaledFilter<T>::Fold(T* pattern, Combine combine) const {
  for (int width = kBlock / 2; width >= model_->stride(); width /= 2) {
    for (int l = 0; l < width; ++l) {
      pattern[l] = combine(pattern[l], pattern[l + width]);
    }
  }
  for (int l = model_->stride(); l < kBlock; ++l) {
    pattern[l] = pattern[l - model_->stride()];
  }
}

template <typename T>
void ScaledFilter<T>::Weigh() {
  model_->Weigh(x_.data(), lowered_.data(), largest_.data(), Buffer(now_));
  Fold(largest_.data(), [](T a, T b) { return std::max(a, b); });
  for (size_t p = 0; p < taken_out_.size(); ++p) {
    taken_out_[p] += static_cast<double>(lowered_[p]);
  }
}

template <typename T>
void ScaledFilter<T>::Step(std::span<const double> observation) {
  const bool started = started_;
  model_->Split(observation, x_.data());
  PredictNext();
  std::swap(lowered_, largest_);
  Weigh();
  if (std::ranges::count_if(
          largest_, [](T largest) { return !(largest > kTrusted<T>); }) == 0) {
    return;
  }
  if constexpr (std::is_same_v<T, float>) {
    for (int k = 0; k < model_->components(); ++k) {
      if (!(largest_[k] > kTrusted<T>)) RedoExactly(k, observation, started);
    }
  } else {
    now_ = 1 - now_;
    started_ = started;
    WeighRelativeToBest();
  }
}

// The same step, but each component's largest density is taken out before
// anything is added: those of far outliers differ by little.
template <typename T>
void ScaledFilter<T>::WeighRelativeToBest() {
  const Shares<T> ones = Buffer(2);
  model_->Clear(ones.mantissa, ones.exponent, 1);
  for (int s = 0; s < model_->shape().states; ++s) {
    std::fill_n(ones.exponent + model_->Cell(s, 0), model_->components(), T{0});
  }
  std::ranges::fill(total_, T{0});
  model_->Weigh(x_.data(), total_.data(), largest_.data(), ones);
  Fold(largest_.data(), [](T a, T b) { return std::max(a, b); });
  for (size_t p = 0; p < taken_out_.size(); ++p) {
    taken_out_[p] -= lowered_[p];
    lowered_[p] += largest_[p];
  }
  PredictNext();
  Weigh();
}

template <typename T>
void ScaledFilter<T>::RedoExactly(int component,
                                  std::span<const double> observation,
                                  bool started) {
  ScaledFilter<double>& redo = *redo_;
  const ScaledModel<double>& exact = exact_[component];
  redo.model_ = &exact;
  redo.Reset();
  redo.started_ = started;
  const Shares<T> before = Buffer(1 - now_);
  const Shares<double> from = redo.Buffer(redo.now_);
  for (int s = 0; s < model_->shape().states; ++s) {
    from.mantissa[exact.Cell(s, 0)] =
        before.mantissa[model_->Cell(s, component)];
    // Nothing has another value in double.
    const T exponent = before.exponent[model_->Cell(s, component)];
    from.exponent[exact.Cell(s, 0)] = exponent > Scaled<T>::kNothing
                                          ? static_cast<double>(exponent)
                                          : Scaled<double>::kNothing;
  }
  redo.Step(observation);
  const Shares<double> result = redo.Buffer(redo.now_);
  const Shares<T> after = Buffer(now_);
  const double largest = redo.largest_[0];
  for (int s = 0; s < model_->shape().states; ++s) {
    const size_t to = model_->Cell(s, component);
    after.mantissa[to] = static_cast<T>(result.mantissa[exact.Cell(s, 0)]);
    after.exponent[to] =
        static_cast<T>(std::max(result.exponent[exact.Cell(s, 0)] - largest,
                                static_cast<double>(Scaled<T>::kNothing)));
  }
  for (size_t p = component; p < taken_out_.size(); p += model_->stride()) {
    taken_out_[p] += redo.taken_out_[0] + largest - lowered_[p];
    largest_[p] = 0;
  }
}

template <typename T>
void ScaledFilter<T>::Skip(int missing) {
  if (missing <= 0) return;
  for (int k = 0; k < missing; ++k) PredictNext();
  const Shares<T> shares = Buffer(now_);
  FindLargest(Reduction<T>{.best = score_ == Score::kViterbi,
                           .cells = model_->cells(),
                           .period = model_->period(),
                           .shares = {shares.mantissa + model_->front(),
                                      shares.exponent + model_->front()},
                           .largest_exponent = largest_.data(),
                           .total = nullptr});
  Fold(largest_.data(), [](T a, T b) { return std::max(a, b); });
}

template <typename T>
void ScaledFilter<T>::UpdateTotals() {
  const bool best = score_ == Score::kViterbi;
  const Shares<T> shares = Buffer(now_);
  Total(Reduction<T>{.best = best,
                     .cells = model_->cells(),
                     .period = model_->period(),
                     .shares = {shares.mantissa + model_->front(),
                                shares.exponent + model_->front()},
                     .largest_exponent = largest_.data(),
                     .total = total_.data()});
  Fold(total_.data(),
       [best](T a, T b) { return best ? std::max(a, b) : a + b; });
}

template <typename T>
double ScaledFilter<T>::log_likelihood(int component) const {
  return std::numbers::ln2 *
         (exponent(component) + std::log2(total(component)));
}

template class ScaledFilter<float>;
template class ScaledFilter<double>;

}  // namespace tactus
