#include "core/eval/evaluation.h"

#include "core/base/errors.h"

namespace tactus::internal {

absl::StatusOr<Algorithm> ParseAlgorithm(absl::string_view name) {
  if (name == "hmm") return Algorithm::kHmm;
  if (name == "lstm") return Algorithm::kLstm;
  if (name == "1nn") return Algorithm::kNearest;
  if (name == "fused") return Algorithm::kFused;
  return InvalidConfig("algorithm", name, "hmm, lstm, 1nn or fused");
}

absl::string_view AlgorithmName(Algorithm algorithm) {
  switch (algorithm) {
    case Algorithm::kHmm:
      return "hmm";
    case Algorithm::kLstm:
      return "lstm";
    case Algorithm::kNearest:
      return "1nn";
    case Algorithm::kFused:
      break;
  }
  return "fused";
}

}  // namespace tactus::internal
