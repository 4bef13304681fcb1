#include "core/stream/contact_session.h"

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/base/errors.h"
#include "core/skin/layout.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/server/support/requests.h"
#include "tests/support/allocation_counter.h"
#include "tests/support/small_model.h"

namespace tactus::internal {
namespace {

using ::testing::Contains;
using testing::DenseU16;
using ::testing::ElementsAre;
using ::testing::Not;
using testing::Touch;
using testing::Untouched;

// Says how each answer came: interim, kept, or a notice.
class Sink : public AnswerSink {
 public:
  v1::Answer* AddInterim() override { return Add("interim"); }
  v1::Answer* AddKept() override { return Add("kept"); }
  v1::StreamNotice* AddNotice() override {
    came_.emplace_back("notice");
    return &notice_;
  }

  std::vector<std::string> Take() { return std::exchange(came_, {}); }
  const v1::Answer& answer() const { return answer_; }
  const v1::StreamNotice& notice() const { return notice_; }

 private:
  v1::Answer* Add(const char* how) {
    came_.emplace_back(how);
    return &answer_;
  }

  std::vector<std::string> came_;
  v1::Answer answer_;
  v1::StreamNotice notice_;
};

StreamSettings Settings(v1::ResultCadence cadence) {
  v1::StreamConfig config = testing::ConfigRequest().config();
  config.set_cadence(cadence);
  return *ParseStreamConfig(config);
}

std::shared_ptr<const CompiledModel> SmallCompiled() {
  return *CompiledModel::Create(testing::SmallModel());
}

TEST(ContactSessionTest, AnswersWithEventsAreKept) {
  Sink sink;
  ContactSession session(Settings(v1::RESULT_CADENCE_EVERY_FRAME),
                         SmallCompiled(), &sink);
  const auto batch = DenseU16(1, {Untouched(), Touch(2), Touch(2)});
  ASSERT_TRUE(session.OnFrames(batch.frames()).ok());
  EXPECT_TRUE(session.trial_open());
  EXPECT_EQ(session.frames(), 3u);
  EXPECT_THAT(sink.Take(), ElementsAre("interim", "kept", "interim"));
  session.OnEndOfTrial();
  EXPECT_FALSE(session.trial_open());
  EXPECT_THAT(sink.Take(), ElementsAre("kept"));
  EXPECT_TRUE(sink.answer().is_final());
  EXPECT_EQ(sink.answer().contacts_size(), 1);
}

TEST(ContactSessionTest, TheCadenceOfEventsGivesNoInterimAnswers) {
  Sink sink;
  ContactSession session(Settings(v1::RESULT_CADENCE_EVENTS), SmallCompiled(),
                         &sink);
  const auto batch = DenseU16(1, {Untouched(), Touch(2), Touch(2)});
  ASSERT_TRUE(session.OnFrames(batch.frames()).ok());
  EXPECT_THAT(sink.Take(), ElementsAre("kept"));
}

TEST(ContactSessionTest, AWrongBatchChangesNothing) {
  Sink sink;
  ContactSession session(Settings(v1::RESULT_CADENCE_EVERY_FRAME),
                         SmallCompiled(), &sink);
  ASSERT_TRUE(session.OnFrames(DenseU16(5, {Touch(1)}).frames()).ok());
  sink.Take();
  EXPECT_EQ(ReasonOf(session.OnFrames(DenseU16(5, {Touch(1)}).frames())),
            "SEQUENCE_REGRESSION");
  EXPECT_TRUE(sink.Take().empty());
  EXPECT_EQ(session.frames(), 1u);
  ASSERT_TRUE(session.OnFrames(DenseU16(7, {Touch(1)}).frames()).ok());
  EXPECT_EQ(sink.answer().frames_missing(), 1u);
}

// A model of all taxels that has never felt any load.
Model ModelWithSkinRange() {
  Model model = testing::SmallModel();
  model.layout = *LayoutPreset("cody-forearm");
  model.hmms.clear();
  model.inputs.hmm.clear();
  Nearest& nearest = model.nearest.emplace();
  nearest.views.rows = model.layout.rows;
  nearest.views.columns = model.layout.columns;
  nearest.views.block = HistoryBlock(nearest.views.shape());
  nearest.classes = model.classes();
  nearest.gain.assign(nearest.numbers(), 1);
  nearest.sample.assign(nearest.numbers() * model.classes(), 0);
  nearest.label = {0, 1, 2, 3};
  const size_t taxels = model.layout.taxels();
  model.skin_range = {std::vector<float>(taxels), std::vector<float>(taxels)};
  return model;
}

TEST(ContactSessionTest, ASkinThatReadsUnlikeTrainingIsToldOnce) {
  const auto model = CompiledModel::Create(ModelWithSkinRange());
  ASSERT_TRUE(model.ok()) << model.status();
  Sink sink;
  ContactSession session(Settings(v1::RESULT_CADENCE_EVERY_FRAME), *model,
                         &sink);
  uint64_t sequence = 1;
  for (int contact = 1; contact <= 12; ++contact) {
    const auto batch = DenseU16(sequence, {Untouched(), Touch(2), Touch(2)});
    sequence += 3;
    ASSERT_TRUE(session.OnFrames(batch.frames()).ok());
    session.OnEndOfTrial();
    const bool told = contact == SkinRangeWatch::kContacts;
    EXPECT_EQ(std::ranges::count(sink.Take(), "notice"), told) << contact;
  }
  const v1::StreamNotice& notice = sink.notice();
  EXPECT_EQ(notice.kind(), v1::StreamNotice::KIND_SKIN_DIFFERS);
  // Those that Touch() presses.
  EXPECT_EQ(notice.differing_taxels(), 4u);
  ASSERT_EQ(notice.taxels_size(), 4);
  EXPECT_GT(notice.taxels(0).load(), 0);
  EXPECT_EQ(notice.taxels(0).most_trained(), 0);
}

// What light touch still feels of a load that is gone shrinks to where the load
// was largest: the contact has not moved.
TEST(ContactSessionTest, ALoadThatFadesDoesNotMoveOverTheSkin) {
  v1::StreamConfig config = testing::ConfigRequest().config();
  config.clear_never_release();
  v1::LightTouch& light = *config.mutable_geometry()->mutable_light_touch();
  light.set_window_s(0.1);
  light.set_rows(3);
  light.set_columns(3);
  light.set_contact_threshold(0.0004);
  light.set_onset_threshold(0.0006);
  config.set_scale(0.0001);
  Sink sink;
  ContactSession session(*ParseStreamConfig(config), SmallCompiled(), &sink);
  // At first, the load is the same everywhere.
  testing::Counts begin = Untouched();
  testing::Counts strip = Untouched();
  for (int row = 2; row < 14; ++row) {
    begin[row * 24 + 5] = 500;
    strip[row * 24 + 5] = row < 5 ? 500 : 60;
  }
  std::vector<v1::ContactEvent::Kind> events;
  for (uint64_t t = 1; t <= 200; ++t) {
    const bool pressed = t > 60 && t <= 110;
    const auto batch =
        DenseU16(t, {pressed ? (t <= 80 ? begin : strip) : Untouched()});
    ASSERT_TRUE(session.OnFrames(batch.frames()).ok());
    for (const v1::ContactEvent& event : sink.answer().events()) {
      events.push_back(event.kind());
    }
  }
  EXPECT_THAT(events, Contains(v1::ContactEvent::KIND_RELEASED));
  EXPECT_THAT(events, Not(Contains(v1::ContactEvent::KIND_MOVED_OVER_SKIN)));
}

TEST(ContactSessionTest, ATrialWithoutFramesHasAnEmptyFinal) {
  Sink sink;
  ContactSession session(Settings(v1::RESULT_CADENCE_EVERY_FRAME),
                         SmallCompiled(), &sink);
  session.OnEndOfTrial();
  EXPECT_THAT(sink.Take(), ElementsAre("kept"));
  EXPECT_TRUE(sink.answer().is_final());
  EXPECT_EQ(sink.answer().contacts_size(), 0);
}

TEST(ContactSessionTest, AnotherRateIsNoticedOnce) {
  Sink sink;
  ContactSession session(Settings(v1::RESULT_CADENCE_EVENTS), SmallCompiled(),
                         &sink);
  for (uint64_t i = 1; i <= 500; ++i) {
    auto request = DenseU16(i, {Untouched()});
    request.mutable_frames()->set_first_capture_time_ns(20'000'000 * i);
    ASSERT_TRUE(session.OnFrames(request.frames()).ok());
  }
  EXPECT_THAT(sink.Take(), ElementsAre("notice"));
  EXPECT_NEAR(sink.notice().measured_rate_hz(), 50, 0.1);
  EXPECT_EQ(sink.notice().stated_rate_hz(), 100);
}

class QuietSink : public AnswerSink {
 public:
  v1::Answer* AddInterim() override { return &answer_; }
  v1::Answer* AddKept() override { return &answer_; }
  v1::StreamNotice* AddNotice() override { return &notice_; }

 private:
  v1::Answer answer_;
  v1::StreamNotice notice_;
};

TEST(ContactSessionTest, AFrameAllocatesNothing) {
  QuietSink sink;
  ContactSession session(Settings(v1::RESULT_CADENCE_EVERY_FRAME),
                         SmallCompiled(), &sink);
  auto request = DenseU16(1, {Touch(2)});
  v1::FrameBatch& frames = *request.mutable_frames();
  const auto step = [&] {
    frames.set_first_sequence(frames.first_sequence() + 1);
    frames.set_first_capture_time_ns(frames.first_capture_time_ns() +
                                     10'000'000);
    ASSERT_TRUE(session.OnFrames(frames).ok());
  };
  for (int i = 0; i < 50; ++i) step();
  const testing::AllocationCounter counter;
  for (int i = 0; i < 50; ++i) step();
  EXPECT_EQ(counter.count(), 0);
}

}  // namespace
}  // namespace tactus::internal
