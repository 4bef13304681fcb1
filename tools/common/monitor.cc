#include "tools/common/monitor.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_format.h"
#include "client/drivers/calibration/idle_frames.h"
#include "client/stream/answers.h"
#include "tools/common/percentile.h"

namespace tactus::internal::client {
namespace {

// The full scale halves in this time without a larger load.
constexpr double kHalfTimeS = 5;

}  // namespace

void Monitor::Window::Add(double value) { values[count++ % kWindow] = value; }

double Monitor::Window::Quantile(double p) const {
  if (count == 0) return -1;
  return Percentile(
      {values.begin(),
       values.begin() + static_cast<ptrdiff_t>(std::min(count, kWindow))},
      p);
}

Monitor::Monitor(const SkinInfo& info)
    : info_(info), loads_(info.layout), values_(info.layout.values()) {
  state_.layout = info.layout;
  state_.configured_hz = info.sample_rate_hz;
  state_.title = absl::StrFormat("%s, %d x %d at %g Hz", info.layout.name,
                                 info.layout.rows, info.layout.columns,
                                 info.sample_rate_hz);
}

void Monitor::Started(const v1::StreamStarted& started) {
  const std::lock_guard lock(mutex_);
  started_ = started;
  state_.title += "   " + started.model_version();
  state_.class_names.assign(started.class_names().begin(),
                            started.class_names().end());
}

void Monitor::Frame(const SkinFrame& frame, uint64_t sequence, int64_t now_ns) {
  const std::lock_guard lock(mutex_);
  RawValues(info_, frame, values_);
  const std::span<const float> loads = loads_.Of(values_);
  state_.values.assign(loads.begin(), loads.end());
  float largest = 0;
  for (size_t i = 0; i < state_.values.size(); ++i) {
    state_.values[i] = static_cast<float>(state_.values[i] * info_.scale);
    const bool valid = info_.layout.mask.empty() || info_.layout.mask[i] != 0;
    if (valid) largest = std::max(largest, state_.values[i]);
  }
  const double decay = std::exp2(-1 / (kHalfTimeS * info_.sample_rate_hz));
  peak_ = std::max<double>(largest, decay * peak_);
  ages_ms_.Add(static_cast<double>(now_ns - frame.capture_time_ns) / 1e6);
  ++state_.frames;
  if (sequence > 0) sent_[sequence % kWindow] = {sequence, now_ns};
}

void Monitor::Answer(const v1::Answer& answer, int64_t now_ns) {
  const std::lock_guard lock(mutex_);
  const Sent& sent = sent_[answer.sequence() % kWindow];
  if (sent.sequence == answer.sequence() && !answer.is_final()) {
    answers_ms_.Add(static_cast<double>(now_ns - sent.time_ns) / 1e6);
  }
  state_.superseded = answer.superseded();
  state_.contacts = static_cast<int>(std::count_if(
      answer.contacts().begin(), answer.contacts().end(), IsOpen));
  state_.in_contact = state_.contacts > 0;
  const v1::Contact* contact = MainContact(answer);
  const v1::ContactPatch& patch = contact != nullptr && IsOpen(*contact)
                                      ? contact->patch()
                                      : v1::ContactPatch::default_instance();
  state_.max_force = patch.max_force();
  state_.area_taxels = patch.area_taxels();
  state_.area_m2 = patch.area_m2();
  // Without a contact its last probabilities stay.
  if (contact == nullptr) return;
  state_.motion_m = contact->motion_m();
  state_.contact_id = contact->id();
  state_.contact_s = static_cast<double>(contact->time_since_onset_ns()) / 1e9;
  state_.probability.assign(contact->probability().begin(),
                            contact->probability().end());
  state_.unknown = contact->unknown();
  state_.decision.reset();
  if (const auto decided = DecidedClassOf(started_, *contact)) {
    state_.decision = decided->class_index;
    state_.decision_ms =
        static_cast<double>(decided->time_since_onset_ns) / 1e6;
  }
}

MonitorState Monitor::Snapshot(const DriverStatistics& statistics) {
  const std::lock_guard lock(mutex_);
  MonitorState state = state_;
  state.full_scale = std::max(peak_, 2 * info_.layout.onset_threshold);
  state.rate_hz = statistics.rate_hz;
  state.lost = statistics.lost;
  state.overwritten = statistics.overwritten;
  state.connected = statistics.connected;
  state.age_p50_ms = ages_ms_.Quantile(0.5);
  state.age_p99_ms = ages_ms_.Quantile(0.99);
  state.answer_p50_ms = answers_ms_.Quantile(0.5);
  state.answer_p99_ms = answers_ms_.Quantile(0.99);
  return state;
}

}  // namespace tactus::internal::client
