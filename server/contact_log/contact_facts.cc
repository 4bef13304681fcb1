#include "server/contact_log/contact_facts.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/skin/normal_loads.h"
#include "core/stream/frame_decoder.h"
#include "core/stream/stream_settings.h"
#include "server/contact_log/recording_bytes.h"

namespace tactus::internal::server {
namespace {

constexpr int64_t kNsPerMs = 1'000'000;

template <typename Numbers>
int Largest(const Numbers& numbers) {
  return static_cast<int>(std::ranges::max_element(numbers) - numbers.begin());
}

void WriteAnswers(const v1::Contact& contact, const v1::StreamStarted& started,
                  v1::LoggedContact& logged) {
  if (const auto& all = contact.probability(); !all.empty()) {
    const int best = Largest(all);
    logged.set_label(started.class_names(best));
    logged.set_confidence(all[best]);
  }
  logged.set_unknown(contact.unknown());
  logged.clear_answers();
  for (int q = 0; q < contact.answers_size(); ++q) {
    const v1::QuestionAnswer& answer = contact.answers(q);
    const v1::Question& question = started.questions(q);
    v1::LoggedAnswer& out = *logged.add_answers();
    out.set_question(question.name());
    const bool decided = answer.has_decision();
    const int value = decided ? static_cast<int>(answer.decision().value())
                              : Largest(answer.probability());
    out.set_value(question.values(value));
    out.set_probability(answer.probability(value));
    out.set_decided(decided);
    if (!decided) continue;
    out.set_revised(answer.decision().revised());
    out.set_decided_after_ns(answer.decision().time_since_onset_ns());
  }
}

// The picture of a frame's loads.
v1::ContactPicture PictureOf(std::span<const float> loads, float most,
                             const SkinLayout& layout) {
  v1::ContactPicture picture;
  picture.set_rows(layout.rows);
  picture.set_columns(layout.columns);
  picture.set_most(most);
  std::string& bytes = *picture.mutable_loads();
  bytes.reserve(loads.size());
  constexpr float kWhite = 255;
  for (const float load : loads) {
    bytes.push_back(static_cast<char>(
        std::lround(most > 0 ? std::max(0.0F, load) / most * kWhite : 0)));
  }
  return picture;
}

// Adds to each contact its largest taxel, and the frame that it is in. Returns
// the latest capture time in milliseconds: of a contact that is cut, that of
// its last answer, because its last frames are not kept.
absl::StatusOr<int64_t> AddPictures(
    const v1::Recording& recording, const v1::RecordedStream& stream,
    std::map<uint64_t, v1::LoggedContact>& contacts) {
  TACTUS_ASSIGN_OR_RETURN(const StreamSettings settings,
                          ParseStreamConfig(stream.config()));
  FrameDecoder decoder(settings);
  NormalLoads normal(settings.layout);
  int64_t last_ms = recording.answers().rbegin()->capture_time_ns() / kNsPerMs;
  for (const v1::FrameBatch& batch : recording.frames()) {
    TACTUS_RETURN_IF_ERROR(decoder.Check(batch));
    for (uint32_t i = 0; i < batch.frame_count(); ++i) {
      const auto loads = normal.Of(decoder.Frame(batch, i).taxels);
      const float most = *std::ranges::max_element(loads);
      const uint64_t sequence = batch.first_sequence() + i;
      last_ms = std::max(last_ms, decoder.CaptureTime(batch, i) / kNsPerMs);
      for (auto& [id, contact] : contacts) {
        const bool within = sequence >= contact.onset_sequence() &&
                            sequence <= contact.end_sequence();
        if (!within || most <= contact.max_force()) continue;
        contact.set_max_force(most);
        *contact.mutable_picture() = PictureOf(loads, most, settings.layout);
      }
    }
    decoder.Accept(batch);
  }
  return last_ms;
}

}  // namespace

std::map<uint64_t, v1::LoggedContact> ContactsOf(
    const v1::Recording& recording, const v1::RecordedStream& stream) {
  std::map<uint64_t, v1::LoggedContact> contacts;
  for (const v1::Answer& answer : recording.answers()) {
    for (const v1::Contact& contact : answer.contacts()) {
      v1::LoggedContact& logged = contacts[contact.id()];
      logged.set_robot(stream.config().client_id());
      logged.set_caller(stream.caller());
      logged.set_stream_id(stream.started().stream_id());
      logged.set_contact_id(contact.id());
      logged.set_model_version(stream.started().model_version());
      logged.set_layout(stream.started().geometry().layout());
      logged.set_onset_sequence(contact.onset_sequence());
      logged.set_end_sequence(answer.sequence());
      logged.set_duration_ns(contact.time_since_onset_ns());
      // Until it is corrected: capture time of the onset.
      logged.set_begin_time_ms(
          (answer.capture_time_ns() - contact.time_since_onset_ns()) /
          kNsPerMs);
      WriteAnswers(contact, stream.started(), logged);
    }
  }
  return contacts;
}

absl::StatusOr<v1::StoredContacts> StoreRecording(
    const FinishedRecording& recording, ChunkPool& pool) {
  const std::string bytes = recording.Join(pool);
  v1::Recording parsed;
  if (!parsed.ParseFromString(bytes)) {
    return DataLost("a recording", "is no message");
  }
  if (parsed.answers().empty()) return DataLost("a recording", "has no answer");
  auto contacts = ContactsOf(parsed, *recording.stream);
  TACTUS_ASSIGN_OR_RETURN(const int64_t last_ms,
                          AddPictures(parsed, *recording.stream, contacts));
  v1::StoredContacts stored;
  for (auto& [id, contact] : contacts) {
    // The robot's clock has any beginning.
    contact.set_begin_time_ms(recording.end_time_ms -
                              (last_ms - contact.begin_time_ms()));
    contact.set_together(static_cast<uint32_t>(contacts.size()));
    contact.set_cut(recording.cut);
    contact.set_exact(recording.exact);
    *stored.add_contacts() = std::move(contact);
  }
  *stored.mutable_stream() = *recording.stream;
  stored.set_recording(Deflated(bytes));
  stored.set_recording_bytes(static_cast<uint32_t>(bytes.size()));
  return stored;
}

absl::StatusOr<v1::Recording> RecordingOf(const v1::StoredContacts& stored) {
  TACTUS_ASSIGN_OR_RETURN(
      const std::string bytes,
      Inflated(stored.recording(), stored.recording_bytes()));
  v1::Recording recording;
  if (!recording.ParseFromString(bytes)) {
    return DataLost("a recording of the contact log", "is no message");
  }
  return recording;
}

}  // namespace tactus::internal::server
