#include "core/data/recording/contact_cutter.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/data/frames/frames_trial.h"
#include "core/skin/taxel_values.h"

namespace tactus::internal {
namespace {

// What a trial has before its onset.
constexpr int64_t kBeforeNs = 1'000'000'000;

double Rate(const v1::StreamConfig& config) {
  return config.has_sample_rate_hz() ? config.sample_rate_hz() : 100;
}

ContactTracker::Options TrackerOptions(const v1::StreamConfig& config) {
  ContactTracker::Options options;
  options.sample_rate_hz = Rate(config);
  if (config.has_release_after_ms()) {
    options.release_after_s = config.release_after_ms() / 1e3;
  }
  return options;
}

}  // namespace

ContactCutter::ContactCutter(std::string path, const v1::StreamConfig& config,
                             const SkinLayout& layout)
    : path_(std::move(path)),
      layout_(layout),
      scale_(config.has_scale() ? config.scale() : 1),
      type_(config.taxel_type()),
      rate_hz_(Rate(config)),
      tracker_(layout, TrackerOptions(config)),
      taxels_(static_cast<size_t>(layout.values())) {}

absl::Status ContactCutter::Decode(const v1::FrameBatch& frame) {
  ScaleTaxels(type_, frame.taxels().data(), scale_, taxels_);
  const TaxelRange range = {layout_.signed_values ? -limits::kMaxTaxelValue : 0,
                            limits::kMaxTaxelValue};
  for (size_t i = 0; i < taxels_.size(); ++i) {
    if (range.Has(taxels_[i])) continue;
    return TrialFileInvalid(
        path_,
        absl::StrCat("taxel ", i / layout_.axes,
                     " of the frame with the sequence "
                     "number ",
                     frame.first_sequence(), " is ", taxels_[i],
                     "; it must be ", range.lowest, " to ", range.largest));
  }
  return absl::OkStatus();
}

absl::StatusOr<bool> ContactCutter::Add(const v1::FrameBatch& frame) {
  TACTUS_RETURN_IF_ERROR(Decode(frame));
  if (!has_first_) {
    has_first_ = true;
    first_ns_ = frame.first_capture_time_ns();
  }
  FrameView view{.taxels = taxels_};
  if (frame.poses_size() > 0) {
    pose_ = PoseOf(frame);
    view.pose = &pose_;
  }
  view.missing_before = in_trial_ ? frame.first_sequence() - sequence_ - 1 : 0;
  in_trial_ = true;
  sequence_ = frame.first_sequence();
  tracker_.Step(view);
  frames_.push_back(frame);
  const int64_t now_ns = frame.first_capture_time_ns();
  if (tracker_.onset()) {
    onset_s_ = static_cast<double>(now_ns - first_ns_) / 1e9;
  }
  if (tracker_.released()) {
    Cut();
    return true;
  }
  if (tracker_.onset() || tracker_.state() != ContactState::kInContact) {
    // Frames may come faster than they should.
    const auto most = static_cast<size_t>(2 * rate_hz_) + 1;
    while (now_ns - frames_.front().first_capture_time_ns() > kBeforeNs ||
           frames_.size() > most) {
      frames_.pop_front();
    }
  } else if (frames_.size() * frame.taxels().size() >
                 limits::kMaxTrialArrayBytes ||
             frames_.size() > limits::kMaxFramesPerTrial) {
    return TrialFileInvalid(
        path_,
        absl::StrCat("the contact ", onset_s_,
                     " s after the first frame is too long for a trial"));
  }
  return false;
}

bool ContactCutter::EndTrial() {
  const bool open = tracker_.state() == ContactState::kInContact;
  if (open) Cut();
  frames_.clear();
  in_trial_ = false;
  tracker_.Reset();
  return open;
}

void ContactCutter::Cut() { contact_ = std::exchange(frames_, {}); }

Trial ContactCutter::Take() {
  Trial trial = TrialOfFrames(contact_, type_, scale_, rate_hz_, layout_);
  missing_ = MissingFrames(contact_);
  contact_.clear();
  return trial;
}

}  // namespace tactus::internal
