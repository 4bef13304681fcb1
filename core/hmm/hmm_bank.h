// File: hmm_bank.h
//
// All classes' HMMs of one model, packed so that they are scored together:
// components of one shape lie side by side, in float if its precision suffices,
// else in double. The score of a class is log sum_k weight_k p(o | hmm_k).
//
//   TACTUS_ASSIGN_OR_RETURN(HmmBank bank, HmmBank::Create(mixtures));
//   BankFilter filter(bank, Score::kForward);
//   filter.Step(observation);         // per frame
//   filter.Skip(3);                   // three frames were lost
//   filter.LogLikelihood(scores);     // one per class
//
// Precision, relative to the sum of the frames' absolute log-densities: 1e-6 in
// float and 1e-12 in double. See scaled_filter.h for outliers.
//
// Thread-safety: HmmBank is immutable; a BankFilter belongs to one stream. The
// bank must outlive its filters and must not move.
#pragma once

#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "core/hmm/mixture.h"
#include "core/hmm/scaled_filter.h"
#include "core/hmm/scaled_model.h"

namespace tactus::internal {

class HmmBank {
 public:
  // mixtures: one per class, at least one. Fails as Validate(mixture) does,
  // and with INVALID_MODEL if their dimensions differ.
  static absl::StatusOr<HmmBank> Create(std::span<const HmmMixture> mixtures);

  int dimensions() const { return dimensions_; }
  int classes() const { return static_cast<int>(first_.size()) - 1; }

 private:
  friend class BankFilter;

  // Components of one shape; `component` holds their indices, counted through
  // all classes.
  struct FloatGroup {
    std::vector<int> component;
    ScaledModel<float> model;
    std::vector<ScaledModel<double>> exact;
  };
  struct DoubleGroup {
    std::vector<int> component;
    ScaledModel<double> model;
  };

  HmmBank() = default;

  int dimensions_ = 0;
  std::vector<FloatGroup> floats_;
  std::vector<DoubleGroup> doubles_;
  // Mantissa and exponent of the weights of all classes' components in turn.
  std::vector<double> weight_mantissa_;
  std::vector<double> weight_exponent_;
  // Index of each class's first component, then the number of components.
  std::vector<int> first_;
};

class BankFilter {
 public:
  BankFilter(const HmmBank& bank, Score score);

  // As for ScaledFilter. None of them allocates.
  void Reset();
  void Step(std::span<const double> observation);
  void Skip(int missing);

  // Writes each class's log sum_k weight_k p(o_1 .. o_t | k), or of the best
  // paths, in nats; finite, 0 before the first frame. out: [classes]
  void LogLikelihood(std::span<double> out);

 private:
  const HmmBank* bank_;
  std::vector<ScaledFilter<float>> floats_;
  std::vector<ScaledFilter<double>> doubles_;
  // Weighted likelihood of every component: mantissa 2^exponent.
  std::vector<double> mantissa_;
  std::vector<double> exponent_;
  bool started_ = false;
};

}  // namespace tactus::internal
