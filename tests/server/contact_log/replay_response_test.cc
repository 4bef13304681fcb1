// What a replay shows, and of which streams and models.
#include <algorithm>
#include <cstring>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/base/errors.h"
#include "gtest/gtest.h"
#include "server/contact_log/contact_replay.h"
#include "server/contact_log/recording_bytes.h"
#include "tests/server/contact_log/pressed_stream.h"
#include "tests/server/contact_log/random_streams.h"

namespace tactus::internal::server {
namespace {

// Two contacts at once, with frames before and after.
v1::StoredContacts TwoContacts() {
  PressedStream stream;
  stream.Quiet(60);
  stream.Press(30);
  stream.Same(40, Both(PressedAt(5, 7), PressedAt(12, 17)));
  stream.Same(40, PressedAt(12, 17));
  stream.QuietUntil(1);
  v1::StoredContacts stored = stream.kept().at(0).stored;
  stored.mutable_contacts(0)->set_name("contacts/1");
  stored.mutable_contacts(1)->set_name("contacts/1-2");
  return stored;
}

void SetRecording(const v1::Recording& recording, v1::StoredContacts& stored) {
  const std::string bytes = recording.SerializeAsString();
  stored.set_recording(Deflated(bytes));
  stored.set_recording_bytes(static_cast<uint32_t>(bytes.size()));
}

v1::ReplayContactResponse Shown(const v1::StoredContacts& stored,
                                uint32_t max_frames, bool with_taxels = true,
                                const PinnedModel& model = SmallPinned()) {
  const auto response = ReplayContact(
      stored, 0, model, {.max_frames = max_frames, .with_taxels = with_taxels});
  EXPECT_TRUE(response.ok()) << response.status();
  return response.value_or(v1::ReplayContactResponse());
}

TEST(ReplayResponseTest, SaysWhatIsReplayedAndByWhichModel) {
  const v1::StoredContacts stored = TwoContacts();
  for (uint32_t place = 0; place < 2; ++place) {
    const auto response =
        ReplayContact(stored, place, SmallPinned(), {.max_frames = 10});
    ASSERT_TRUE(response.ok()) << response.status();
    EXPECT_EQ(response->contact().SerializeAsString(),
              stored.contacts(static_cast<int>(place)).SerializeAsString());
    EXPECT_EQ(response->contact_id(), place + 1);
    EXPECT_TRUE(response->same_answers());
    v1::StreamStarted started = stored.stream().started();
    started.clear_stream_id();
    EXPECT_EQ(response->started().SerializeAsString(),
              started.SerializeAsString());
  }
}

TEST(ReplayResponseTest, KeepsFramesWithEventsAndAFewOthers) {
  const v1::StoredContacts stored = TwoContacts();
  const v1::Recording recording = *RecordingOf(stored);
  const auto total = static_cast<uint32_t>(recording.frames_size());
  std::set<uint64_t> with_events;
  for (const v1::Answer& answer : recording.answers()) {
    with_events.insert(answer.sequence());
  }
  ASSERT_GE(with_events.size(), 4u);
  for (const uint32_t most : {1U, 2U, 7U, 50U, total - 1, total, 1000U}) {
    SCOPED_TRACE(most);
    const auto response = Shown(stored, most);
    std::vector<uint64_t> shown;
    for (const v1::WatchedFrame& frame : response.frames()) {
      shown.push_back(frame.answer().sequence());
    }
    EXPECT_TRUE(std::ranges::is_sorted(shown));
    EXPECT_EQ(std::ranges::adjacent_find(shown), shown.end());
    EXPECT_EQ(shown.front(), 1u);
    EXPECT_TRUE(std::ranges::includes(shown, with_events));
    const size_t few = std::min(most, total);
    EXPECT_GE(shown.size(), few);
    EXPECT_LE(shown.size(), few + with_events.size());
    // Evenly spread.
    shown.push_back(total + 1);
    for (size_t i = 1; i < shown.size(); ++i) {
      EXPECT_LE(shown[i] - shown[i - 1], (total + few - 1) / few);
    }
    EXPECT_TRUE(response.same_answers());
  }
}

TEST(ReplayResponseTest, ShowsTheAnswersAndTheTaxels) {
  PressedStream stream;
  stream.Quiet(3);
  stream.Press(30);
  stream.QuietUntil(1);
  const v1::StoredContacts& stored = stream.kept()[0].stored;
  for (const bool with_taxels : {false, true}) {
    const auto response = Shown(stored, 1000, with_taxels);
    ASSERT_EQ(response.frames_size(), static_cast<int>(stream.next) - 1);
    for (int t = 0; t < response.frames_size(); ++t) {
      const v1::WatchedFrame& frame = response.frames(t);
      EXPECT_EQ(frame.age_us(), 0u);
      v1::Answer answer = frame.answer();
      // The robot did not ask for taxels.
      for (v1::Contact& contact : *answer.mutable_contacts()) {
        if (contact.has_patch()) contact.mutable_patch()->clear_taxels();
      }
      EXPECT_EQ(answer.SerializeAsString(),
                stream.rig.robot().answers()[t].SerializeAsString());
      if (!with_taxels) {
        EXPECT_EQ(frame.taxels(), "");
        continue;
      }
      const auto newtons = testing::Newtons(
          t >= 3 && t < 33 ? PressedAt(5, 7) : testing::Untouched());
      ASSERT_EQ(frame.taxels().size(), newtons.size() * sizeof(float));
      EXPECT_EQ(std::memcmp(frame.taxels().data(), newtons.data(),
                            frame.taxels().size()),
                0);
    }
  }
}

TEST(ReplayResponseTest, AChangedTaxelGivesOtherAnswers) {
  const v1::StoredContacts stored = TwoContacts();
  const v1::Recording recording = *RecordingOf(stored);
  const uint64_t first = recording.frames(0).first_sequence();
  // The onset of the first, in the middle of it, and in the second alone.
  for (const uint64_t sequence : {61, 75, 110, 165}) {
    v1::Recording changed = recording;
    std::string& taxels =
        *changed.mutable_frames(static_cast<int>(sequence - first))
             ->mutable_taxels();
    const size_t at = 2 * (sequence < 120 ? 5 * 24 + 7 : 12 * 24 + 17);
    taxels[at] = static_cast<char>(taxels[at] + 1);
    v1::StoredContacts other = stored;
    SetRecording(changed, other);
    EXPECT_FALSE(Shown(other, 10).same_answers()) << sequence;
  }
  // Where nothing touches the skin, so little changes nothing.
  v1::Recording changed = recording;
  changed.mutable_frames(5)->mutable_taxels()->at(0) = 1;
  v1::StoredContacts other = stored;
  SetRecording(changed, other);
  EXPECT_TRUE(Shown(other, 10).same_answers());
}

TEST(ReplayResponseTest, AMissingOrAnotherAnswerIsNotTheSame) {
  const v1::StoredContacts stored = TwoContacts();
  const v1::Recording recording = *RecordingOf(stored);
  const auto is_same = [&](const v1::Recording& other) {
    v1::StoredContacts changed = stored;
    SetRecording(other, changed);
    return Shown(changed, 10).same_answers();
  };
  EXPECT_TRUE(is_same(recording));
  for (int i = 0; i < recording.answers_size(); ++i) {
    v1::Recording fewer = recording;
    fewer.mutable_answers()->DeleteSubrange(i, 1);
    EXPECT_FALSE(is_same(fewer)) << i;
    v1::Recording more = recording;
    *more.add_answers() = recording.answers(i);
    EXPECT_FALSE(is_same(more)) << i;
    v1::Recording other = recording;
    v1::Contact& contact = *other.mutable_answers(i)->mutable_contacts(0);
    contact.set_unknown(std::nextafter(contact.unknown(), 2));
    EXPECT_FALSE(is_same(other)) << i;
  }
}

TEST(ReplayResponseTest, AnotherModelGivesItsOwnAnswers) {
  const v1::StoredContacts stored = TwoContacts();
  Model changed = testing::SmallModel();
  changed.calibration.prior = {0.4, 0.2, 0.2, 0.2};
  PinnedModel other = Pinned(changed);
  // Under the same name, too.
  EXPECT_FALSE(Shown(stored, 10, false, other).same_answers());
  other.sha256 = std::string(64, 'b');
  other.version_name = "models/other/versions/3";
  const auto response = Shown(stored, 10, false, other);
  EXPECT_FALSE(response.same_answers());
  EXPECT_EQ(response.contact_id(), 1u);
  EXPECT_EQ(response.started().model_version(), "models/other/versions/3");
  EXPECT_EQ(response.started().bundle_sha256(), std::string(64, 'b'));
  // The same numbers in another bundle are another model.
  PinnedModel copy = SmallPinned();
  copy.sha256 = std::string(64, 'c');
  EXPECT_FALSE(Shown(stored, 10, false, copy).same_answers());
}

// Two contacts begin with the same frame, and end with the same one or not.
TEST(ReplayResponseTest, TellsContactsWithTheSameOnsetApart) {
  const testing::Counts first = PressedAt(5, 7);
  const testing::Counts a = PressedAt(12, 17);
  const testing::Counts b = PressedAt(9, 1);
  for (const testing::Counts& longer : {a, b, Both(a, b)}) {
    PressedStream stream;
    stream.Same(30, first);
    stream.Same(20, Both(first, Both(a, b)));
    stream.Same(60, Both(first, longer));
    stream.rig.EndTrial();
    const v1::StoredContacts& stored = stream.kept().at(0).stored;
    ASSERT_EQ(stored.contacts_size(), 3);
    EXPECT_EQ(stored.contacts(1).onset_sequence(),
              stored.contacts(2).onset_sequence());
    for (uint32_t place = 0; place < 3; ++place) {
      const auto response =
          ReplayContact(stored, place, SmallPinned(), {.max_frames = 10});
      ASSERT_TRUE(response.ok()) << response.status();
      EXPECT_EQ(response->contact_id(), place + 1);
      EXPECT_TRUE(response->same_answers());
    }
  }
}

TEST(ReplayResponseTest, AModelThatFindsNoContact) {
  v1::StoredContacts stored = TwoContacts();
  stored.mutable_stream()
      ->mutable_config()
      ->mutable_geometry()
      ->set_onset_threshold(20);
  const auto response = Shown(stored, 10);
  EXPECT_EQ(response.contact_id(), 0u);
  EXPECT_FALSE(response.same_answers());
  EXPECT_EQ(response.frames_size(), 10);
}

TEST(ReplayResponseTest, AModelOfAnotherSkinIsRefused) {
  Model model = testing::SmallModel();
  model.layout = *LayoutPreset("vitac-12x32");
  EXPECT_EQ(ReasonOf(ReplayContact(TwoContacts(), 0, Pinned(model),
                                   {.max_frames = 10})
                         .status()),
            "GEOMETRY_MISMATCH");
  EXPECT_EQ(ReasonOf(ReplayContact(TwoContacts(), 0, SmallPinned(200),
                                   {.max_frames = 10})
                         .status()),
            "INVALID_CONFIG");
}

TEST(ReplayResponseTest, DamageIsReported) {
  const auto reason = [](const v1::StoredContacts& stored) {
    return ReasonOf(
        ReplayContact(stored, 0, SmallPinned(), {.max_frames = 10}).status());
  };
  v1::StoredContacts damaged = TwoContacts();
  damaged.mutable_recording()->resize(damaged.recording().size() / 2);
  EXPECT_EQ(reason(damaged), "DATA_LOST");
  const std::string no_message = "\xFF\xFF\xFF";
  damaged.set_recording(Deflated(no_message));
  damaged.set_recording_bytes(3);
  EXPECT_EQ(reason(damaged), "DATA_LOST");
}

}  // namespace
}  // namespace tactus::internal::server
