#include "core/classify/input_spec.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"

namespace tactus::internal {
namespace {

absl::Status CheckInputs(absl::string_view name,
                         std::span<const ModelInput> inputs, int limit) {
  if (inputs.size() > static_cast<size_t>(limit)) {
    return InvalidModel(absl::StrCat("number of ", name, "s"), inputs.size(),
                        absl::StrCat("at most ", limit));
  }
  constexpr double kLargest = limits::kMaxInputScale;
  for (const ModelInput& input : inputs) {
    const absl::string_view cue = CueName(input.cue);
    if (!(input.log_offset >= 0 && input.log_offset <= kLargest)) {
      return InvalidModel(absl::StrCat("log_offset of ", name, " ", cue),
                          input.log_offset, absl::StrCat("0 to ", kLargest));
    }
    if (!(std::abs(input.offset) <= kLargest &&
          std::abs(input.gain) <= kLargest && input.gain != 0)) {
      return InvalidModel(
          absl::StrCat("scaling of ", name, " ", cue),
          absl::StrCat(input.offset, ", ", input.gain),
          absl::StrCat("within ", kLargest, " with a gain other than 0"));
    }
    if (!(input.limit > 0)) {
      return InvalidModel(absl::StrCat("limit of ", name, " ", cue),
                          input.limit, "above 0");
    }
  }
  return absl::OkStatus();
}

absl::Status CheckSteps(absl::string_view name, const StepIntervals& steps) {
  if (steps.min < 1 || steps.max < steps.min ||
      steps.max > limits::kMaxBridgedFrames) {
    return InvalidModel(
        name, absl::StrCat(steps.min, ", ", steps.max),
        absl::StrCat("1 <= min <= max <= ", limits::kMaxBridgedFrames));
  }
  if (steps.first > steps.min) {
    return InvalidModel(absl::StrCat("first of ", name), steps.first,
                        absl::StrCat("at most min, ", steps.min));
  }
  if (steps.divisor < 2 || steps.divisor > limits::kMaxBridgedFrames) {
    return InvalidModel(absl::StrCat("divisor of ", name), steps.divisor,
                        absl::StrCat("2 to ", limits::kMaxBridgedFrames));
  }
  return absl::OkStatus();
}

}  // namespace

double TransformCue(double value, double log_offset) {
  return log_offset == 0 ? value : std::log(std::max(value, 0.0) + log_offset);
}

double ScaleCue(const ModelInput& input, double value) {
  const double scaled =
      (TransformCue(value, input.log_offset) - input.offset) * input.gain;
  return std::clamp(scaled, -input.limit, input.limit);
}

void MakeInput(std::span<const ModelInput> inputs, CueTracker& cues,
               std::span<double> out) {
  for (size_t i = 0; i < out.size(); ++i) {
    out[i] = ScaleCue(inputs[i], cues.value(inputs[i].cue));
  }
}

std::vector<Feature> FeaturesUsed(const InputSpec& spec) {
  std::vector<Feature> used;
  for (int f = 0; f < kFeatureCount; ++f) {
    const Feature feature = static_cast<Feature>(f);
    auto needs = [&](const ModelInput& input) {
      return NeedsFeature(input.cue, feature);
    };
    if (std::any_of(spec.hmm.begin(), spec.hmm.end(), needs) ||
        std::any_of(spec.lstm.begin(), spec.lstm.end(), needs)) {
      used.push_back(feature);
    }
  }
  return used;
}

bool UsesProfile(const InputSpec& spec) {
  return (SourcesOf(CuesNeeded(spec, /*with_lstms=*/true)) & kFromProfile) != 0;
}

bool UsesTaxels(const InputSpec& spec) {
  return (SourcesOf(CuesNeeded(spec, /*with_lstms=*/true)) & kFromTaxels) != 0;
}

bool NeedsSkin(const InputSpec& spec) {
  return SourcesOf(CuesNeeded(spec, /*with_lstms=*/true)) != 0;
}

CueGroups CuesNeeded(const InputSpec& spec, bool with_lstms) {
  CueGroups groups = 0;
  for (const ModelInput& input : spec.hmm) groups |= GroupOf(input.cue);
  if (with_lstms) {
    for (const ModelInput& input : spec.lstm) groups |= GroupOf(input.cue);
  }
  return groups;
}

int CountUnused(CueGroups groups) {
  groups |= GroupOf(Cue::kForce);
  int count = 0;
  for (int i = 0; i < CueCount(); ++i) {
    count += (GroupOf(static_cast<Cue>(i)) & groups) == 0;
  }
  return count;
}

absl::Status Validate(const InputSpec& spec, bool has_hmms, bool has_lstm) {
  if (spec.hmm.empty() == has_hmms) {
    return InvalidModel("number of HMM inputs", spec.hmm.size(),
                        has_hmms ? "at least 1" : "0 without HMMs");
  }
  if (spec.lstm.empty() == has_lstm) {
    return InvalidModel("number of LSTM inputs", spec.lstm.size(),
                        has_lstm ? "at least 1" : "0 without an LSTM");
  }
  TACTUS_RETURN_IF_ERROR(
      CheckInputs("HMM input", spec.hmm, limits::kMaxHmmDimensions));
  TACTUS_RETURN_IF_ERROR(
      CheckInputs("LSTM input", spec.lstm, limits::kMaxLstmCells));
  TACTUS_RETURN_IF_ERROR(CheckSteps("hmm_steps", spec.hmm_steps));
  TACTUS_RETURN_IF_ERROR(CheckSteps("lstm_steps", spec.lstm_steps));
  if (!(spec.sample_rate_hz >= limits::kMinSampleRateHz &&
        spec.sample_rate_hz <= limits::kMaxSampleRateHz)) {
    return InvalidModel("inputs.sample_rate_hz", spec.sample_rate_hz,
                        absl::StrCat(limits::kMinSampleRateHz, " to ",
                                     limits::kMaxSampleRateHz));
  }
  return absl::OkStatus();
}

}  // namespace tactus::internal
