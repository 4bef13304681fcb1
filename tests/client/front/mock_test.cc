#include "tactus/mock.h"

#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/front/front_frames.h"

namespace tactus::internal {
namespace {

using testing::CodyFrame;
using ::testing::ElementsAre;
using testing::PollAll;
using testing::Record;
using testing::Touch;

// A user's program: it counts what slips, and opens its hand when told so.
class Hand {
 public:
  StreamOptions Options() {
    return {.on_answer =
                [this](const Answer& answer) {
                  const Contact* const contact = answer.main();
                  is_open_ = contact != nullptr &&
                             contact->Decided("mobility") == "moved";
                },
            .on_event = [this](const Event&) { ++events_; }};
  }
  bool is_open() const { return is_open_; }
  int events() const { return events_; }

 private:
  bool is_open_ = false;
  int events_ = 0;
};

Answer Slipping() {
  Contact contact;
  contact.id = 1;
  contact.answers = {{.question = "mobility",
                      .values = {{"unmoved", 0.1}, {"moved", 0.9}},
                      .decided = DecidedValue{.value = "moved"}}};
  Answer answer;
  answer.sequence = 7;
  answer.contacts = {contact};
  answer.events = {{.kind = EventKind::kChanged,
                    .contact = 1,
                    .question = "mobility",
                    .value = "moved"}};
  return answer;
}

TEST(MockStreamTest, AProgramIsTestedWithoutAServer) {
  Hand hand;
  MockStream stream(hand.Options(), {.model_version = "mine"});
  EXPECT_EQ(stream.info().model_version, "mine");
  ASSERT_TRUE(stream.Push(CodyFrame(1, Touch(1))).ok());
  ASSERT_EQ(stream.frames().size(), 1u);
  EXPECT_EQ(stream.frames()[0].capture_time_ns, 10'000'000);
  EXPECT_FALSE(hand.is_open());
  stream.Give(Slipping());
  EXPECT_TRUE(hand.is_open());
  EXPECT_EQ(hand.events(), 1);
}

TEST(MockStreamTest, EventsWaitForPoll) {
  MockStream stream;
  stream.Give(Slipping());
  EXPECT_THAT(PollAll(stream),
              ElementsAre("0 ms: contact 1 changed mobility: moved"));
}

TEST(MockStreamTest, TheLastAnswerIsTheFinalOne) {
  Record record;
  MockStream stream(record.Options());
  stream.Give(Slipping());
  const auto answer = stream.EndTrial();
  ASSERT_TRUE(answer.ok());
  EXPECT_TRUE(answer->is_final);
  EXPECT_EQ(answer->sequence, 7u);
  EXPECT_TRUE(answer->events.empty());
  EXPECT_EQ(record.answers().size(), 2u);
  EXPECT_EQ(stream.trials_ended(), 1);
  EXPECT_TRUE(stream.EndTrial()->contacts.empty());
  EXPECT_TRUE(stream.Close().ok());
  EXPECT_TRUE(stream.closed());
  EXPECT_EQ(ReasonOf(stream.Push({})), "STREAM_FINISHED");
}

TEST(MockStreamTest, FailuresAndNoticesComeWhenTheTestSaysSo) {
  std::vector<std::string> notices;
  MockStream stream({.on_notice = [&](const Notice& notice) {
    notices.push_back(notice.text);
  }});
  stream.Give(Notice{.kind = Notice::Kind::kDraining, .text = "soon"});
  EXPECT_THAT(notices, ElementsAre("soon"));
  stream.SetResuming(true);
  EXPECT_TRUE(stream.resuming());
  const absl::Status gone = absl::UnavailableError("gone");
  stream.Fail(gone);
  EXPECT_TRUE(stream.ended());
  EXPECT_EQ(stream.Push({}), gone);
  EXPECT_EQ(stream.EndTrial().status(), gone);
  EXPECT_EQ(stream.Close(), gone);
}

}  // namespace
}  // namespace tactus::internal
