// File: compiled_hmm.h
//
// A GaussianHmm made ready to score observations: emissions with their
// Cholesky factors, transitions by target state with the range of states each
// can be reached from, so that left-right models cost what their band holds.
//
//   TACTUS_ASSIGN_OR_RETURN(CompiledHmm hmm, CompiledHmm::Create(model));
//   ForwardFilter filter(hmm);
//
// Thread-safe: immutable. Filters refer to it; it must outlive them.
#pragma once

#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "core/hmm/gaussian_hmm.h"
#include "tests/reference/hmm/emission_table.h"

namespace tactus::internal {

class CompiledHmm {
 public:
  // Fails as Validate(model) does.
  static absl::StatusOr<CompiledHmm> Create(const GaussianHmm& model);

  // The states i with transition[i][j] > 0 lie in [first, last); the spans
  // hold transition[first..last)[j] and its logarithm.
  struct Incoming {
    int first;
    int last;
    const double* probability;
    const double* log_probability;
  };
  Incoming incoming(int state) const {
    const Range& range = ranges_[state];
    return {range.first, range.last, &probability_[range.offset],
            &log_probability_[range.offset]};
  }

  int states() const { return emissions_.states(); }          // N
  int dimensions() const { return emissions_.dimensions(); }  // D
  const EmissionTable& emissions() const { return emissions_; }
  std::span<const double> start() const { return start_; }          // [N]
  std::span<const double> log_start() const { return log_start_; }  // [N]

 private:
  struct Range {
    int first;
    int last;
    size_t offset;
  };

  explicit CompiledHmm(const GaussianHmm& model);

  EmissionTable emissions_;
  std::vector<double> start_;
  std::vector<double> log_start_;
  std::vector<Range> ranges_;  // [N]
  std::vector<double> probability_;
  std::vector<double> log_probability_;
};

}  // namespace tactus::internal
