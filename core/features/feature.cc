#include "core/features/feature.h"

#include <algorithm>

#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "core/base/errors.h"

namespace tactus::internal {
namespace {

constexpr std::array<absl::string_view, kFeatureCount> kNames = {
    "force", "area", "motion"};

}  // namespace

absl::string_view FeatureName(Feature feature) {
  return kNames[static_cast<int>(feature)];
}

absl::StatusOr<std::vector<Feature>> ParseFeatures(absl::string_view text) {
  std::vector<Feature> features;
  for (absl::string_view part : absl::StrSplit(text, ',')) {
    int index = 0;
    while (index < kFeatureCount && part != kNames[index] &&
           part != kNames[index].substr(0, 1)) {
      ++index;
    }
    const Feature feature = static_cast<Feature>(index);
    const bool repeated =
        std::find(features.begin(), features.end(), feature) != features.end();
    if (index == kFeatureCount || repeated) {
      return InvalidConfig("features", text,
                           "one or more of f, a, m, each once, like f,m,a");
    }
    features.push_back(feature);
  }
  return features;
}

std::string FeaturesToString(const std::vector<Feature>& features) {
  return absl::StrJoin(features, ",", [](std::string* out, Feature feature) {
    out->push_back(FeatureName(feature).front());
  });
}

}  // namespace tactus::internal
