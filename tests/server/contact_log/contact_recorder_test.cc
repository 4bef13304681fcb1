#include "server/contact_log/contact_recorder.h"

#include <algorithm>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/server/contact_log/pressed_stream.h"
#include "tests/server/contact_log/random_streams.h"
#include "tests/server/contact_log/recorded_streams.h"
#include "tests/support/allocation_counter.h"

namespace tactus::internal::server {
namespace {

using testing::Counts;
using ::testing::ElementsAre;
using testing::Untouched;
using Kept = KeptRecordings::Kept;

// A firm contact has ended when it was not felt for 0.25 s.
constexpr int kEndFrames = 25;
// How many messages of one frame of this skin fit into a chunk.
constexpr uint64_t kChunkFrames = 90;

uint64_t FirstFrame(const Kept& kept) {
  return kept.recording.frames(0).first_sequence();
}

uint64_t LastFrame(const Kept& kept) {
  const v1::FrameBatch& last = *kept.recording.frames().rbegin();
  return last.first_sequence() + last.frame_count() - 1;
}

// All frames from the first to the last are there once, in their order.
void ExpectWhole(const Kept& kept) {
  uint64_t next = FirstFrame(kept);
  for (const v1::FrameBatch& batch : kept.recording.frames()) {
    ASSERT_EQ(batch.first_sequence(), next);
    next += batch.frame_count();
  }
}

std::vector<uint64_t> IdsOf(const Kept& kept) {
  std::vector<uint64_t> ids;
  for (const auto& contact : kept.stored.contacts()) {
    ids.push_back(contact.contact_id());
  }
  return ids;
}

TEST(ContactRecorderTest, KeepsAllFramesFromTheStartOfATrial) {
  PressedStream stream;
  stream.Quiet(200);
  stream.Press(30);
  EXPECT_TRUE(stream.kept().empty());
  stream.QuietUntil(1);
  EXPECT_EQ(stream.next, 200u + 30 + kEndFrames + 1);
  const Kept& kept = stream.kept()[0];
  ExpectWhole(kept);
  EXPECT_EQ(FirstFrame(kept), 1u);
  EXPECT_EQ(LastFrame(kept), stream.next - 1);
  EXPECT_TRUE(kept.exact);
  EXPECT_FALSE(kept.cut);
  const auto& answers = kept.recording.answers();
  ASSERT_GE(answers.size(), 2);
  EXPECT_EQ(answers[0].sequence(), 201u);
  EXPECT_EQ(answers[0].events(0).kind(), v1::ContactEvent::KIND_TOUCHED);
  EXPECT_THAT(answers[0].contacts(0).patch().taxels(),
              ElementsAre(127, 128, 129));
  EXPECT_EQ(answers.rbegin()->sequence(), stream.next - 1);
  EXPECT_EQ(answers.rbegin()->contacts(0).state(), v1::Contact::STATE_RELEASED);
  // The messages are as the robot sent them.
  EXPECT_EQ(
      kept.recording.frames(200).SerializeAsString(),
      testing::DenseU16(201, {PressedAt(5, 7)}).frames().SerializeAsString());
  stream.rig.Drop();
  EXPECT_EQ(stream.rig.taken_chunks(), 0u);
}

TEST(ContactRecorderTest, KeepsTheLastFramesBeforeAContact) {
  for (const int quiet : {1000, 1040, 1080}) {
    PressedStream stream;
    stream.Quiet(quiet);
    EXPECT_LE(stream.rig.taken_chunks(), 4u);
    stream.Press(30);
    stream.QuietUntil(1);
    const Kept& kept = stream.kept()[0];
    ExpectWhole(kept);
    const uint64_t before = quiet + 1 - FirstFrame(kept);
    EXPECT_GE(before, 3 * kChunkFrames) << quiet;
    EXPECT_LE(before, 4 * (kChunkFrames + 5)) << quiet;
    EXPECT_TRUE(kept.exact);
  }
}

// The answers of a contact do not depend on what was half a second before.
TEST(ContactRecorderTest, ASecondContactSoonAfterAFirstIsNotExact) {
  for (const int gap : {0, 1, 20, 50, 51, 100}) {
    PressedStream stream;
    stream.Press(30);
    stream.QuietUntil(1);
    const uint64_t end = stream.next - 1;
    stream.Quiet(gap);
    stream.Press(30);
    stream.QuietUntil(2);
    EXPECT_TRUE(stream.kept()[0].exact);
    const Kept& second = stream.kept()[1];
    ExpectWhole(second);
    EXPECT_EQ(FirstFrame(second), end + 1);
    EXPECT_THAT(IdsOf(second), ElementsAre(2));
    EXPECT_EQ(second.exact, gap >= 51) << gap;
  }
}

TEST(ContactRecorderTest, ContactsAtOnceAreOneRecording) {
  PressedStream stream;
  stream.Quiet(10);
  stream.Press(30);
  stream.Same(40, Both(PressedAt(5, 7), PressedAt(12, 17)));
  // The first ends in this time.
  stream.Same(40, PressedAt(12, 17));
  EXPECT_TRUE(stream.kept().empty());
  stream.QuietUntil(1);
  const Kept& kept = stream.kept()[0];
  ExpectWhole(kept);
  EXPECT_THAT(IdsOf(kept), ElementsAre(1, 2));
  EXPECT_TRUE(kept.exact);
  EXPECT_EQ(kept.stored.contacts(0).together(), 2u);
  EXPECT_EQ(kept.stored.contacts(0).end_sequence(), 80u + kEndFrames);
  EXPECT_EQ(kept.stored.contacts(1).end_sequence(), stream.next - 1);
}

TEST(ContactRecorderTest, AMessageInWhichOneEndsAndAnotherBegins) {
  PressedStream stream;
  stream.Quiet(60);
  stream.Press(30);
  std::vector<Counts> frames(40, Untouched());
  frames.insert(frames.end(), 20, PressedAt(12, 17));
  stream.Send(frames);
  EXPECT_TRUE(stream.kept().empty());
  stream.QuietUntil(1);
  const Kept& kept = stream.kept()[0];
  ExpectWhole(kept);
  EXPECT_THAT(IdsOf(kept), ElementsAre(1, 2));
  EXPECT_TRUE(kept.exact);
}

TEST(ContactRecorderTest, AMessageWithWholeContacts) {
  PressedStream stream;
  std::vector<Counts> frames(3, Untouched());
  frames.insert(frames.end(), 3, PressedAt(5, 7));
  frames.insert(frames.end(), 52, Untouched());
  frames.insert(frames.end(), 3, PressedAt(5, 7));
  stream.Send(frames);
  EXPECT_TRUE(stream.kept().empty());
  // The rest of a message in which the last one ends is kept.
  frames.assign(60, Untouched());
  stream.Send(frames);
  ASSERT_EQ(stream.kept().size(), 1u);
  EXPECT_THAT(IdsOf(stream.kept()[0]), ElementsAre(1, 2));
  EXPECT_EQ(LastFrame(stream.kept()[0]), 121u);
  EXPECT_TRUE(stream.kept()[0].exact);
}

TEST(ContactRecorderTest, TheEndOfATrialEndsARecording) {
  PressedStream stream;
  stream.Quiet(5);
  stream.Press(30);
  stream.rig.EndTrial();
  ASSERT_EQ(stream.kept().size(), 1u);
  EXPECT_TRUE(stream.kept()[0].recording.answers().rbegin()->is_final());
  EXPECT_EQ(LastFrame(stream.kept()[0]), 35u);
  // Nothing of the first trial matters to the next.
  stream.Press(30);
  stream.rig.EndTrial();
  ASSERT_EQ(stream.kept().size(), 2u);
  EXPECT_EQ(FirstFrame(stream.kept()[1]), 36u);
  EXPECT_TRUE(stream.kept()[1].exact);
  EXPECT_THAT(IdsOf(stream.kept()[1]), ElementsAre(2));
  // A trial without a contact, and one whose contact has ended before.
  stream.Quiet(200);
  stream.rig.EndTrial();
  stream.Press(30);
  stream.QuietUntil(3);
  EXPECT_EQ(FirstFrame(stream.kept()[2]), 266u);
  EXPECT_TRUE(stream.kept()[2].exact);
  stream.Quiet(10);
  stream.rig.EndTrial();
  stream.rig.EndTrial();
  EXPECT_EQ(stream.kept().size(), 3u);
  stream.rig.Drop();
  EXPECT_EQ(stream.rig.taken_chunks(), 0u);
}

TEST(ContactRecorderTest, TheEndOfTheStreamEndsARecording) {
  for (const bool is_broken : {false, true}) {
    PressedStream stream;
    stream.Quiet(5);
    stream.Press(30);
    if (is_broken) {
      stream.rig.Break();
    } else {
      stream.rig.EndStream();
    }
    ASSERT_EQ(stream.kept().size(), 1u);
    const Kept& kept = stream.kept()[0];
    EXPECT_EQ(kept.recording.answers().rbegin()->is_final(), !is_broken);
    EXPECT_EQ(LastFrame(kept), 35u);
    EXPECT_TRUE(kept.exact);
    stream.rig.Drop();
    EXPECT_EQ(stream.rig.taken_chunks(), 0u);
  }
  PressedStream stream;
  stream.Quiet(5);
  stream.rig.EndStream();
  EXPECT_TRUE(stream.kept().empty());
}

TEST(ContactRecorderTest, AContactThatIsTooLongIsCut) {
  PressedStream stream;
  stream.Quiet(20);
  stream.Press(4000);
  EXPECT_LE(stream.rig.taken_chunks(), 32u);
  stream.QuietUntil(1);
  const Kept& kept = stream.kept()[0];
  ExpectWhole(kept);
  EXPECT_TRUE(kept.cut);
  EXPECT_FALSE(kept.exact);
  EXPECT_TRUE(kept.stored.contacts(0).cut());
  EXPECT_EQ(FirstFrame(kept), 1u);
  EXPECT_GT(LastFrame(kept), 28 * kChunkFrames);
  EXPECT_LT(LastFrame(kept), 28 * (kChunkFrames + 5));
  // The answers are there to its end.
  EXPECT_EQ(kept.recording.answers().rbegin()->sequence(), stream.next - 1);
  EXPECT_EQ(kept.stored.contacts(0).end_sequence(), stream.next - 1);
  EXPECT_EQ(stream.rig.sink().left_out, 0);
  // The next is as any other.
  stream.Quiet(60);
  stream.Press(30);
  stream.QuietUntil(2);
  EXPECT_TRUE(stream.kept()[1].exact);
  EXPECT_FALSE(stream.kept()[1].cut);
}

}  // namespace
}  // namespace tactus::internal::server
