// A ContactRecorder that lacks memory or time, and what it costs a stream.
#include <algorithm>
#include <memory>
#include <vector>

#include "core/base/serialize.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "server/contact_log/contact_recorder.h"
#include "tests/server/contact_log/pressed_stream.h"
#include "tests/server/contact_log/random_streams.h"
#include "tests/server/contact_log/recorded_streams.h"
#include "tests/support/allocation_counter.h"

namespace tactus::internal::server {
namespace {

std::vector<std::string> AnswersOf(const RecordedStreamRig& rig) {
  std::vector<std::string> answers;
  for (const v1::Answer& answer : rig.robot().answers()) {
    answers.push_back(SerializeDeterministic(answer));
  }
  return answers;
}

// Contacts of other streams have the memory.
TEST(RecorderLimitsTest, WithoutMemoryContactsAreLeftOut) {
  PressedStream with;
  PressedStream without(1, /*with_recorder=*/false);
  std::vector<int> others;
  const auto contact = [](PressedStream& stream) {
    stream.Quiet(60);
    stream.Press(30);
    stream.Quiet(30);
  };
  contact(with);
  contact(without);
  EXPECT_EQ(with.kept().size(), 1u);
  while (with.rig.pool().free() > 0) others.push_back(with.rig.pool().Take());
  for (int i = 1; i <= 3; ++i) {
    contact(with);
    contact(without);
    // What it has before a contact is a chunk at the most.
    EXPECT_EQ(with.rig.sink().left_out + with.kept().size(), 1u + i);
  }
  EXPECT_GT(with.rig.sink().left_out, 0);
  for (const int chunk : others) with.rig.pool().Give(chunk);
  const size_t before = with.kept().size();
  contact(with);
  contact(without);
  EXPECT_EQ(with.kept().size(), before + 1);
  EXPECT_TRUE(with.kept().back().exact);
  EXPECT_EQ(AnswersOf(with.rig), AnswersOf(without.rig));
  with.rig.Drop();
  EXPECT_EQ(with.rig.taken_chunks(), 0u);
}

// Memory runs out in mid-contact. Such a contact would be kept without its end.
// Nothing would show that: `cut` means a contact that is too long.
TEST(RecorderLimitsTest, AContactThatRunsOutOfMemoryIsLeftOut) {
  for (const size_t chunks : {1, 2, 3, 5}) {
    SCOPED_TRACE(chunks);
    PressedStream stream(chunks);
    stream.Quiet(60);
    stream.Press(700);
    // Its chunks are of use to others at once.
    EXPECT_EQ(stream.rig.taken_chunks(), 0u);
    stream.Quiet(30);
    EXPECT_EQ(stream.rig.sink().left_out, 1);
    EXPECT_TRUE(stream.kept().empty());
    stream.Quiet(51);
    stream.Press(3);
    stream.rig.EndTrial();
    EXPECT_EQ(stream.rig.sink().left_out, 1);
    ASSERT_EQ(stream.kept().size(), 1u);
    EXPECT_FALSE(stream.kept()[0].cut);
    EXPECT_TRUE(stream.kept()[0].exact);
    stream.rig.Drop();
    EXPECT_EQ(stream.rig.taken_chunks(), 0u);
  }
}

TEST(RecorderLimitsTest, ARecordingWaitsForABusySink) {
  PressedStream stream;
  stream.rig.sink().busy = true;
  stream.Press(30);
  stream.Quiet(60);
  EXPECT_TRUE(stream.kept().empty());
  EXPECT_GT(stream.rig.sink().refused, 20);
  stream.rig.sink().busy = false;
  stream.Quiet(1);
  ASSERT_EQ(stream.kept().size(), 1u);
  EXPECT_EQ(stream.kept()[0].stored.contacts(0).end_sequence(), 55u);
  EXPECT_EQ(stream.rig.sink().left_out, 0);
}

TEST(RecorderLimitsTest, OneThatWaitsTooLongIsLeftOut) {
  PressedStream stream;
  stream.rig.sink().busy = true;
  for (int i = 0; i < 3; ++i) {
    stream.Press(30);
    stream.Quiet(60);
  }
  EXPECT_EQ(stream.rig.sink().left_out, 2);
  stream.rig.EndStream();
  // At the end there is time.
  ASSERT_EQ(stream.kept().size(), 1u);
  EXPECT_EQ(stream.kept()[0].stored.contacts(0).contact_id(), 3u);
  stream.rig.Drop();
  EXPECT_EQ(stream.rig.taken_chunks(), 0u);
}

TEST(RecorderLimitsTest, NothingIsLeftOutAtTheEndOfAStream) {
  PressedStream stream;
  stream.rig.sink().busy = true;
  stream.Press(30);
  stream.Quiet(60);
  stream.Press(30);
  stream.rig.EndStream();
  EXPECT_EQ(stream.rig.sink().left_out, 0);
  ASSERT_EQ(stream.kept().size(), 2u);
  EXPECT_EQ(stream.kept()[0].stored.contacts(0).contact_id(), 1u);
  EXPECT_EQ(stream.kept()[1].stored.contacts(0).contact_id(), 2u);
}

// Random streams in little memory with a sink that is busy by turns.
TEST(RecorderLimitsTest, TheStreamIsAnsweredAsWithoutARecorder) {
  const StreamKind kinds[] = {
      {.name = "u16"},
      {.name = "sparse", .sparse = true, .batch = 64, .loss = 0.05},
      {.name = "axes", .type = v1::TAXEL_TYPE_INT16, .axes = 3, .poses = true},
      {.name = "light", .light = true}};
  int kept = 0;
  int left_out = 0;
  for (const StreamKind& kind : kinds) {
    for (uint64_t seed = 1; seed <= 3; ++seed) {
      SCOPED_TRACE(kind.name + ", seed " + std::to_string(seed));
      const RandomStream stream = MakeStream(kind, seed);
      RecordedStreamRig without(stream.config, SmallPinned(), 1, false);
      RunStream(stream, without);
      Random random(seed);
      const size_t chunks = 1 + random.Index(8);
      RecordedStreamRig with(stream.config, SmallPinned(), chunks);
      for (const RandomStream::Step& step : stream.steps) {
        with.sink().busy = random.Uniform() < 0.7;
        if (step.end_of_trial) {
          with.EndTrial();
        } else {
          with.Send(step.batch);
        }
      }
      with.EndStream();
      EXPECT_TRUE(AnswersOf(with) == AnswersOf(without));
      kept += static_cast<int>(with.sink().kept.size());
      left_out += with.sink().left_out;
      with.Drop();
      EXPECT_EQ(with.taken_chunks(), 0u);
    }
  }
  EXPECT_GT(kept, 10);
  EXPECT_GT(left_out, 10);
}

class ForgetfulSink final : public RecordingSink {
 public:
  explicit ForgetfulSink(ChunkPool* pool) : pool_(pool) {}
  bool TryTake(FinishedRecording& recording) override {
    recording.GiveBack(*pool_);
    ++taken;
    return true;
  }
  void Take(FinishedRecording& recording) override { TryTake(recording); }
  void OnLeftOut() override {}

  int taken = 0;

 private:
  ChunkPool* const pool_;
};

class NoAnswers final : public AnswerSink {
 public:
  v1::Answer* AddInterim() override { return &answer_; }
  v1::Answer* AddKept() override { return &answer_; }
  v1::StreamNotice* AddNotice() override { return &notice_; }

 private:
  v1::Answer answer_;
  v1::StreamNotice notice_;
};

TEST(RecorderLimitsTest, AFrameAllocatesNothing) {
  const PinnedModel model = SmallPinned();
  const StreamSettings settings = *ParseStreamConfig(PressedConfig());
  NoAnswers answers;
  ContactSession session(settings, model.model, &answers);
  ChunkPool pool(50);
  ForgetfulSink sink(&pool);
  ContactRecorder recorder(&pool, &sink,
                           std::make_shared<v1::RecordedStream>());
  session.SetTap(&recorder);
  std::vector<v1::FrameBatch> messages;
  for (int round = 0; round < 6; ++round) {
    for (int t = 0; t < 1000; ++t) {
      const bool pressed = t > 600 && t <= 640;
      const bool both = t > 610 && t <= 630;
      testing::Counts counts = pressed ? PressedAt(5, 7) : testing::Untouched();
      if (both) counts = Both(counts, PressedAt(12, 17));
      messages.push_back(
          testing::DenseU16(messages.size() + 1, {counts}).frames());
    }
  }
  const auto run = [&](size_t from, size_t to) {
    for (size_t i = from; i < to; ++i) {
      if (!session.OnFrames(messages[i]).ok()) ADD_FAILURE() << i;
      recorder.EndMessage(&messages[i], 0);
    }
  };
  run(0, 5000);
  const testing::AllocationCounter counter;
  run(5000, 6000);
  EXPECT_EQ(counter.count(), 0);
  EXPECT_EQ(sink.taken, 6);
}

}  // namespace
}  // namespace tactus::internal::server
