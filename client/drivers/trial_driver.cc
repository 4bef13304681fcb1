#include "client/drivers/trial_driver.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/data/trial_layout.h"

namespace tactus::internal::client {
namespace {

// Between the last frame of a trial and the first of the next.
constexpr int64_t kPauseNs = 1'000'000'000;

// From the trial's first frame to frame `index`.
int64_t ElapsedNs(const Trial& trial, size_t index) {
  return std::llround((trial.time[index] - trial.time[0]) * 1e9);
}

}  // namespace

absl::StatusOr<SkinInfo> TrialDriver::InfoOf(const Trial& trial) const {
  if (trial.taxels.empty()) {
    return InvalidTrainingData(
        absl::StrCat("trial ", trial.id, " has signals but no taxel frames"));
  }
  SkinInfo info;
  TACTUS_ASSIGN_OR_RETURN(info.layout,
                          LayoutOfTrial(trial, layout_ ? &*layout_ : nullptr));
  info.taxel_type = trial.taxels.type();
  info.scale = trial.taxels.scale;
  info.sample_rate_hz = trial.sample_rate_hz;
  info.with_poses = !trial.poses.empty();
  return info;
}

absl::StatusOr<SkinInfo> TrialDriver::OnConfigure() {
  index_ = shard_.shard;
  if (index_ >= count_) return SkinInfo();
  TACTUS_ASSIGN_OR_RETURN(trial_, MakeTrial(index_));
  TACTUS_ASSIGN_OR_RETURN(info_, InfoOf(trial_));
  frame_ = 0;
  playing_ = true;
  return info_;
}

absl::StatusOr<ReadResult> TrialDriver::OnRead(SkinFrame& frame) {
  if (playing_) {
    if (frame_ < trial_.time.size()) {
      FillFrame(frame);
      return ReadResult::kFrame;
    }
    playing_ = false;
    return ReadResult::kEndOfTrial;
  }
  if (index_ + shard_.shards >= count_) return ReadResult::kEndOfData;
  TACTUS_ASSIGN_OR_RETURN(Trial next, MakeTrial(index_ + shard_.shards));
  TACTUS_ASSIGN_OR_RETURN(const SkinInfo info, InfoOf(next));
  if (info != info_) {
    return InvalidTrainingData(
        absl::StrCat("trial ", next.id,
                     " is of another layout, taxel type, scale, rate or "
                     "pose than the trials before it"));
  }
  index_ += shard_.shards;
  start_ns_ += ElapsedNs(trial_, trial_.time.size() - 1) + kPauseNs;
  trial_ = std::move(next);
  frame_ = 0;
  playing_ = true;
  FillFrame(frame);
  return ReadResult::kFrame;
}

void TrialDriver::FillFrame(SkinFrame& frame) {
  const TaxelSeries& taxels = trial_.taxels;
  const auto size = static_cast<ptrdiff_t>(taxels.frame_size());
  const auto copy = [&](const auto& values, auto& into) {
    if (values.empty()) return;
    const auto begin = values.begin() + static_cast<ptrdiff_t>(frame_) * size;
    into.assign(begin, begin + size);
  };
  frame.capture_time_ns = start_ns_ + ElapsedNs(trial_, frame_);
  copy(taxels.u16, frame.u16);
  copy(taxels.i16, frame.i16);
  copy(taxels.f32, frame.f32);
  if (!trial_.poses.empty()) frame.pose = trial_.poses[frame_];
  ++frame_;
}

}  // namespace tactus::internal::client
