// File: resting_load.h
//
// RestingLoad: notices recordings whose skin reports contact from the first
// frame on, because it rests above its contact threshold.
//
//   RestingLoad resting;
//   for (const Trial& trial : trials) resting.Add(trial);
//   std::cerr << resting.Text();
//
// Not thread-safe.
#pragma once

#include <string>
#include <vector>

#include "core/data/trial.h"

namespace tactus::internal::client {

class RestingLoad {
 public:
  // Trials without a skin are passed over.
  void Add(const Trial& trial);
  // One line with what to do, or empty: nine of ten trials must begin with more
  // than half of their taxels in touch.
  std::string Text() const;

 private:
  size_t trials_ = 0;
  size_t loaded_ = 0;
  // The first of the loaded trials: its threshold, and its median taxel.
  double threshold_ = 0;
  double median_ = 0;
  std::vector<float> taxels_;
};

}  // namespace tactus::internal::client
