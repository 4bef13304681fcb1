// File: odd_rates.h
//
// OddRates: the trials whose times have another rate than they state, for one
// remark about all of them.
//
//   OddRates odd;
//   odd.Add("0.csv", /*stated_hz=*/100, /*measured_hz=*/90);
//   odd.Add(trial);  // only if its rate is odd
//   if (!odd.empty()) Print(odd.Remark());
//
// Not thread-safe.
#pragma once

#include <string>

#include "core/data/trial.h"

namespace tactus::internal {

class OddRates {
 public:
  // The times of `name` have another rate than the stated one.
  void Add(const std::string& name, double stated_hz, double measured_hz);
  // Adds the trial if its times differ by more than 5 % (rate_check.h).
  void Add(const Trial& trial);

  bool empty() const { return count_ == 0; }
  // A sentence. Not of an empty object.
  std::string Remark() const;

 private:
  std::string first_;
  double stated_hz_ = 0;
  double least_hz_ = 0;
  double most_hz_ = 0;
  size_t count_ = 0;
};

}  // namespace tactus::internal
