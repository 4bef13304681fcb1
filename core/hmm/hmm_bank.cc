#include "core/hmm/hmm_bank.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::internal {
namespace {

// Terms of a sum that are this many bits below the largest do not change it.
constexpr double kNegligibleBits = -100;

// 2^n for whole n, -1022 <= n <= 0.
double PowerOfTwo(double n) {
  return std::bit_cast<double>(static_cast<uint64_t>(n + 1023) << 52);
}

using Groups = std::map<HmmShape, std::vector<int>>;

std::vector<const GaussianHmm*> Pick(
    const std::vector<const GaussianHmm*>& models,
    const std::vector<int>& indices) {
  std::vector<const GaussianHmm*> picked;
  for (const int k : indices) picked.push_back(models[k]);
  return picked;
}

template <typename Group, typename T>
void Collect(const std::vector<Group>& groups,
             std::vector<ScaledFilter<T>>& filters,
             std::vector<double>& mantissa, std::vector<double>& exponent) {
  for (size_t g = 0; g < groups.size(); ++g) {
    filters[g].UpdateTotals();
    const std::vector<int>& component = groups[g].component;
    for (size_t k = 0; k < component.size(); ++k) {
      mantissa[component[k]] = filters[g].total(static_cast<int>(k));
      exponent[component[k]] = filters[g].exponent(static_cast<int>(k));
    }
  }
}

}  // namespace

absl::StatusOr<HmmBank> HmmBank::Create(std::span<const HmmMixture> mixtures) {
  HmmBank bank;
  std::vector<const GaussianHmm*> models;
  for (const HmmMixture& mixture : mixtures) {
    TACTUS_RETURN_IF_ERROR(Validate(mixture));
    const int dimensions = mixture.components[0].dimensions;
    if (models.empty()) bank.dimensions_ = dimensions;
    if (dimensions != bank.dimensions_) {
      return InvalidModel("HMM dimensions", dimensions,
                          absl::StrCat(bank.dimensions_, ", as elsewhere"));
    }
    bank.first_.push_back(static_cast<int>(models.size()));
    for (const GaussianHmm& model : mixture.components) {
      models.push_back(&model);
    }
    for (const double log_weight : mixture.log_weight) {
      const double bits = log_weight / std::numbers::ln2;
      const double whole = std::floor(bits);
      bank.weight_mantissa_.push_back(std::exp2(bits - whole));
      bank.weight_exponent_.push_back(whole);
    }
  }
  if (models.empty()) {
    return InvalidModel("number of HMM mixtures", 0, "at least one");
  }
  bank.first_.push_back(static_cast<int>(models.size()));

  const std::vector<double> scale = BalancedScale(models);
  Groups floats, doubles;
  for (size_t k = 0; k < models.size(); ++k) {
    Groups& groups = FitsFloat(*models[k], scale) ? floats : doubles;
    groups[ShapeOf(*models[k])].push_back(static_cast<int>(k));
  }
  const std::vector<double> unit = UnitScale(bank.dimensions_);
  for (auto& [shape, component] : floats) {
    std::vector<ScaledModel<double>> exact;
    for (const int k : component) {
      exact.emplace_back(std::vector<const GaussianHmm*>{models[k]}, unit);
    }
    bank.floats_.push_back({component,
                            ScaledModel<float>(Pick(models, component), scale),
                            std::move(exact)});
  }
  for (auto& [shape, component] : doubles) {
    bank.doubles_.push_back(
        {component, ScaledModel<double>(Pick(models, component), unit)});
  }
  return bank;
}

BankFilter::BankFilter(const HmmBank& bank, Score score)
    : bank_(&bank),
      mantissa_(bank.weight_mantissa_.size()),
      exponent_(bank.weight_mantissa_.size()) {
  for (const HmmBank::FloatGroup& group : bank.floats_) {
    floats_.emplace_back(group.model, group.exact, score);
  }
  for (const HmmBank::DoubleGroup& group : bank.doubles_) {
    doubles_.emplace_back(group.model, std::span<const ScaledModel<double>>(),
                          score);
  }
}

void BankFilter::Reset() {
  started_ = false;
  for (auto& filter : floats_) filter.Reset();
  for (auto& filter : doubles_) filter.Reset();
}

void BankFilter::Step(std::span<const double> observation) {
  started_ = true;
  for (auto& filter : floats_) filter.Step(observation);
  for (auto& filter : doubles_) filter.Step(observation);
}

void BankFilter::Skip(int missing) {
  started_ = started_ || missing > 0;
  for (auto& filter : floats_) filter.Skip(missing);
  for (auto& filter : doubles_) filter.Skip(missing);
}

void BankFilter::LogLikelihood(std::span<double> out) {
  if (!started_) {
    std::ranges::fill(out, 0.0);
    return;
  }
  Collect(bank_->floats_, floats_, mantissa_, exponent_);
  Collect(bank_->doubles_, doubles_, mantissa_, exponent_);
  const std::vector<int>& first = bank_->first_;
  for (size_t c = 0; c + 1 < first.size(); ++c) {
    double largest = -std::numeric_limits<double>::infinity();
    for (int k = first[c]; k < first[c + 1]; ++k) {
      exponent_[k] += bank_->weight_exponent_[k];
      largest = std::max(largest, exponent_[k]);
    }
    double sum = 0;
    for (int k = first[c]; k < first[c + 1]; ++k) {
      const double behind = exponent_[k] - largest;
      if (behind > kNegligibleBits) {
        sum += mantissa_[k] * bank_->weight_mantissa_[k] * PowerOfTwo(behind);
      }
    }
    out[c] = std::numbers::ln2 * (largest + std::log2(sum));
  }
}

}  // namespace tactus::internal
