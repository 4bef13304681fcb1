#include "server/contact_log/contact_replay.h"

#include <algorithm>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "core/base/limits_contact_log.h"
#include "core/base/serialize.h"
#include "core/base/status_macros.h"
#include "core/stream/contact_session.h"
#include "core/stream/stream_settings.h"
#include "core/stream/stream_started.h"
#include "server/contact_log/contact_facts.h"

namespace tactus::internal::server {
namespace {

// Drops the answers for the robot: it got them when the contact happened.
class NoRobot final : public AnswerSink {
 public:
  v1::Answer* AddInterim() override { return &answer_; }
  v1::Answer* AddKept() override { return &answer_; }
  v1::StreamNotice* AddNotice() override { return &notice_; }

 private:
  v1::Answer answer_;
  v1::StreamNotice notice_;
};

// The answer without what depends on earlier contacts of its stream.
std::string Comparable(v1::Answer answer, uint64_t first_id) {
  const auto shift = [first_id](uint64_t id) {
    return id == 0 ? 0 : id - first_id + 1;
  };
  for (v1::Contact& contact : *answer.mutable_contacts()) {
    contact.set_id(shift(contact.id()));
    contact.set_parent_id(shift(contact.parent_id()));
    contact.set_merged_into(shift(contact.merged_into()));
  }
  for (v1::ContactEvent& event : *answer.mutable_events()) {
    event.set_contact_id(shift(event.contact_id()));
    event.set_other_id(shift(event.other_id()));
  }
  answer.clear_frames_missing();
  answer.clear_superseded();
  return SerializeDeterministic(answer);
}

uint64_t FirstId(const v1::StoredContacts& stored) {
  uint64_t first = stored.contacts(0).contact_id();
  for (const v1::LoggedContact& contact : stored.contacts()) {
    first = std::min(first, contact.contact_id());
  }
  return first;
}

// Keeps the frames that are to be shown, if any are, and compares answers.
class Viewer final : public StreamTap {
 public:
  Viewer(const v1::Recording& recording, uint64_t first_id,
         const ReplayOptions& options, v1::ReplayContactResponse* response)
      : recording_(recording),
        first_id_(first_id),
        options_(options),
        response_(response) {
    for (const v1::FrameBatch& batch : recording.frames()) {
      total_ += batch.frame_count();
    }
  }

  v1::Answer* Want(bool has_events) override {
    has_events_ = has_events;
    return &answer_;
  }

  void Take(const FrameView& frame, const v1::Answer& answer) override {
    if (has_events_ || answer.is_final()) {
      Compare(answer);
      *again_.add_answers() = answer;
    }
    if (response_ == nullptr || answer.is_final()) return;
    if (seen_ == 0) most_ = MostFrames(frame, answer);
    const uint64_t at = seen_++ * most_ / total_;
    const bool due = at != std::exchange(shown_, at) || seen_ == 1;
    if (!due && !has_events_) return;
    v1::WatchedFrame out;
    *out.mutable_answer() = answer;
    if (options_.with_taxels) {
      out.set_taxels(frame.taxels.data(), frame.taxels.size_bytes());
    }
    bytes_ += out.ByteSizeLong();
    if (bytes_ > limits::kMaxReplayedBytes) return;
    response_->add_frames()->Swap(&out);
  }

  // All that was answered has come again, and nothing else.
  bool same() const { return same_ && compared_ == recording_.answers_size(); }
  // The answers with events, and the final.
  const v1::Recording& again() const { return again_; }

 private:
  // As many frames as were asked for, or as fit.
  uint64_t MostFrames(const FrameView& frame, const v1::Answer& answer) const {
    const size_t bytes = answer.ByteSizeLong() +
                         (options_.with_taxels ? frame.taxels.size_bytes() : 0);
    return std::min<uint64_t>(
        options_.max_frames,
        std::max<size_t>(1, limits::kReplayedBytes / bytes));
  }

  void Compare(const v1::Answer& answer) {
    const int next = compared_++;
    same_ = same_ && next < recording_.answers_size() &&
            Comparable(recording_.answers(next), first_id_) ==
                Comparable(answer, 1);
  }

  const v1::Recording& recording_;
  const uint64_t first_id_;
  const ReplayOptions options_;
  v1::ReplayContactResponse* const response_;
  uint64_t total_ = 0;
  v1::Answer answer_;
  bool has_events_ = false;
  uint64_t seen_ = 0;
  uint64_t shown_ = 0;
  uint64_t most_ = 1;
  size_t bytes_ = 0;
  int compared_ = 0;
  bool same_ = true;
  v1::Recording again_;
};

using Contacts = std::map<uint64_t, v1::LoggedContact>;

// The contact of a replay that shares most frames with the logged one, whose id
// would be `own` if all was as before; null if none shares any.
const v1::LoggedContact* BestMatch(const Contacts& contacts,
                                   const v1::LoggedContact& logged,
                                   uint64_t own) {
  const auto apart = [](uint64_t a, uint64_t b) {
    return static_cast<int64_t>(std::max(a, b) - std::min(a, b));
  };
  const v1::LoggedContact* best = nullptr;
  std::tuple<int64_t, int64_t, bool> most = {0, 0, false};
  for (const auto& [id, contact] : contacts) {
    const auto begin =
        std::max(contact.onset_sequence(), logged.onset_sequence());
    const auto end = std::min(contact.end_sequence(), logged.end_sequence());
    if (end < begin) continue;
    // Among two that lie within it, the one that begins with it; among two that
    // hold it, the one that ends with it.
    const std::tuple<int64_t, int64_t, bool> match = {
        2 * (apart(end, begin) + 1) -
            apart(contact.onset_sequence(), logged.onset_sequence()),
        -apart(contact.end_sequence(), logged.end_sequence()), id == own};
    if (std::get<0>(match) <= 0 || (best != nullptr && match <= most)) continue;
    most = match;
    best = &contact;
  }
  return best;
}

// What one replay gives.
struct Replayed {
  v1::StreamStarted started;
  Contacts contacts;
  bool same = false;
};

// `response` receives frames; null if none are wanted.
absl::StatusOr<Replayed> Replay(const v1::StoredContacts& stored,
                                const PinnedModel& model,
                                const ReplayOptions& options,
                                v1::ReplayContactResponse* response) {
  TACTUS_ASSIGN_OR_RETURN(const v1::Recording recording, RecordingOf(stored));
  TACTUS_ASSIGN_OR_RETURN(const StreamSettings settings,
                          ParseStreamConfig(stored.stream().config()));
  TACTUS_RETURN_IF_ERROR(
      ContactPipeline::Check(settings.layout, *model.model, settings.pipeline));
  NoRobot robot;
  Viewer viewer(recording, FirstId(stored), options, response);
  ContactSession session(settings, model.model, &robot);
  session.SetTap(&viewer);
  for (const v1::FrameBatch& batch : recording.frames()) {
    TACTUS_RETURN_IF_ERROR(session.OnFrames(batch));
  }
  const auto& answers = recording.answers();
  if (!answers.empty() && answers.rbegin()->is_final()) session.OnEndOfTrial();
  Replayed replayed;
  v1::RecordedStream stream = stored.stream();
  stream.clear_started();
  WriteStarted(settings, *model.model, stream.mutable_started());
  stream.mutable_started()->set_model_version(model.version_name);
  stream.mutable_started()->set_bundle_sha256(model.sha256);
  replayed.contacts = ContactsOf(viewer.again(), stream);
  replayed.same = model.sha256 == stored.stream().started().bundle_sha256() &&
                  viewer.same();
  replayed.started = std::move(*stream.mutable_started());
  return replayed;
}

}  // namespace

absl::StatusOr<v1::ReplayContactResponse> ReplayContact(
    const v1::StoredContacts& stored, uint32_t place, const PinnedModel& model,
    const ReplayOptions& options) {
  v1::ReplayContactResponse response;
  TACTUS_ASSIGN_OR_RETURN(Replayed replayed,
                          Replay(stored, model, options, &response));
  const v1::LoggedContact& contact = stored.contacts(static_cast<int>(place));
  *response.mutable_contact() = contact;
  response.set_same_answers(replayed.same);
  *response.mutable_started() = std::move(replayed.started);
  const auto* found = BestMatch(replayed.contacts, contact,
                                contact.contact_id() - FirstId(stored) + 1);
  if (found != nullptr) {
    response.set_contact_id(found->contact_id());
    *response.mutable_replayed() = *found;
    response.mutable_replayed()->set_begin_time_ms(contact.begin_time_ms());
  }
  return response;
}

absl::Status AddShadow(const PinnedModel& shadow, v1::StoredContacts* stored) {
  TACTUS_ASSIGN_OR_RETURN(const Replayed replayed,
                          Replay(*stored, shadow, {.max_frames = 1}, nullptr));
  const uint64_t first_id = FirstId(*stored);
  for (v1::LoggedContact& contact : *stored->mutable_contacts()) {
    v1::ShadowAnswer& answer = *contact.mutable_shadow();
    answer.set_model_version(shadow.version_name);
    const auto* found = BestMatch(replayed.contacts, contact,
                                  contact.contact_id() - first_id + 1);
    if (found == nullptr) continue;
    answer.set_label(found->label());
    answer.set_confidence(found->confidence());
  }
  return absl::OkStatus();
}

}  // namespace tactus::internal::server
