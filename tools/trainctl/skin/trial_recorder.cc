#include "tools/trainctl/skin/trial_recorder.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/drivers/calibration/idle_frames.h"
#include "core/features/contact_time.h"

namespace tactus::internal::client {
namespace {

constexpr char kUndo = 'u';
constexpr char kSkip = 's';
constexpr char kQuit = 'q';

int64_t Nanoseconds(double seconds) { return std::llround(1e9 * seconds); }

RecorderStep News(std::string news) {
  RecorderStep step;
  step.news = std::move(news);
  return step;
}

}  // namespace

TrialRecorder::TrialRecorder(const SkinInfo& info, const SkinInfo* raw_info,
                             const RecorderOptions& options)
    : info_(info),
      raw_info_(raw_info == nullptr ? std::nullopt
                                    : std::optional<SkinInfo>(*raw_info)),
      options_(options),
      tracker_(info.layout, {.sample_rate_hz = info.sample_rate_hz,
                             .release_after_s = options.release_after_s}),
      values_(info.layout.values()),
      counts_(options.labels.size()) {}

std::optional<size_t> TrialRecorder::LabelOf(char key) const {
  const std::vector<std::string>& labels = options_.labels;
  if (key >= '1' && key <= '9') {
    const auto label = static_cast<size_t>(key - '1');
    if (label < labels.size()) return label;
    return std::nullopt;
  }
  std::optional<size_t> found;
  for (size_t i = 0; i < labels.size(); ++i) {
    if (labels[i].empty() || absl::ascii_tolower(labels[i][0]) != key) continue;
    if (found) return std::nullopt;
    found = i;
  }
  return found;
}

RecorderStep TrialRecorder::Key(char key) {
  key = absl::ascii_tolower(static_cast<unsigned char>(key));
  RecorderStep step;
  if (key == kQuit) {
    step.quit = true;
    if (in_contact()) step.news = "the contact that was going on is not kept";
    return step;
  }
  if (key == kUndo) {
    if (history_.empty()) return News("there is no trial to remove");
    const size_t label = history_.back();
    history_.pop_back();
    --counts_[label];
    step.undo = true;
    step.news =
        absl::StrCat("removed the last trial, ", options_.labels[label]);
    return step;
  }
  if (key == kSkip) {
    if (in_contact()) {
      skipped_ = true;
      return News("this contact will not be kept");
    }
    label_.reset();
    return News("contacts are not kept until you choose a label");
  }
  const auto label = LabelOf(key);
  if (!label) return step;
  label_ = label;
  skipped_ = false;
  step.news = absl::StrCat(in_contact() ? "this contact is " : "next: ",
                           options_.labels[*label]);
  return step;
}

void TrialRecorder::Store(const SkinFrame& frame, const SkinFrame* raw) {
  stored_.push_back({frame, raw == nullptr ? SkinFrame() : *raw});
}

void TrialRecorder::ForgetBefore(int64_t time_ns) {
  while (!stored_.empty() && stored_.front().frame.capture_time_ns < time_ns) {
    stored_.pop_front();
  }
}

double TrialRecorder::contact_s() const {
  if (contacts_ == 0) return 0;
  return SecondsUntil(in_contact() ? now_ns_ : last_touch_ns_);
}

double TrialRecorder::SecondsUntil(int64_t time_ns) const {
  const int64_t frame_ns =
      Nanoseconds(ContactSeconds(/*frames=*/1, info_.sample_rate_hz));
  return static_cast<double>(time_ns - onset_ns_ + frame_ns) / 1e9;
}

RecorderStep TrialRecorder::Frame(const SkinFrame& frame,
                                  const SkinFrame* raw) {
  RecorderStep step;
  // After a longer silence nobody knows what came before; a contact ended in
  // it.
  const int64_t silence_ns =
      std::max<int64_t>(Nanoseconds(options_.release_after_s),
                        Nanoseconds(3 / info_.sample_rate_hz));
  if (frame.capture_time_ns - now_ns_ > silence_ns) {
    if (in_contact()) step = End();
    tracker_.Reset();
    stored_.clear();
  }
  now_ns_ = frame.capture_time_ns;
  RawValues(info_, frame, values_);
  for (float& value : values_) {
    value = static_cast<float>(value * info_.scale);
  }
  const FrameFeatures& features =
      tracker_.Step({.taxels = values_,
                     .pose = info_.with_poses ? &frame.pose : nullptr,
                     .missing_before = frame.missing_before});
  if (tracker_.onset()) {
    onset_ns_ = now_ns_;
    ++contacts_;
    missing_ = 0;
    skipped_ = false;
    too_long_ = false;
  }
  if (in_contact()) {
    if (features.touched) last_touch_ns_ = now_ns_;
    if (!tracker_.onset()) missing_ += frame.missing_before;
    if (contact_s() > options_.longest_s) {
      const bool first = !too_long_;
      too_long_ = true;
      stored_.clear();
      if (first) {
        return News(
            absl::StrFormat("a contact longer than %g s is not kept; lift off",
                            options_.longest_s));
      }
      return step;
    }
    Store(frame, raw);
    return step;
  }
  Store(frame, raw);
  if (tracker_.released()) return End();
  ForgetBefore(now_ns_ - Nanoseconds(options_.pre_roll_s));
  return step;
}

RecorderStep TrialRecorder::End() {
  RecorderStep step;
  if (too_long_) {
    // It was reported.
  } else if (skipped_) {
    step.news = "the contact is not kept, as you wished";
  } else if (!label_) {
    step.news = "a contact without a label is not kept: choose one";
  } else if (touched_s() < options_.shortest_s) {
    step.news = absl::StrFormat("a contact of %.2f s is too short to be kept",
                                touched_s());
  } else {
    step.trial = {MakeTrial(info_, false), std::nullopt};
    if (raw_info_) step.trial->raw = MakeTrial(*raw_info_, true);
    ++counts_[*label_];
    history_.push_back(*label_);
    step.news = absl::StrFormat("kept %s, %.2f s of contact",
                                options_.labels[*label_], touched_s());
    if (missing_ > 0) {
      absl::StrAppend(&step.news, "; ", missing_, " frames were lost in it");
    }
  }
  skipped_ = false;
  // Nothing of the contact that is over belongs to the next one.
  ForgetBefore(
      std::max(last_touch_ns_ + 1, now_ns_ - Nanoseconds(options_.pre_roll_s)));
  return step;
}

Trial TrialRecorder::MakeTrial(const SkinInfo& info, bool raw) const {
  Trial trial;
  trial.label = options_.labels[*label_];
  trial.condition = options_.condition;
  trial.object = options_.object;
  trial.material = options_.group;
  trial.sample_rate_hz = info.sample_rate_hz;
  trial.taxels.SetShape(info.layout);
  const bool floats = info.taxel_type == v1::TAXEL_TYPE_FLOAT32;
  trial.taxels.scale = floats ? 1 : info.scale;
  SetSkin(info.layout, trial);
  const int64_t begin_ns = onset_ns_ - Nanoseconds(options_.pre_roll_s);
  std::optional<int64_t> first_ns;
  for (const Stored& stored : stored_) {
    const SkinFrame& frame = raw ? stored.raw : stored.frame;
    const int64_t time_ns = stored.frame.capture_time_ns;
    if (time_ns < begin_ns) continue;
    if (!first_ns) first_ns = time_ns;
    trial.time.push_back(static_cast<double>(time_ns - *first_ns) / 1e9);
    const auto append = [](const auto& values, auto& all) {
      all.insert(all.end(), values.begin(), values.end());
    };
    if (info.taxel_type == v1::TAXEL_TYPE_UINT16) {
      append(frame.u16, trial.taxels.u16);
    } else if (info.taxel_type == v1::TAXEL_TYPE_INT16) {
      append(frame.i16, trial.taxels.i16);
    } else {
      append(frame.f32, trial.taxels.f32);
    }
    if (info.with_poses) trial.poses.push_back(frame.pose);
  }
  return trial;
}

std::string TrialRecorder::KeysText() const {
  std::string text;
  for (size_t i = 0; i < options_.labels.size(); ++i) {
    absl::StrAppend(&text, i + 1, " ", options_.labels[i], "  ");
  }
  return text + "u undo  s skip  q quit";
}

}  // namespace tactus::internal::client
