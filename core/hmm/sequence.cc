#include "core/hmm/sequence.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"

namespace tactus::internal {

absl::Status Validate(const std::vector<SequenceView>& sequences) {
  if (sequences.empty()) {
    return InvalidTrainingData("there are no sequences; at least 1 is needed");
  }
  const int d = sequences.front().dimensions;
  if (d < 1 || d > limits::kMaxHmmDimensions) {
    return InvalidTrainingData(
        absl::StrCat("sequences have ", d, " dimensions; 1 to ",
                     limits::kMaxHmmDimensions, " would be right"));
  }
  for (size_t s = 0; s < sequences.size(); ++s) {
    const SequenceView& sequence = sequences[s];
    if (sequence.frames < 1 || sequence.data == nullptr) {
      return InvalidTrainingData(
          absl::StrCat("sequence ", s, " has no frames; at least 1 is needed"));
    }
    if (sequence.dimensions != d) {
      return InvalidTrainingData(
          absl::StrCat("sequence ", s, " has ", sequence.dimensions,
                       " dimensions; ", d, " would be right"));
    }
    for (int t = 0; t < sequence.frames; ++t) {
      for (const double value : sequence.frame(t)) {
        if (!std::isfinite(value)) {
          return InvalidTrainingData(absl::StrCat("sequence ", s, " frame ", t,
                                                  " holds ", value,
                                                  "; finite would be right"));
        }
      }
    }
  }
  return absl::OkStatus();
}

size_t TotalFrames(const std::vector<SequenceView>& sequences) {
  size_t frames = 0;
  for (const SequenceView& sequence : sequences) frames += sequence.frames;
  return frames;
}

FrameMoments ComputeFrameMoments(const std::vector<SequenceView>& sequences) {
  const int d = sequences.front().dimensions;
  const double frames = static_cast<double>(TotalFrames(sequences));
  FrameMoments moments{std::vector<double>(d), std::vector<double>(d)};
  for (const SequenceView& sequence : sequences) {
    for (int t = 0; t < sequence.frames; ++t) {
      for (int k = 0; k < d; ++k) moments.mean[k] += sequence.frame(t)[k];
    }
  }
  for (double& mean : moments.mean) mean /= frames;
  for (const SequenceView& sequence : sequences) {
    for (int t = 0; t < sequence.frames; ++t) {
      for (int k = 0; k < d; ++k) {
        const double difference = sequence.frame(t)[k] - moments.mean[k];
        moments.variance[k] += difference * difference;
      }
    }
  }
  for (double& variance : moments.variance) variance /= frames;
  return moments;
}

}  // namespace tactus::internal
