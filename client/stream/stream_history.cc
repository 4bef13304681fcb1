#include "client/stream/stream_history.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace tactus::client {
namespace {

constexpr double kDefaultRateHz = 100;

double RateOf(const v1::StreamConfig& config) {
  return config.sample_rate_hz() > 0 ? config.sample_rate_hz() : kDefaultRateHz;
}

uint64_t IntervalOf(const v1::StreamConfig& config) {
  if (config.cadence() != v1::RESULT_CADENCE_EVERY_N_FRAMES) return 1;
  return std::max<uint64_t>(1, config.result_interval_frames());
}

}  // namespace

StreamHistory::StreamHistory(const v1::StreamConfig& config,
                             const v1::StreamStarted& started, size_t max_bytes)
    : every_frame_matters_(started.geometry().has_light_touch()),
      interval_(IntervalOf(config)),
      with_poses_(config.with_poses()),
      spacing_(RateOf(config)),
      lead_(with_poses_ ? spacing_.window() : 0),
      period_ns_(1e9 / RateOf(config)),
      ring_(max_bytes) {}

bool StreamHistory::Add(const v1::FrameBatch& batch) {
  const size_t bytes = batch.ByteSizeLong();
  char* const record = Append(sizeof(Head) + bytes);
  if (record == nullptr) return false;
  Head head;
  head.first_sequence = batch.first_sequence();
  head.last_sequence = batch.first_sequence() + batch.frame_count() - 1;
  uint64_t lost = 0;
  if (trial_frames_ == 0) {
    idle_from_ = head.first_sequence;
  } else {
    lost = head.first_sequence - last_sequence_ - 1;
  }
  missing_ += lost;
  head.missing = missing_;
  head.frames_before = trial_frames_;
  head.may_begin = trial_frames_ % interval_ == 0;
  for (uint32_t i = 0; i < batch.frame_count(); ++i) {
    spacing_.Step(i == 0 ? lost : 0);
    const bool kept = spacing_.Keep();
    if (i == 0 && with_poses_) head.may_begin &= kept;
  }
  std::memcpy(record, &head, sizeof(head));
  batch.SerializeWithCachedSizesToArray(
      reinterpret_cast<uint8_t*>(record + sizeof(head)));
  trial_frames_ += batch.frame_count();
  last_sequence_ = head.last_sequence;
  last_time_ns_ = batch.first_capture_time_ns() +
                  std::llround((batch.frame_count() - 1) * period_ns_);
  return true;
}

char* StreamHistory::Append(size_t bytes) {
  char* record = ring_.Append(bytes);
  while (record == nullptr && !ring_.empty() &&
         HeadAt(ring_.begin()).last_sequence <= sent_) {
    beginning_lost_ = true;
    PopFront();
    record = ring_.Append(bytes);
  }
  return record;
}

void StreamHistory::PopFront() {
  const MessageRing::Position second = ring_.Next(ring_.begin());
  next_ = std::max(next_, second);
  ring_.PopFront();
}

StreamHistory::Head StreamHistory::HeadAt(MessageRing::Position at) const {
  Head head;
  std::memcpy(&head, ring_.At(at).data(), sizeof(head));
  return head;
}

bool StreamHistory::NextUnsent(v1::FrameBatch* batch) {
  if (!has_unsent()) return false;
  const absl::string_view bytes = ring_.At(next_).substr(sizeof(Head));
  batch->ParseFromArray(bytes.data(), static_cast<int>(bytes.size()));
  const Head head = HeadAt(next_);
  if (head.last_sequence <= sent_) replayed_frames_ += batch->frame_count();
  sent_ = std::max(sent_, head.last_sequence);
  next_ = ring_.Next(next_);
  return true;
}

void StreamHistory::SentAll() {
  next_ = ring_.end();
  sent_ = last_sequence_;
}

StreamHistory::Beginning StreamHistory::BeginStream() {
  const bool lost = beginning_lost_ && !ring_.empty();
  is_resumed_ = true;
  next_ = ring_.begin();
  answered_ = 0;
  base_superseded_ = superseded_;
  repeated_superseded_ = 0;
  base_missing_ = ring_.empty() ? missing_ : HeadAt(next_).missing;
  if (!lost) {
    base_contacts_ = contacts_before_;
    base_end_ = end_before_;
    return Beginning::kKnown;
  }
  base_contacts_ = contacts_;
  base_end_.reset();
  if (is_released_) base_end_ = last_end_;
  return Beginning::kLost;
}

const v1::ClassifyContactResponse* StreamHistory::Take(
    const v1::ClassifyContactResponse& response) {
  const v1::Posterior& posterior = response.posterior();
  answered_ = std::max(answered_, posterior.sequence());
  if (!IsNew(posterior)) {
    if (!posterior.is_final()) repeated_superseded_ = posterior.superseded();
    return nullptr;
  }
  const v1::ClassifyContactResponse* shown =
      is_resumed_ ? Rebase(response) : &response;
  Learn(shown->posterior());
  return shown;
}

bool StreamHistory::IsNew(const v1::Posterior& posterior) const {
  if (!posterior.is_final()) return posterior.sequence() > delivered_;
  // A server that ends the trial before all frames have come ends it too soon.
  return ending_ &&
         (trial_frames_ == 0 || posterior.sequence() == last_sequence_);
}

const v1::ClassifyContactResponse* StreamHistory::Rebase(
    const v1::ClassifyContactResponse& response) {
  rebased_ = response;
  v1::Posterior* posterior = rebased_.mutable_posterior();
  // In a trial without frames, a final repeats the last frame before it.
  if (posterior->is_final() && trial_frames_ == 0) {
    posterior->set_sequence(last_sequence_);
    posterior->set_capture_time_ns(last_time_ns_);
  }
  if (posterior->contact_id() == 0 && base_end_) ShowReleased(posterior);
  posterior->set_contact_id(posterior->contact_id() + base_contacts_);
  posterior->set_frames_missing(posterior->frames_missing() + base_missing_);
  posterior->set_superseded(
      base_superseded_ + posterior->superseded() -
      std::min(repeated_superseded_, posterior->superseded()));
  return &rebased_;
}

void StreamHistory::ShowReleased(v1::Posterior* posterior) const {
  const v1::Posterior& end = *base_end_;
  const int64_t onset_time_ns =
      end.capture_time_ns() - end.time_since_onset_ns();
  posterior->set_contact_state(v1::CONTACT_STATE_RELEASED);
  posterior->set_onset_sequence(end.onset_sequence());
  posterior->set_time_since_onset_ns(posterior->capture_time_ns() -
                                     onset_time_ns);
  *posterior->mutable_log_likelihood() = end.log_likelihood();
  *posterior->mutable_probability() = end.probability();
  *posterior->mutable_hmm_probability() = end.hmm_probability();
  *posterior->mutable_lstm_probability() = end.lstm_probability();
  posterior->set_unknown(end.unknown());
  posterior->set_stability(end.stability());
  if (end.has_decision()) *posterior->mutable_decision() = end.decision();
  if (end.has_object()) *posterior->mutable_object() = end.object();
}

void StreamHistory::Learn(const v1::Posterior& posterior) {
  superseded_ = posterior.superseded();
  contacts_ = posterior.contact_id();
  if (posterior.is_final()) {
    FinishTrial();
    return;
  }
  delivered_ = posterior.sequence();
  is_released_ = posterior.contact_state() == v1::CONTACT_STATE_RELEASED;
  if (posterior.is_contact_end()) {
    last_end_ = posterior;
    idle_from_ = posterior.sequence() + 1;
  } else if (posterior.contact_state() == v1::CONTACT_STATE_IN_CONTACT) {
    DropBefore(posterior.onset_sequence(),
               std::max<uint64_t>(posterior.contact_id(), 1) - 1);
  } else {
    DropBefore(posterior.sequence() + 1, posterior.contact_id());
  }
}

void StreamHistory::DropBefore(uint64_t idle_to, uint64_t contacts) {
  if (every_frame_matters_ || idle_to == idle_to_) return;
  idle_to_ = idle_to;
  std::optional<MessageRing::Position> first;
  for (MessageRing::Position at = ring_.begin(); at != next_;
       at = ring_.Next(at)) {
    const Head head = HeadAt(at);
    if (head.first_sequence + lead_ > idle_to) break;
    if (head.may_begin && head.first_sequence >= idle_from_) first = at;
  }
  if (!first) return;
  while (ring_.begin() != *first) ring_.PopFront();
  beginning_lost_ = false;
  contacts_before_ = contacts;
  end_before_ = last_end_;
}

void StreamHistory::FinishTrial() {
  ring_.Clear();
  next_ = ring_.end();
  spacing_.Reset();
  trial_frames_ = 0;
  missing_ = 0;
  ending_ = false;
  beginning_lost_ = false;
  is_released_ = false;
  last_end_.reset();
  end_before_.reset();
  contacts_before_ = contacts_;
  base_missing_ = 0;
  base_end_.reset();
}

}  // namespace tactus::client
