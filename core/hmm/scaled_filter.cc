#include "core/hmm/scaled_filter.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>

namespace tactus::internal {
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
      x_(model.observed_size()) {
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

// Before the first frame that is the start distribution.
template <typename T>
void ScaledFilter<T>::Predict(int to) {
  const Shares<T> before = Buffer(now_);
  const Shares<T> next = Buffer(to);
  if (started_) {
    model_->Predict(score_ == Score::kViterbi, before, next);
  } else {
    std::copy_n(before.mantissa, model_->padded(), next.mantissa);
    std::copy_n(before.exponent, model_->padded(), next.exponent);
    started_ = true;
  }
}

template <typename T>
void ScaledFilter<T>::Step(std::span<const double> observation) {
  model_->Observe(observation, x_.data());
  if (started_ &&
      model_->Advance(score_ == Score::kViterbi, x_.data(), largest_.data(),
                      Buffer(now_), Buffer(1 - now_))) {
    now_ = 1 - now_;
    return;
  }
  StepLowered(observation);
}

template <typename T>
void ScaledFilter<T>::StepLowered(std::span<const double> observation) {
  const bool started = started_;
  FindLargestShares();
  std::swap(lowered_, largest_);
  Predict(2);
  now_ = 1 - now_;
  const bool trusted = model_->Weigh(x_.data(), lowered_.data(),
                                     largest_.data(), Buffer(2), Buffer(now_));
  for (size_t p = 0; p < taken_out_.size(); ++p) {
    taken_out_[p] += static_cast<double>(lowered_[p]);
  }
  if constexpr (std::is_same_v<T, float>) {
    for (int k = 0; !trusted && k < model_->components(); ++k) {
      if (!(largest_[k] > Scaled<float>::kTrusted)) {
        RedoExactly(k, observation, started);
      }
    }
  }
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
  redo.UpdateTotals();
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
  for (int k = 0; k < missing; ++k) {
    Predict(1 - now_);
    now_ = 1 - now_;
  }
  FindLargestShares();
}

template <typename T>
void ScaledFilter<T>::FindLargestShares() {
  const Shares<T> shares = Buffer(now_);
  FindLargest(Reduction<T>{.best = score_ == Score::kViterbi,
                           .cells = model_->cells(),
                           .period = model_->period(),
                           .shares = {shares.mantissa + model_->front(),
                                      shares.exponent + model_->front()},
                           .largest_exponent = largest_.data(),
                           .total = nullptr});
  model_->Fold(largest_.data(), [](T a, T b) { return std::max(a, b); });
}

template <typename T>
void ScaledFilter<T>::UpdateTotals() {
  const bool best = score_ == Score::kViterbi;
  model_->Fold(largest_.data(), [](T a, T b) { return std::max(a, b); });
  const Shares<T> shares = Buffer(now_);
  Total(Reduction<T>{.best = best,
                     .cells = model_->cells(),
                     .period = model_->period(),
                     .shares = {shares.mantissa + model_->front(),
                                shares.exponent + model_->front()},
                     .largest_exponent = largest_.data(),
                     .total = total_.data()});
  model_->Fold(total_.data(),
               [best](T a, T b) { return best ? std::max(a, b) : a + b; });
}

template <typename T>
double ScaledFilter<T>::log_likelihood(int component) const {
  return std::numbers::ln2 *
         (exponent(component) + std::log2(total(component)));
}

template class ScaledFilter<float>;
template class ScaledFilter<double>;

}  // namespace tactus::internal
