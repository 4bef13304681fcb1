#include "core/classify/contact_pipeline.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/classify/input_spec.h"

namespace tactus::internal {
namespace {

// A larger difference of rates would change the meaning of a frame for the
// models.
constexpr double kRateTolerance = 0.05;

std::string Describe(const SkinLayout& layout) {
  return absl::StrCat(layout.name, " ", layout.rows, "x", layout.columns);
}

absl::Status CheckRate(double rate, double model_rate) {
  if (!(rate >= limits::kMinSampleRateHz && rate <= limits::kMaxSampleRateHz)) {
    return InvalidConfig("sample_rate_hz", rate,
                         absl::StrCat(limits::kMinSampleRateHz, " to ",
                                      limits::kMaxSampleRateHz));
  }
  if (std::abs(rate / model_rate - 1) > kRateTolerance) {
    return InvalidConfig(
        "sample_rate_hz", rate,
        absl::StrCat("within 5 % of the model's ", model_rate));
  }
  return absl::OkStatus();
}

absl::Status CheckSkin(const SkinLayout& layout, const Model& model) {
  const std::string misfit = SkinMisfit(model, layout);
  if (misfit.empty()) return absl::OkStatus();
  return GeometryMismatch(absl::StrCat(Describe(layout), " with ", misfit),
                          Describe(model.layout));
}

absl::Status CheckPoses(bool with_poses, const Model& model) {
  if (with_poses || model.poses != PoseNeed::kNeeded) return absl::OkStatus();
  return InvalidConfig("with_poses", "false",
                       "true, because the model measures motion by poses");
}

}  // namespace

int MostContacts(const Model& model, const ContactPipeline::Options& options) {
  if (options.max_contacts > 0) return options.max_contacts;
  const bool sees_skin = UsesProfile(model.inputs) || TaxelsNeeded(model) > 0;
  return sees_skin || options.release_after_s < 0 ? 1 : limits::kMaxContacts;
}

absl::Status ContactPipeline::Check(const SkinLayout& layout,
                                    const CompiledModel& model,
                                    const Options& options) {
  TACTUS_RETURN_IF_ERROR(Validate(layout));
  const Model& m = model.model();
  TACTUS_RETURN_IF_ERROR(
      CheckRate(options.sample_rate_hz, m.inputs.sample_rate_hz));
  TACTUS_RETURN_IF_ERROR(CheckSkin(layout, m));
  return CheckPoses(options.with_poses, m);
}

absl::StatusOr<std::unique_ptr<ContactPipeline>> ContactPipeline::Create(
    const SkinLayout& layout, const std::shared_ptr<const CompiledModel>& model,
    const Options& options) {
  TACTUS_RETURN_IF_ERROR(Check(layout, *model, options));
  return std::make_unique<ContactPipeline>(layout, model, options);
}

ContactPipeline::ContactPipeline(
    const SkinLayout& layout, const std::shared_ptr<const CompiledModel>& model,
    const Options& options)
    : model_(model),
      options_(options),
      uses_poses_(model->model().poses != PoseNeed::kIgnored),
      max_contacts_(MostContacts(model->model(), options)),
      classifiers_{std::make_unique<ContactClassifier>(model, options.decision,
                                                       options.skip)},
      tracker_(layout,
               {.sample_rate_hz = options.sample_rate_hz,
                .release_after_s = options.release_after_s == 0
                                       ? model->model().release_after_s
                                       : options.release_after_s,
                .max_contacts = max_contacts_,
                .load_profile = classifiers_[0]->uses_profile(),
                .taxel_loads = classifiers_[0]->uses_taxels(),
                .taxel_components = classifiers_[0]->uses_components(),
                .load_spread = classifiers_[0]->uses_spread(),
                .shear = classifiers_[0]->uses_shear(),
                .skip_untouched = options.skip[SkipRule::kUntouchedFrames],
                .reuse_unchanged = options.skip[SkipRule::kUnchangedFrames],
                .skip_quiet_rows = options.skip[SkipRule::kQuietRows]}) {}

std::span<const ContactReport> ContactPipeline::Step(const FrameView& frame) {
  FrameView seen = frame;
  if (!uses_poses_) seen.pose = nullptr;
  tracker_.Step(seen);
  count_ = 0;
  for (const TrackedContact* contact : tracker_.contacts()) {
    Report(*contact, frame, reports_[count_++]);
  }
  CountSkipped();
  return contacts();
}

void ContactPipeline::Report(const TrackedContact& contact,
                             const FrameView& frame, ContactReport& report) {
  ContactClassifier& classifier = ClassifierOf(contact.slot);
  report = {.id = contact.id(),
            .slot = contact.slot,
            .phase = contact.phase,
            .onset = contact.onset,
            .parent = contact.parent,
            .merged_into = contact.merged_into,
            .felt = !contact.track.unfelt(),
            .features = &contact.features(),
            .classifier = &classifier};
  if (report.released()) {
    ended_ = report;
    ended_.features = &no_features_;
    return;
  }
  if (report.onset) classifier.Reset();
  // Frames lost before the onset belong to no contact.
  const uint64_t missing = report.onset ? 0 : frame.missing_before;
  if (report.phase == TouchPhase::kMerged) {
    classifier.Hold(missing);
    return;
  }
  const FrameFeatures& features = contact.features();
  classifier.StepOrHold({features.sample(), features.touched}, missing);
}

ContactClassifier& ContactPipeline::ClassifierOf(int slot) {
  std::unique_ptr<ContactClassifier>& classifier = classifiers_[slot];
  if (classifier == nullptr) {
    classifier = std::make_unique<ContactClassifier>(model_, options_.decision,
                                                     options_.skip);
  }
  return *classifier;
}

const ContactReport* ContactPipeline::main_contact() const {
  for (const ContactReport& contact : contacts()) {
    if (!contact.released()) return &contact;
  }
  return ended_.id == 0 ? nullptr : &ended_;
}

void ContactPipeline::CountSkipped() {
  skipped_[SkipRule::kUnchangedFrames] += tracker_.reused();
  skipped_[SkipRule::kQuietRows] += tracker_.quiet_rows();
  const bool in_contact = std::ranges::any_of(
      contacts(),
      [](const ContactReport& contact) { return !contact.released(); });
  skipped_[SkipRule::kUntouchedFrames] +=
      options_.skip[SkipRule::kUntouchedFrames] && !tracker_.touched() &&
      !in_contact;
}

SkipCounters ContactPipeline::skipped() const {
  SkipCounters all = skipped_;
  for (const auto& classifier : classifiers_) {
    if (classifier != nullptr) all += classifier->skipped();
  }
  // Cues are counted once.
  all[SkipRule::kUnusedCues] =
      classifiers_[0]->skipped()[SkipRule::kUnusedCues];
  return all;
}

void ContactPipeline::EndTrial() {
  tracker_.Reset();
  for (const auto& classifier : classifiers_) {
    if (classifier != nullptr) classifier->Reset();
  }
  count_ = 0;
  ended_ = {};
}

}  // namespace tactus::internal
