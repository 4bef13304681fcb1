#include "core/data/recording/contact_cutter.h"

#include <bit>
#include <cstring>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/skin/taxel_values.h"

namespace tactus::internal {
namespace {

static_assert(std::endian::native == std::endian::little,
              "values are copied from the wire as they are");

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

Pose PoseOf(const v1::FrameBatch& frame) {
  const auto& p = frame.poses();
  return {{p[0], p[1], p[2]}, Eigen::Quaterniond(p[6], p[3], p[4], p[5])};
}

template <typename Value>
void AppendTaxels(const std::string& bytes, std::vector<Value>& values) {
  const size_t before = values.size();
  values.resize(before + bytes.size() / sizeof(Value));
  std::memcpy(values.data() + before, bytes.data(), bytes.size());
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
  Trial trial;
  trial.sample_rate_hz = rate_hz_;
  trial.taxels.SetShape(layout_);
  missing_ = 0;
  const int64_t start_ns = contact_.front().first_capture_time_ns();
  uint64_t expected = contact_.front().first_sequence();
  for (const v1::FrameBatch& frame : contact_) {
    missing_ += frame.first_sequence() - expected;
    expected = frame.first_sequence() + 1;
    trial.time.push_back(
        static_cast<double>(frame.first_capture_time_ns() - start_ns) / 1e9);
    if (type_ == v1::TAXEL_TYPE_UINT16) {
      AppendTaxels(frame.taxels(), trial.taxels.u16);
    } else if (type_ == v1::TAXEL_TYPE_INT16) {
      AppendTaxels(frame.taxels(), trial.taxels.i16);
    } else {
      AppendTaxels(frame.taxels(), trial.taxels.f32);
    }
    if (frame.poses_size() > 0) trial.poses.push_back(PoseOf(frame));
  }
  if (type_ != v1::TAXEL_TYPE_FLOAT32) {
    trial.taxels.scale = scale_;
  } else {
    for (float& value : trial.taxels.f32) value = ScaledTaxel(value, scale_);
  }
  SetSkin(layout_, trial);
  contact_.clear();
  return trial;
}

}  // namespace tactus::internal
