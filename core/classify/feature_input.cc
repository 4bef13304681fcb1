#include "core/classify/feature_input.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"

namespace tactus {
namespace {

absl::Status CheckScaling(absl::string_view name,
                          const std::vector<FeatureScaling>& scaling,
                          size_t count) {
  if (scaling.size() != count) {
    return InvalidModel(absl::StrCat(name, " size"), scaling.size(),
                        absl::StrCat(count));
  }
  for (const FeatureScaling& s : scaling) {
    if (!std::isfinite(s.offset) || !std::isfinite(s.gain) || s.gain == 0) {
      return InvalidModel(name, absl::StrCat(s.offset, ", ", s.gain),
                          "finite with a gain other than 0");
    }
  }
  return absl::OkStatus();
}

}  // namespace

double TransformFeature(const FeatureSpec& spec, size_t index,
                        const FeatureVector& features) {
  const double value = features[static_cast<int>(spec.features[index])];
  const double offset = spec.log_offset[index];
  return offset == 0 ? value : std::log(std::max(value, 0.0) + offset);
}

void MakeInput(const FeatureSpec& spec,
               const std::vector<FeatureScaling>& scaling,
               const FeatureVector& features, std::span<double> out) {
  for (size_t i = 0; i < out.size(); ++i) {
    out[i] = (TransformFeature(spec, i, features) - scaling[i].offset) *
             scaling[i].gain;
  }
}

absl::Status Validate(const FeatureSpec& spec, bool has_lstm) {
  const size_t count = spec.features.size();
  if (count < 1 || count > kFeatureCount) {
    return InvalidModel("number of features", count, "1 to 3");
  }
  for (size_t i = 0; i < count; ++i) {
    if (std::count(spec.features.begin(), spec.features.end(),
                   spec.features[i]) != 1) {
      return InvalidModel("features", FeaturesToString(spec.features),
                          "without repeats");
    }
  }
  if (spec.log_offset.size() != count) {
    return InvalidModel("features.log_offset size", spec.log_offset.size(),
                        absl::StrCat(count));
  }
  for (double offset : spec.log_offset) {
    if (!(offset >= 0 && std::isfinite(offset))) {
      return InvalidModel("features.log_offset", offset, "finite, at least 0");
    }
  }
  TACTUS_RETURN_IF_ERROR(
      CheckScaling("features.hmm_scaling", spec.hmm_scaling, count));
  TACTUS_RETURN_IF_ERROR(CheckScaling("features.lstm_scaling",
                                      spec.lstm_scaling, has_lstm ? count : 0));
  if (!(spec.sample_rate_hz > 0 &&
        spec.sample_rate_hz <= limits::kMaxSampleRateHz)) {
    return InvalidModel(
        "features.sample_rate_hz", spec.sample_rate_hz,
        absl::StrCat("above 0 and at most ", limits::kMaxSampleRateHz));
  }
  return absl::OkStatus();
}

}  // namespace tactus
