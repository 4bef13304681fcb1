// File: learning_curves.h
//
// LearningCurves: the loss or likelihood of each part of a training, and the
// curve of the present part as it stands at the end of a progress line.
//
//   LearningCurves curves;
//   curves.Add("train LSTMs 1", 0.35, /*likelihood=*/false);
//   curves.Text();  // "█▄▂▁ 0.2113"
//
// Parts are trained side by side, so their values come mixed: the present part
// is that of the last value. Owns its values; one thread at a time.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace tactus::internal::client {

class LearningCurves {
 public:
  // `likelihood`: the value is a log-likelihood, whose first one belongs to the
  // guess that training begins with. It lies so far below the others that they
  // would look equal, so the curve leaves it out.
  void Add(const std::string& part, double value, bool likelihood);

  // Empty without values.
  std::string Text() const;

 private:
  std::map<std::string, std::vector<double>> curves_;
  std::string part_;
  bool likelihood_ = false;
};

}  // namespace tactus::internal::client
