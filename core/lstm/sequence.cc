#include "core/lstm/sequence.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::internal {
namespace {

bool AllFinite(std::span<const float> values) {
  return std::all_of(values.begin(), values.end(),
                     [](float value) { return std::isfinite(value); });
}

absl::Status Check(const LstmSequence& sequence, const LstmNetwork& network) {
  const size_t inputs = network.inputs();
  const size_t size = sequence.inputs.size();
  if (size == 0 || size % inputs != 0) {
    return InvalidTrainingData(absl::StrCat(
        "has ", size, " inputs; want one or more rows of ", inputs));
  }
  const size_t targets = size / inputs * network.regressions;
  if (!sequence.targets.empty() && sequence.targets.size() != targets) {
    return InvalidTrainingData(absl::StrCat("has ", sequence.targets.size(),
                                            " targets; want 0 or ", targets));
  }
  const auto unknown = [&](int label) {
    return label < 0 || label >= network.classes();
  };
  if (unknown(sequence.label)) {
    return InvalidTrainingData(absl::StrCat(
        "has label ", sequence.label, "; want 0 to ", network.classes() - 1));
  }
  const auto& labels = sequence.step_labels;
  if (!labels.empty() && labels.size() != size / inputs) {
    return InvalidTrainingData(absl::StrCat(
        "has ", labels.size(), " labels of steps; want 0 or ", size / inputs));
  }
  if (const auto bad = std::ranges::find_if(labels, unknown);
      bad != labels.end()) {
    return InvalidTrainingData(absl::StrCat(
        "has label ", *bad, " at a step; want 0 to ", network.classes() - 1));
  }
  if (!std::isfinite(sequence.weight) || sequence.weight < 0) {
    return InvalidTrainingData(absl::StrCat("has weight ", sequence.weight,
                                            "; want finite and at least 0"));
  }
  if (!AllFinite(sequence.inputs) || !AllFinite(sequence.targets)) {
    return InvalidTrainingData("has a number that is not finite");
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status Validate(std::span<const LstmSequence> sequences,
                      const LstmNetwork& network) {
  for (size_t i = 0; i < sequences.size(); ++i) {
    TACTUS_RETURN_IF_ERROR(
        Annotate(Check(sequences[i], network), absl::StrCat("sequence ", i)));
  }
  return absl::OkStatus();
}

}  // namespace tactus::internal
