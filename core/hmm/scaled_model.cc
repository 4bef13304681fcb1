#include "core/hmm/scaled_model.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <type_traits>
#include <utility>
#include <vector>

#include "Eigen/Cholesky"
#include "Eigen/Core"

namespace tactus::internal {
namespace {

using Matrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

int RoundUp(int value, int unit) { return (value + unit - 1) / unit * unit; }

// Lower Cholesky factor of a state's covariance.
Matrix Factor(const GaussianHmm& model, int state) {
  const int d = model.dimensions;
  Matrix covariance(d, d);
  FullCovariance(model, state, covariance.data());
  if (model.covariance_type == CovarianceType::kFull) {
    return covariance.llt().matrixL();
  }
  return covariance.diagonal().cwiseSqrt().asDiagonal();
}

Matrix InverseFactor(const Matrix& factor) {
  return factor.triangularView<Eigen::Lower>().solve(
      Matrix::Identity(factor.rows(), factor.cols()));
}

// log2 of the density's normalising constant.
double LogConstant(const Matrix& factor) {
  return -0.5 * static_cast<double>(factor.rows()) *
             std::log2(2 * std::numbers::pi) -
         factor.diagonal().array().log().sum() / std::numbers::ln2;
}

}  // namespace

HmmShape ShapeOf(const GaussianHmm& model) {
  HmmShape shape = {.states = model.states,
                    .dimensions = model.dimensions,
                    .full = model.dimensions > 1 &&
                            model.covariance_type == CovarianceType::kFull};
  for (int i = 0; i < model.states; ++i) {
    for (int j = 0; j < model.states; ++j) {
      if (model.transition[static_cast<size_t>(i) * model.states + j] > 0) {
        shape.first_jump = std::min(shape.first_jump, j - i);
        shape.last_jump = std::max(shape.last_jump, j - i);
      }
    }
  }
  return shape;
}

std::vector<double> UnitScale(int dimensions) {
  return std::vector<double>(dimensions, 1.0);
}

std::vector<double> BalancedScale(
    const std::vector<const GaussianHmm*>& models) {
  const int d = models.front()->dimensions;
  std::vector<double> scale(d, 0.0);
  double states = 0;
  std::vector<double> covariance(static_cast<size_t>(d) * d);
  for (const GaussianHmm* model : models) {
    for (int s = 0; s < model->states; ++s) {
      FullCovariance(*model, s, covariance.data());
      for (int k = 0; k < d; ++k) {
        scale[k] += 0.5 * std::log2(covariance[k * d + k]);
      }
    }
    states += model->states;
  }
  for (double& s : scale) {
    s = std::ldexp(1.0, -static_cast<int>(std::lround(s / states)));
  }
  return scale;
}

bool FitsFloat(const GaussianHmm& model, const std::vector<double>& scale) {
  // The squares and products of such numbers are well within float's range.
  constexpr double kLargest = 1e12;
  // Largest factor by which a row of the inverse may amplify rounding errors.
  constexpr double kMaxAmplification = 256;
  const int d = model.dimensions;
  const Eigen::Map<const Eigen::VectorXd> factors(scale.data(), d);
  for (int s = 0; s < model.states; ++s) {
    const Matrix factor = factors.asDiagonal() * Factor(model, s);
    const Matrix inverse = InverseFactor(factor);
    const double amplification =
        (inverse.cwiseAbs() * factor.cwiseAbs()).rowwise().sum().maxCoeff();
    const Eigen::Map<const Eigen::VectorXd> mean(
        &model.means[static_cast<size_t>(s) * d], d);
    const double largest =
        std::max({inverse.cwiseAbs().maxCoeff(), factor.cwiseAbs().maxCoeff(),
                  mean.cwiseProduct(factors).cwiseAbs().maxCoeff()});
    if (!(amplification < kMaxAmplification && largest < kLargest)) {
      return false;
    }
  }
  return true;
}

template <typename T>
void SplitProbability(double p, T& mantissa, T& exponent) {
  if (!(p > 0)) {
    mantissa = 1;
    exponent = Scaled<T>::kNothing;
    return;
  }
  int power = 0;
  mantissa = static_cast<T>(2 * std::frexp(p, &power));
  exponent = static_cast<T>(power - 1);
}

template <typename T>
ScaledModel<T>::ScaledModel(const std::vector<const GaussianHmm*>& models,
                            std::vector<double> scale)
    : shape_(ShapeOf(*models.front())),
      scale_(std::move(scale)),
      components_(static_cast<int>(models.size())) {
  const int k = components_;
  stride_ = k < kBlock
                ? static_cast<int>(std::bit_ceil(static_cast<unsigned>(k)))
                : RoundUp(k, kBlock);
  period_ = std::max(stride_, kPattern<T>);
  const int in_blocks = RoundUp(cells(), kBlock);
  // Predict looks back along a jump, Smooth ahead.
  front_ = RoundUp(std::max(shape_.last_jump, -shape_.first_jump) * stride_,
                   kPattern<T>);
  padded_ = front_ + in_blocks + front_;
  zeros_.assign(period_, T{0});
  const int d = shape_.dimensions;
  rows_ = (std::is_same_v<T, float> ? 2 : 1) * d +
          (shape_.full ? d * (d + 1) / 2 : d) + 1;
  const int jumps = shape_.last_jump - shape_.first_jump + 1;
  emissions_.assign(static_cast<size_t>(in_blocks) * rows_, T{0});
  transitions_.assign(static_cast<size_t>(in_blocks) * jumps * 2, T{1});
  // Transitions have probability 0, except that padding components stay in
  // their state.
  for (int cell = 0; cell < in_blocks; ++cell) {
    const bool padding = cell < cells() && cell % stride_ >= components_;
    for (int q = 0; q < jumps; ++q) {
      const bool stays = padding && shape_.first_jump + q == 0;
      transitions_[(static_cast<size_t>(cell / kBlock) * jumps + q) * 2 *
                       kBlock +
                   kBlock + cell % kBlock] = stays ? 0 : Scaled<T>::kNothing;
    }
  }
  start_mantissa_.resize(padded_);
  start_exponent_.resize(padded_);
  Clear(start_mantissa_.data(), start_exponent_.data(), 1);
  for (int c = 0; c < k; ++c) {
    if (c > 0 && models[c] == models[c - 1]) {
      CopyPrevious(c);
      continue;
    }
    PackEmissions(*models[c], c);
    PackTransitions(*models[c], c);
    for (int s = 0; s < shape_.states; ++s) {
      SplitProbability(models[c]->start[s], start_mantissa_[Cell(s, c)],
                       start_exponent_[Cell(s, c)]);
    }
  }
}

template <typename T>
void ScaledModel<T>::CopyPrevious(int component) {
  const int parameters = 2 * (shape_.last_jump - shape_.first_jump + 1);
  for (int s = 0; s < shape_.states; ++s) {
    const size_t cell = static_cast<size_t>(s) * stride_ + component;
    const auto copy = [cell](AlignedVector<T>& values, int rows) {
      for (int r = 0; r < rows; ++r) {
        const auto at = [&](size_t c) {
          return (c / kBlock * rows + r) * kBlock + c % kBlock;
        };
        values[at(cell)] = values[at(cell - 1)];
      }
    };
    copy(emissions_, rows_);
    copy(transitions_, parameters);
    start_mantissa_[front_ + cell] = start_mantissa_[front_ + cell - 1];
    start_exponent_[front_ + cell] = start_exponent_[front_ + cell - 1];
  }
}

template <typename T>
void ScaledModel<T>::PackEmissions(const GaussianHmm& model, int component) {
  // |z|^2 / 2 in bits is |gain z|^2.
  const double gain = std::sqrt(0.5 * std::numbers::log2e);
  const int d = shape_.dimensions;
  for (int s = 0; s < shape_.states; ++s) {
    const size_t cell = static_cast<size_t>(s) * stride_ + component;
    T* row = &emissions_[cell / kBlock * rows_ * kBlock + cell % kBlock];
    const auto put = [&row](double value) {
      *row = static_cast<T>(value);
      row += kBlock;
    };
    const Matrix factor = Factor(model, s);
    // Rows of the inverse factor, for scaled observations and in bits.
    Matrix row_factors = gain * InverseFactor(factor);
    for (int i = 0; i < d; ++i) row_factors.col(i) /= scale_[i];
    Eigen::VectorXd rest(d);
    for (int i = 0; i < d; ++i) {
      const double mean =
          model.means[static_cast<size_t>(s) * d + i] * scale_[i];
      rest[i] = mean - static_cast<double>(static_cast<T>(mean));
      put(mean);
      if constexpr (std::is_same_v<T, float>) {
        put(row_factors.row(i).head(i + 1).dot(rest.head(i + 1)));
      }
      put(row_factors(i, i));
      for (int j = 0; shape_.full && j < i; ++j) put(row_factors(i, j));
    }
    put(LogConstant(factor));
  }
}

template <typename T>
void ScaledModel<T>::PackTransitions(const GaussianHmm& model, int component) {
  const int jumps = shape_.last_jump - shape_.first_jump + 1;
  for (int j = 0; j < shape_.states; ++j) {
    const size_t cell = static_cast<size_t>(j) * stride_ + component;
    T* parameters =
        &transitions_[cell / kBlock * jumps * 2 * kBlock + cell % kBlock];
    for (int q = 0; q < jumps; ++q) {
      const int i = j - shape_.first_jump - q;
      if (i < 0 || i >= shape_.states) continue;
      SplitProbability(
          model.transition[static_cast<size_t>(i) * shape_.states + j],
          parameters[2 * q * kBlock], parameters[(2 * q + 1) * kBlock]);
    }
  }
}

template <typename T>
void ScaledModel<T>::Clear(T* mantissa, T* exponent, size_t count) const {
  std::fill_n(mantissa, count * padded_, T{1});
  std::fill_n(exponent, count * padded_, Scaled<T>::kNothing);
  for (size_t r = 0; r < count; ++r) {
    for (int s = 0; s < shape_.states; ++s) {
      std::fill_n(exponent + r * padded_ + Cell(s, components_),
                  stride_ - components_, T{0});
    }
  }
}

template <typename T>
PredictStep<T> ScaledModel<T>::Prediction(bool best, Shares<T> from,
                                          Shares<T> to) const {
  return {.best = best,
          .cells = cells(),
          .stride = stride_,
          .first_jump = shape_.first_jump,
          .jumps = shape_.last_jump - shape_.first_jump + 1,
          .transitions = transitions_.data(),
          .from = {from.mantissa + front_, from.exponent + front_},
          .to = {to.mantissa + front_, to.exponent + front_}};
}

template <typename T>
WeighStep<T> ScaledModel<T>::Weighing(const T* x, const T* lowered,
                                      T* largest_exponent, Shares<T> from,
                                      Shares<T> to) const {
  return {.cells = cells(),
          .stride = stride_,
          .period = period_,
          .dimensions = shape_.dimensions,
          .full = shape_.full,
          .emissions = emissions_.data(),
          .x = x,
          .lowered = lowered,
          .largest_exponent = largest_exponent,
          .from = {from.mantissa + front_, from.exponent + front_},
          .to = {to.mantissa + front_, to.exponent + front_}};
}

template <typename T>
void ScaledModel<T>::Predict(bool best, Shares<T> from, Shares<T> to) const {
  tactus::internal::Predict(Prediction(best, from, to));
}

template <typename T>
bool ScaledModel<T>::Advance(bool best, const T* x, T* largest_exponent,
                             Shares<T> from, Shares<T> to) const {
  return tactus::internal::Advance(
      AdvanceStep<T>{Prediction(best, from, to),
                     Weighing(x, zeros_.data(), largest_exponent, from, to)});
}

template <typename T>
void ScaledModel<T>::WeighOnce(const T* x, const T* lowered,
                               T* largest_exponent, Shares<T> from,
                               Shares<T> to) const {
  tactus::internal::Weigh(Weighing(x, lowered, largest_exponent, from, to));
  Fold(largest_exponent, [](T a, T b) { return std::max(a, b); });
}

template <typename T>
bool ScaledModel<T>::Weigh(const T* x, T* lowered, T* largest_exponent,
                           Shares<T> from, Shares<T> to) const {
  WeighOnce(x, lowered, largest_exponent, from, to);
  if (std::count_if(largest_exponent, largest_exponent + period_,
                    [](T l) { return !(l > Scaled<T>::kTrusted); }) == 0) {
    return true;
  }
  if constexpr (std::is_same_v<T, double>) {
    // Computes the densities alone, with shares of 1; `to` serves as a buffer.
    Clear(to.mantissa, to.exponent, 1);
    for (int s = 0; s < shape_.states; ++s) {
      std::fill_n(to.exponent + Cell(s, 0), stride_, T{0});
    }
    WeighOnce(x, zeros_.data(), largest_exponent, to, to);
    for (int p = 0; p < period_; ++p) lowered[p] += largest_exponent[p];
    WeighOnce(x, lowered, largest_exponent, from, to);
  }
  return false;
}

template <typename T>
size_t ScaledModel<T>::observed_size() const {
  return static_cast<size_t>(shape_.dimensions) *
         (std::is_same_v<T, float> ? 2 : period_);
}

template <typename T>
void ScaledModel<T>::Observe(std::span<const double> observation, T* x) const {
  const int d = shape_.dimensions;
  if constexpr (std::is_same_v<T, float>) {
    for (int k = 0; k < d; ++k) {
      const double scaled = observation[k] * scale_[k];
      x[k] = static_cast<float>(scaled);
      x[d + k] = static_cast<float>(scaled - static_cast<double>(x[k]));
    }
  } else {
    for (int k = 0; k < d; ++k) {
      std::fill_n(x + k * period_, period_, observation[k] * scale_[k]);
    }
  }
}

template class ScaledModel<float>;
template class ScaledModel<double>;
template void SplitProbability(double, float&, float&);
template void SplitProbability(double, double&, double&);

}  // namespace tactus::internal
