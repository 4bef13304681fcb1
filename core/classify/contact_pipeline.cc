#include "core/classify/contact_pipeline.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"

namespace tactus {
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
    : uses_poses_(model->model().poses != PoseNeed::kIgnored),
      classifier_(model, options.decision, options.skip),
      tracker_(layout,
               {.sample_rate_hz = options.sample_rate_hz,
                .release_after_s = options.release_after_s == 0
                                       ? model->model().release_after_s
                                       : options.release_after_s,
                .load_profile = classifier_.uses_profile(),
                .taxel_loads = classifier_.uses_taxels(),
                .load_spread = classifier_.uses_spread(),
                .skip_untouched = options.skip[SkipRule::kUntouchedFrames],
                .reuse_unchanged = options.skip[SkipRule::kUnchangedFrames],
                .skip_quiet_rows = options.skip[SkipRule::kQuietRows]}),
      skip_(options.skip) {}

const ContactReport& ContactPipeline::Step(const FrameView& frame) {
  FrameView seen = frame;
  if (!uses_poses_) seen.pose = nullptr;
  report_.features = tracker_.Step(seen);
  report_.state = tracker_.state();
  report_.onset = tracker_.onset();
  report_.released = tracker_.released();
  report_.decided = false;
  CountSkipped();
  if (report_.onset) {
    ++report_.contact_id;
    classifier_.Reset();
  }
  if (report_.state == ContactState::kInContact) {
    // Frames lost before the onset belong to no contact.
    const uint64_t missing = report_.onset ? 0 : frame.missing_before;
    const bool decided_before = classifier_.decision().has_value();
    classifier_.StepOrHold(
        {report_.features.sample(), report_.features.touched}, missing);
    report_.decided = !decided_before && classifier_.decision().has_value();
  }
  return report_;
}

void ContactPipeline::CountSkipped() {
  skipped_[SkipRule::kUnchangedFrames] += tracker_.reused();
  skipped_[SkipRule::kQuietRows] += tracker_.quiet_rows();
  skipped_[SkipRule::kUntouchedFrames] +=
      skip_[SkipRule::kUntouchedFrames] && !report_.features.touched &&
      report_.state != ContactState::kInContact;
}

SkipCounters ContactPipeline::skipped() const {
  SkipCounters all = skipped_;
  all += classifier_.skipped();
  return all;
}

void ContactPipeline::EndTrial() {
  tracker_.Reset();
  classifier_.Reset();
  const uint64_t contacts = report_.contact_id;
  report_ = {};
  report_.contact_id = contacts;
}

}  // namespace tactus
