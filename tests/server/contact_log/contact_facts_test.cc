#include "server/contact_log/contact_facts.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <vector>

#include "core/base/errors.h"
#include "gtest/gtest.h"
#include "tests/server/contact_log/pressed_stream.h"
#include "tests/server/contact_log/random_streams.h"
#include "tests/server/contact_log/recorded_streams.h"

namespace tactus::internal::server {
namespace {

// The frames of a stream of one axis by their sequence numbers, in newton.
std::map<uint64_t, std::vector<float>> FramesBySequence(
    const RandomStream& stream) {
  std::map<uint64_t, std::vector<float>> frames;
  const bool is_float = stream.config.taxel_type() == v1::TAXEL_TYPE_FLOAT32;
  const auto value_at = [&](const std::string& bytes, size_t index) {
    float value = 0;
    uint16_t count = 0;
    if (is_float) {
      std::memcpy(&value, bytes.data() + index * sizeof value, sizeof value);
    } else {
      std::memcpy(&count, bytes.data() + index * sizeof count, sizeof count);
      value = static_cast<float>(count * testing::kStep);
    }
    return value;
  };
  for (const RandomStream::Step& step : stream.steps) {
    size_t entry = 0;
    for (uint32_t i = 0; i < step.batch.frame_count(); ++i) {
      auto& frame = frames[step.batch.first_sequence() + i];
      frame.resize(testing::kCodyTaxels);
      if (!step.batch.has_sparse()) {
        for (float& value : frame) {
          value = value_at(step.batch.taxels(), entry++);
        }
        continue;
      }
      const v1::SparseFrames& sparse = step.batch.sparse();
      for (uint32_t n = sparse.counts(static_cast<int>(i)); n > 0; --n) {
        uint16_t index = 0;
        std::memcpy(&index, sparse.indices().data() + 2 * entry, 2);
        frame[index] = value_at(sparse.values(), entry++);
      }
    }
  }
  return frames;
}

// The last answer that the robot got while the contact was there, and the
// contact in it.
std::pair<v1::Answer, v1::Contact> LastOf(const RecordedStreamRig& rig,
                                          uint64_t id) {
  std::pair<v1::Answer, v1::Contact> last;
  for (const v1::Answer& answer : rig.robot().answers()) {
    for (const v1::Contact& contact : answer.contacts()) {
      const bool had_ended =
          answer.is_final() && contact.state() == v1::Contact::STATE_RELEASED;
      if (contact.id() == id && !had_ended) last = {answer, contact};
    }
  }
  return last;
}

void ExpectAnswers(const v1::LoggedContact& logged, const v1::Contact& contact,
                   const v1::StreamStarted& started) {
  for (int i = 0; i < started.class_names_size(); ++i) {
    EXPECT_LE(contact.probability(i), logged.confidence());
    if (started.class_names(i) == logged.label()) {
      EXPECT_EQ(contact.probability(i), logged.confidence());
    }
  }
  EXPECT_EQ(logged.unknown(), contact.unknown());
  ASSERT_EQ(logged.answers_size(), started.questions_size());
  for (int q = 0; q < logged.answers_size(); ++q) {
    const v1::LoggedAnswer& answer = logged.answers(q);
    const v1::Question& question = started.questions(q);
    const v1::QuestionAnswer& given = contact.answers(q);
    EXPECT_EQ(answer.question(), question.name());
    const auto value = std::find(question.values().begin(),
                                 question.values().end(), answer.value()) -
                       question.values().begin();
    ASSERT_LT(value, question.values_size());
    EXPECT_EQ(answer.probability(), given.probability(static_cast<int>(value)));
    EXPECT_EQ(answer.decided(), given.has_decision());
    EXPECT_EQ(answer.revised(), given.decision().revised());
    EXPECT_EQ(answer.decided_after_ns(),
              given.decision().time_since_onset_ns());
    if (given.has_decision()) {
      EXPECT_EQ(value, given.decision().value());
    } else {
      EXPECT_EQ(answer.probability(),
                *std::ranges::max_element(given.probability()));
    }
  }
}

// The largest load from the onset to the end, and the first frame that has it.
void ExpectPicture(const v1::LoggedContact& logged,
                   const std::map<uint64_t, std::vector<float>>& frames) {
  float most = 0;
  const std::vector<float>* shown = nullptr;
  for (const auto& [sequence, frame] : frames) {
    if (sequence < logged.onset_sequence()) continue;
    if (sequence > logged.end_sequence()) continue;
    const float largest = *std::ranges::max_element(frame);
    if (largest <= most) continue;
    most = largest;
    shown = &frame;
  }
  ASSERT_NE(shown, nullptr);
  EXPECT_EQ(logged.max_force(), most);
  EXPECT_EQ(logged.picture().most(), most);
  EXPECT_EQ(logged.picture().rows(), 16u);
  EXPECT_EQ(logged.picture().columns(), 24u);
  ASSERT_EQ(logged.picture().loads().size(), shown->size());
  for (size_t i = 0; i < shown->size(); ++i) {
    const auto load = static_cast<uint8_t>(logged.picture().loads()[i]);
    EXPECT_NEAR(load, 255 * (*shown)[i] / most, 0.5001) << i;
  }
}

TEST(ContactFactsTest, AreThoseOfTheRobotsAnswersAndFrames) {
  const StreamKind kinds[] = {
      {.name = "u16", .loss = 0.03},
      {.name = "f32", .type = v1::TAXEL_TYPE_FLOAT32, .batch = 1},
      {.name = "sparse", .sparse = true, .batch = 64}};
  for (const StreamKind& kind : kinds) {
    for (uint64_t seed = 1; seed <= 4; ++seed) {
      SCOPED_TRACE(kind.name + ", seed " + std::to_string(seed));
      const RandomStream stream = MakeStream(kind, seed);
      RecordedStreamRig rig(stream.config);
      RunStream(stream, rig);
      const auto frames = FramesBySequence(stream);
      uint64_t next_id = 1;
      for (const KeptRecordings::Kept& kept : rig.sink().kept) {
        for (const v1::LoggedContact& logged : kept.stored.contacts()) {
          SCOPED_TRACE(logged.contact_id());
          EXPECT_EQ(logged.contact_id(), next_id++);
          EXPECT_EQ(logged.together(), kept.stored.contacts_size());
          EXPECT_EQ(logged.exact(), kept.exact);
          EXPECT_FALSE(logged.cut());
          EXPECT_EQ(logged.robot(), "robot " + kind.name);
          EXPECT_EQ(logged.caller(), "caller");
          EXPECT_EQ(logged.stream_id(), "7");
          EXPECT_EQ(logged.layout(), "random");
          EXPECT_EQ(logged.model_version(), "models/default/versions/1");
          EXPECT_EQ(logged.name(), "");
          const auto [answer, contact] = LastOf(rig, logged.contact_id());
          EXPECT_EQ(logged.onset_sequence(), contact.onset_sequence());
          EXPECT_EQ(logged.end_sequence(), answer.sequence());
          EXPECT_EQ(logged.duration_ns(), contact.time_since_onset_ns());
          // The first frame was captured at 0 of the robot's clock.
          EXPECT_EQ(logged.begin_time_ms(),
                    kFirstMessageMs +
                        10 * static_cast<int64_t>(logged.onset_sequence()));
          ExpectAnswers(logged, contact, kept.stored.stream().started());
          ExpectPicture(logged, frames);
        }
      }
      EXPECT_EQ(next_id - 1, rig.session().contacts_begun());
      EXPECT_GT(next_id, 3u);
    }
  }
}

TEST(ContactFactsTest, ARecordingComesBackAsItWas) {
  PressedStream stream;
  stream.Quiet(20);
  stream.Press(30);
  stream.QuietUntil(1);
  v1::StoredContacts stored = stream.kept()[0].stored;
  const auto recording = RecordingOf(stored);
  ASSERT_TRUE(recording.ok()) << recording.status();
  EXPECT_EQ(recording->SerializeAsString(),
            stream.kept()[0].recording.SerializeAsString());
  stored.set_recording_bytes(stored.recording_bytes() - 1);
  EXPECT_EQ(ReasonOf(RecordingOf(stored).status()), "DATA_LOST");
  stored.set_recording_bytes(UINT32_MAX);
  EXPECT_EQ(ReasonOf(RecordingOf(stored).status()), "DATA_LOST");
  stored.clear_recording();
  EXPECT_EQ(ReasonOf(RecordingOf(stored).status()), "DATA_LOST");
}

// Its last frames are not kept, and the message that ended it came later.
TEST(ContactFactsTest, ALongContactBeganWhenItBegan) {
  PressedStream stream;
  stream.Quiet(20);
  stream.Press(6000);
  stream.QuietUntil(1);
  const v1::LoggedContact& logged = stream.kept()[0].stored.contacts(0);
  ASSERT_TRUE(logged.cut());
  EXPECT_EQ(logged.onset_sequence(), 21u);
  EXPECT_EQ(logged.begin_time_ms(), kFirstMessageMs + 210);
  EXPECT_EQ(logged.duration_ns(), 60'240'000'000);
}

// Robots may count from any time.
TEST(ContactFactsTest, ClocksBelowZeroAreFine) {
  PressedStream stream;
  for (int t = 0; t < 100; ++t) {
    auto request = testing::DenseU16(
        t + 1, {t < 30 || t > 60 ? testing::Untouched() : PressedAt(5, 7)});
    request.mutable_frames()->set_first_capture_time_ns((t - 100'000) *
                                                        int64_t{10'000'000});
    stream.rig.Send(request.frames());
  }
  ASSERT_EQ(stream.kept().size(), 1u);
  EXPECT_EQ(stream.kept()[0].stored.contacts(0).begin_time_ms(),
            kFirstMessageMs + (30 - 100'000) * 10);
}

}  // namespace
}  // namespace tactus::internal::server
