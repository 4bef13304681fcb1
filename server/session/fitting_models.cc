#include "server/session/fitting_models.h"

#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/classify/contact_pipeline.h"
#include "core/skin/layout.h"

namespace tactus::server {

absl::Status NameFittingModels(const absl::Status& misfit,
                               const PinnedModel& named,
                               const StreamSettings& settings,
                               const ModelSource& models) {
  // A wrong config fits no model.
  const double rate = settings.pipeline.sample_rate_hz;
  if (!Validate(settings.layout).ok() || !(rate >= limits::kMinSampleRateHz) ||
      !(rate <= limits::kMaxSampleRateHz)) {
    return misfit;
  }
  std::vector<std::string> fitting;
  for (const PinnedModel& other : models.Newest()) {
    if (ContactPipeline::Check(settings.layout, *other.model, settings.pipeline)
            .ok()) {
      fitting.push_back(other.version_name);
    }
  }
  const std::string asked = absl::StrCat("the model is ", named.version_name);
  if (!fitting.empty()) {
    return Advise(misfit, absl::StrCat(asked, "; of this server's models, ",
                                       NameSome(fitting), " would do"));
  }
  return Advise(
      misfit,
      absl::StrCat(asked,
                   "; no model of this server would do, so train one: record "
                   "labelled trials with trainctl record or trainctl import, "
                   "then trainctl fit --data=TRIALS --out=BUNDLE and tactusd "
                   "--model=NAME=BUNDLE"));
}

}  // namespace tactus::server
