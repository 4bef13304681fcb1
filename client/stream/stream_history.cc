#include "client/stream/stream_history.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

namespace tactus::internal::client {
namespace {

constexpr double kDefaultRateHz = 100;

double RateOf(const v1::StreamConfig& config) {
  return config.has_sample_rate_hz() ? config.sample_rate_hz() : kDefaultRateHz;
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
  if (!is_touched_) base_end_ = last_end_;
  return Beginning::kLost;
}

const v1::ClassifyContactResponse* StreamHistory::Take(
    const v1::ClassifyContactResponse& response) {
  const v1::Answer& answer = response.answer();
  answered_ = std::max(answered_, answer.sequence());
  if (!IsNew(answer)) {
    if (!answer.is_final()) repeated_superseded_ = answer.superseded();
    return nullptr;
  }
  const v1::ClassifyContactResponse* shown =
      is_resumed_ ? Rebase(response) : &response;
  Learn(shown->answer());
  return shown;
}

bool StreamHistory::IsNew(const v1::Answer& answer) const {
  if (!answer.is_final()) return answer.sequence() > delivered_;
  // A server that ends the trial before all frames have come ends it too soon.
  return ending_ && (trial_frames_ == 0 || answer.sequence() == last_sequence_);
}

const v1::ClassifyContactResponse* StreamHistory::Rebase(
    const v1::ClassifyContactResponse& response) {
  rebased_ = response;
  v1::Answer* answer = rebased_.mutable_answer();
  // In a trial without frames, a final repeats the last frame before it.
  if (answer->is_final() && trial_frames_ == 0) {
    answer->set_sequence(last_sequence_);
    answer->set_capture_time_ns(last_time_ns_);
  }
  CountContactsOn(answer);
  if (answer->is_final() && answer->contacts().empty() && base_end_) {
    ShowEnded(answer);
  }
  answer->set_frames_missing(answer->frames_missing() + base_missing_);
  answer->set_superseded(base_superseded_ + answer->superseded() -
                         std::min(repeated_superseded_, answer->superseded()));
  return &rebased_;
}

void StreamHistory::CountContactsOn(v1::Answer* answer) const {
  const auto rebased = [this](uint64_t id) {
    return id == 0 ? 0 : id + base_contacts_;
  };
  for (v1::Contact& contact : *answer->mutable_contacts()) {
    contact.set_id(rebased(contact.id()));
    contact.set_parent_id(rebased(contact.parent_id()));
    contact.set_merged_into(rebased(contact.merged_into()));
  }
  for (v1::ContactEvent& event : *answer->mutable_events()) {
    event.set_contact_id(rebased(event.contact_id()));
    event.set_other_id(rebased(event.other_id()));
  }
}

void StreamHistory::ShowEnded(v1::Answer* answer) const {
  v1::Contact* contact = answer->add_contacts();
  *contact = base_end_->contact;
  contact->set_time_since_onset_ns(answer->capture_time_ns() -
                                   base_end_->onset_time_ns);
  if (base_end_->scores) {
    *answer->mutable_diagnostics()->add_contacts() = *base_end_->scores;
  }
}

void StreamHistory::Learn(const v1::Answer& answer) {
  superseded_ = answer.superseded();
  if (answer.is_final()) {
    FinishTrial();
    return;
  }
  delivered_ = answer.sequence();
  LearnContacts(answer);
  if (is_touched_) {
    DropBefore(touched_from_, contacts_until_touched_);
  } else if (answer.contacts().empty()) {
    DropBefore(answer.sequence() + 1, contacts_);
  }
}

void StreamHistory::LearnContacts(const v1::Answer& answer) {
  uint64_t first_onset = answer.sequence() + 1;
  uint64_t first_id = 0;
  for (int i = 0; i < answer.contacts_size(); ++i) {
    const v1::Contact& contact = answer.contacts(i);
    contacts_ = std::max(contacts_, contact.id());
    if (contact.state() == v1::Contact::STATE_RELEASED) {
      last_end_.emplace();
      last_end_->contact = contact;
      last_end_->onset_time_ns =
          answer.capture_time_ns() - contact.time_since_onset_ns();
      if (answer.diagnostics().contacts_size() > i) {
        last_end_->scores = answer.diagnostics().contacts(i);
      }
      continue;
    }
    first_onset = std::min<uint64_t>(first_onset, contact.onset_sequence());
    first_id = first_id == 0 ? contact.id() : std::min(first_id, contact.id());
  }
  const bool was_touched = std::exchange(is_touched_, first_id != 0);
  if (is_touched_ && !was_touched) {
    touched_from_ = first_onset;
    contacts_until_touched_ = first_id - 1;
  }
  if (!is_touched_ && !answer.contacts().empty()) {
    idle_from_ = answer.sequence() + 1;
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
  is_touched_ = false;
  last_end_.reset();
  end_before_.reset();
  contacts_before_ = contacts_;
  base_missing_ = 0;
  base_end_.reset();
}

}  // namespace tactus::internal::client
