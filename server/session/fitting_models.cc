#include "server/session/fitting_models.h"

#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/classify/contact_pipeline.h"
#include "core/skin/layout.h"

namespace tactus::internal::server {
namespace {

constexpr char kHowToTrain[] =
    "train one: record labelled trials with trainctl record or trainctl "
    "import, then trainctl fit --data=TRIALS --out=BUNDLE and tactusd "
    "--model=NAME=BUNDLE";

absl::Status Fits(const PinnedModel& pinned, const StreamSettings& settings) {
  return ContactPipeline::Check(settings.layout, *pinned.model,
                                settings.pipeline);
}

// "models/M" of "models/M/versions/V".
std::string ModelOf(const PinnedModel& pinned) {
  return pinned.version_name.substr(0, pinned.version_name.find("/versions/"));
}

// "models/M/versions/V needs cody-forearm 16x24 at 100 Hz with poses".
std::string NeedsOf(const PinnedModel& pinned) {
  const Model& model = pinned.model->model();
  std::string text = absl::StrCat(pinned.version_name, " needs ");
  if (model.layout.name.empty()) {
    text += "any skin";
  } else {
    absl::StrAppend(&text, model.layout.name, " ", model.layout.rows, "x",
                    model.layout.columns);
    text +=
        model.layout.unit == TaxelUnit::kNewton ? " in newtons" : " in counts";
  }
  absl::StrAppend(&text, " at ", model.inputs.sample_rate_hz, " Hz");
  if (model.poses == PoseNeed::kNeeded) text += " with poses";
  return text;
}

// `misfit`, with what can be done.
absl::Status Advised(const absl::Status& misfit,
                     const std::vector<PinnedModel>& models,
                     const StreamSettings& settings) {
  std::vector<std::string> fitting;
  std::vector<std::string> needs;
  for (const PinnedModel& model : models) {
    if (Fits(model, settings).ok()) fitting.push_back(model.version_name);
    needs.push_back(NeedsOf(model));
  }
  if (!fitting.empty()) {
    return Advise(misfit, absl::StrCat("of this server's models, ",
                                       NameSome(fitting), " would do"));
  }
  return Advise(misfit, absl::StrCat("no model of this server would do: ",
                                     NameSome(needs), "; ", kHowToTrain));
}

}  // namespace

absl::StatusOr<PinnedModel> FindModel(const ModelSource& models,
                                      StreamSettings& settings) {
  const bool is_named = !settings.model.empty();
  const auto found = models.Find(settings.model, settings.client_id);
  if (!found.ok() && is_named) return found.status();
  absl::Status misfit = found.status();
  if (found.ok()) {
    misfit = Fits(*found, settings);
    if (misfit.ok()) return *found;
  }
  const std::vector<PinnedModel> all = models.Newest();
  if (is_named) {
    return Advised(
        Advise(misfit, absl::StrCat("the model is ", found->version_name)), all,
        settings);
  }
  for (const PinnedModel& model : all) {
    const absl::Status fits = Fits(model, settings);
    if (fits.ok()) {
      settings.model = ModelOf(model);
      return model;
    }
    // Without a default, the first model's misfit.
    if (ReasonOf(misfit) == "MODEL_NOT_FOUND") misfit = fits;
  }
  return all.empty() ? misfit : Advised(misfit, all, settings);
}

}  // namespace tactus::internal::server
