#include "server/session/stream_session.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <numbers>
#include <thread>

#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/skin/geometry.h"
#include "gtest/gtest.h"
#include "tests/server/support/requests.h"
#include "tests/server/support/test_models.h"
#include "tests/support/allocation_counter.h"

namespace tactus::internal::server {
namespace {

using State = StreamSession::State;
using testing::ConfigRequest;
using testing::Counts;
using testing::DenseF32;
using testing::DenseU16;
using testing::EndOfTrialRequest;
using testing::Touch;
using testing::Untouched;

double Score(const v1::Answer& answer) {
  return answer.diagnostics().contacts(0).log_likelihood(2);
}

class StreamSessionTest : public ::testing::Test {
 protected:
  static const testing::TestModels& models() {
    static const auto* const models = new testing::TestModels();
    return *models;
  }

  void Start(const v1::ClassifyContactRequest& config = ConfigRequest()) {
    ASSERT_TRUE(session_.OnRequest(config).ok());
    started_ = Next().started();
  }
  void Send(const v1::ClassifyContactRequest& request) {
    const absl::Status status = session_.OnRequest(request);
    ASSERT_TRUE(status.ok()) << status;
  }
  // The next answer; an empty message if none waits.
  v1::ClassifyContactResponse Next() {
    const auto* response = session_.responses().StartWrite(0);
    if (response == nullptr) return {};
    v1::ClassifyContactResponse copy = *response;
    session_.responses().FinishWrite();
    return copy;
  }
  std::vector<v1::Answer> Answers() {
    std::vector<v1::Answer> result;
    for (auto next = Next(); next.has_answer(); next = Next()) {
      result.push_back(next.answer());
    }
    return result;
  }

  StreamSession session_{
      &models(),
      {.stream_id = "s-1", .server_version = "9.9", .idle_timeout_ms = 1234}};
  v1::StreamStarted started_;
};

TEST_F(StreamSessionTest, StartedHasModelLimitsAndGeometry) {
  Start();
  EXPECT_EQ(started_.model_version(), "models/default/versions/1");
  EXPECT_EQ(started_.bundle_sha256(), std::string(64, 'a'));
  ASSERT_EQ(started_.class_names_size(), 4);
  EXPECT_EQ(started_.class_names(3), "SM");
  ASSERT_EQ(started_.features_size(), 2);
  EXPECT_EQ(started_.features(1), "motion");
  ASSERT_EQ(started_.questions_size(), 2);
  EXPECT_EQ(started_.questions(0).name(), "hardness");
  EXPECT_EQ(started_.questions(0).kind(), v1::Question::KIND_PROPERTY);
  EXPECT_EQ(started_.questions(1).kind(), v1::Question::KIND_STATE);
  EXPECT_EQ(started_.questions(1).values(1), "moved");
  EXPECT_EQ(started_.questions(1).value_of_class(3), 1u);
  EXPECT_EQ(started_.limits().max_contacts(), 1u);
  EXPECT_EQ(started_.stream_id(), "s-1");
  EXPECT_EQ(started_.limits().max_frames_per_message(),
            limits::kMaxFramesPerMessage);
  EXPECT_EQ(started_.limits().max_message_bytes(), limits::kMaxMessageBytes);
  EXPECT_EQ(started_.limits().idle_timeout_ms(), 1234u);
  EXPECT_EQ(started_.server().version(), "9.9");
  EXPECT_EQ(started_.geometry().rows(), 16u);
  EXPECT_EQ(started_.geometry().columns(), 24u);
  EXPECT_TRUE(started_.geometry().wrap_columns());
  EXPECT_GT(started_.geometry().contact_threshold(), 0);
  // The model fits any skin.
  EXPECT_FALSE(started_.has_trained_geometry());
}

TEST_F(StreamSessionTest, WalksThroughItsFourStates) {
  EXPECT_EQ(session_.state(), State::kWaitConfig);
  Start();
  EXPECT_EQ(session_.state(), State::kStreaming);
  Send(DenseU16(1, {Touch(1)}));
  session_.OnHalfClose();
  EXPECT_EQ(session_.state(), State::kFinishing);
  EXPECT_EQ(Answers().size(), 2u);
  EXPECT_EQ(session_.state(), State::kDone);
  EXPECT_TRUE(session_.final_status().ok());
}

TEST_F(StreamSessionTest, HalfCloseWithoutFramesIsFineAndSilent) {
  Start();
  session_.OnHalfClose();
  EXPECT_EQ(session_.state(), State::kDone);
  EXPECT_TRUE(session_.final_status().ok());
}

TEST_F(StreamSessionTest, HalfCloseAfterEndOfTrialGivesNoSecondFinal) {
  Start();
  Send(DenseU16(1, {Touch(1)}));
  Send(EndOfTrialRequest());
  session_.OnHalfClose();
  const auto answers = Answers();
  ASSERT_EQ(answers.size(), 2u);
  EXPECT_FALSE(answers[0].is_final());
  EXPECT_TRUE(answers[1].is_final());
}

TEST_F(StreamSessionTest, EndOfAnEmptyTrialHasNoContact) {
  Start();
  Send(EndOfTrialRequest());
  const auto answers = Answers();
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_TRUE(answers[0].is_final());
  EXPECT_EQ(answers[0].contacts_size(), 0);
  EXPECT_EQ(answers[0].events_size(), 0);
}

TEST_F(StreamSessionTest, AnswersFollowTheContact) {
  auto config = ConfigRequest();
  config.mutable_config()->set_with_taxels(true);
  config.mutable_config()->set_with_diagnostics(true);
  Start(config);
  Send(DenseU16(7, {Untouched(), Touch(1), Touch(2)}));
  const auto answers = Answers();
  ASSERT_EQ(answers.size(), 3u);
  EXPECT_EQ(answers[0].sequence(), 7u);
  EXPECT_EQ(answers[0].contacts_size(), 0);
  EXPECT_EQ(answers[0].region_count(), 0u);
  ASSERT_EQ(answers[1].events_size(), 1);
  EXPECT_EQ(answers[1].events(0).kind(), v1::ContactEvent::KIND_TOUCHED);
  EXPECT_EQ(answers[1].events(0).contact_id(), 1u);
  const v1::Answer& last = answers[2];
  EXPECT_EQ(last.sequence(), 9u);
  EXPECT_EQ(last.capture_time_ns(), 90'000'000);
  EXPECT_EQ(last.region_count(), 1u);
  EXPECT_EQ(last.events_size(), 0);
  ASSERT_EQ(last.contacts_size(), 1);
  const v1::Contact& contact = last.contacts(0);
  EXPECT_EQ(contact.state(), v1::Contact::STATE_TOUCHING);
  EXPECT_EQ(contact.id(), 1u);
  EXPECT_EQ(contact.onset_sequence(), 8u);
  EXPECT_EQ(contact.time_since_onset_ns(), 10'000'000);
  double sum = 0;
  for (double p : contact.probability()) sum += p;
  EXPECT_NEAR(sum, 1, 1e-12);
  ASSERT_EQ(contact.answers_size(), 2);
  EXPECT_DOUBLE_EQ(contact.answers(0).probability(0),
                   contact.probability(0) + contact.probability(1));
  const v1::ContactPatch& patch = contact.patch();
  EXPECT_DOUBLE_EQ(patch.max_force(), 2);
  EXPECT_NEAR(patch.force(), 8, 1e-6);
  EXPECT_EQ(patch.area_taxels(), 4u);
  EXPECT_EQ(
      (std::vector<uint32_t>(patch.taxels().begin(), patch.taxels().end())),
      (std::vector<uint32_t>{127, 128, 129, 130}));
  const v1::ContactScores& scores = last.diagnostics().contacts(0);
  EXPECT_EQ(scores.log_likelihood_size(), 4);
  EXPECT_EQ(scores.lstm_probability_size(), 0);
}

// The region lies in row 5, columns 7 to 10 of the cylinder.
TEST_F(StreamSessionTest, APatchHasItsPlaceOnTheLinkAndInTheWorld) {
  auto config = ConfigRequest();
  config.mutable_config()->set_with_poses(true);
  Start(config);
  Pose pose;
  pose.position = {1, 2, 3};
  pose.orientation =
      Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ());
  auto counts = Touch(1);
  // All of the load in column 10.
  for (int column = 7; column < 10; ++column) counts[5 * 24 + column] = 25;
  counts[5 * 24 + 10] = 25'000;
  auto request = DenseU16(1, {counts});
  testing::AddPose(pose, request.mutable_frames());
  Send(request);
  const auto answers = Answers();
  const v1::ContactPatch& patch = answers[0].contacts(0).patch();
  const SkinLayout layout = *LayoutPreset("cody-forearm");
  const auto expect = [](const v1::Vector3& got, const Eigen::Vector3d& want,
                         double tolerance) {
    EXPECT_NEAR(got.x(), want.x(), tolerance);
    EXPECT_NEAR(got.y(), want.y(), tolerance);
    EXPECT_NEAR(got.z(), want.z(), tolerance);
  };
  const Eigen::Vector3d centroid = LinkPosition(layout, {5, 8.5});
  expect(patch.centroid().link(), centroid, 1e-12);
  expect(patch.centroid().world(),
         {1 - centroid.y(), 2 + centroid.x(), 3 + centroid.z()}, 1e-12);
  const Eigen::Vector3d normal = LinkNormal(layout, {5, 8.5});
  expect(patch.centroid().link_normal(), normal, 1e-12);
  expect(patch.centroid().world_normal(), {-normal.y(), normal.x(), normal.z()},
         1e-12);
  expect(patch.centre_of_pressure().link(), LinkPosition(layout, {5, 10}),
         0.0005);
  EXPECT_GT(std::abs(patch.centre_of_pressure().link().x() - centroid.x()),
            0.002);
}

TEST_F(StreamSessionTest, DecisionsStayWithTheirContactOnly) {
  auto config = ConfigRequest();
  config.mutable_config()->set_decision_threshold(0.51);
  config.mutable_config()->set_decision_frames(3);
  config.mutable_config()->set_cadence(v1::RESULT_CADENCE_EVENTS);
  Start(config);
  for (int t = 0; t < 120; ++t) Send(DenseU16(1 + t, {Touch(2.7)}));
  auto answers = Answers();
  std::map<uint32_t, v1::Decision> decisions;
  for (const v1::Answer& answer : answers) {
    ASSERT_GT(answer.events_size(), 0);
    for (const v1::ContactEvent& event : answer.events()) {
      if (event.kind() != v1::ContactEvent::KIND_DECIDED) continue;
      const v1::Decision& decision =
          answer.contacts(0).answers(event.question()).decision();
      EXPECT_EQ(decision.value(), event.value());
      EXPECT_EQ(decision.sequence(), answer.sequence());
      EXPECT_EQ(decision.time_since_onset_ns(),
                static_cast<int64_t>(answer.sequence() - 1) * 10'000'000);
      EXPECT_TRUE(decisions.emplace(event.question(), decision).second);
    }
  }
  EXPECT_FALSE(decisions.empty());
  Send(EndOfTrialRequest());
  answers = Answers();
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_TRUE(answers[0].is_final());
  for (const auto& [question, decision] : decisions) {
    EXPECT_EQ(answers[0].contacts(0).answers(question).decision().sequence(),
              decision.sequence());
  }
  Send(DenseU16(1000, {Touch(2.7)}));
  answers = Answers();
  EXPECT_FALSE(answers[0].contacts(0).answers(0).has_decision());
}

TEST_F(StreamSessionTest, ContactEndIsReportedOnItsFrameAtAnyCadence) {
  auto config = ConfigRequest();
  config.mutable_config()->clear_never_release();
  config.mutable_config()->set_release_after_ms(30);
  config.mutable_config()->set_cadence(v1::RESULT_CADENCE_EVENTS);
  Start(config);
  EXPECT_EQ(started_.limits().max_contacts(),
            static_cast<uint32_t>(limits::kMaxContacts));
  Send(DenseU16(1, {Touch(1), Untouched(), Untouched(), Untouched(),
                    Untouched(), Untouched()}));
  auto answers = Answers();
  ASSERT_EQ(answers.size(), 2u);
  EXPECT_EQ(answers[0].events(0).kind(), v1::ContactEvent::KIND_TOUCHED);
  EXPECT_EQ(answers[1].events(0).kind(), v1::ContactEvent::KIND_RELEASED);
  EXPECT_FALSE(answers[1].is_final());
  ASSERT_EQ(answers[1].contacts_size(), 1);
  EXPECT_EQ(answers[1].contacts(0).state(), v1::Contact::STATE_RELEASED);
  EXPECT_FALSE(answers[1].contacts(0).has_patch());
  EXPECT_FALSE(answers[1].contacts(0).has_motion_m());
  EXPECT_EQ(answers[1].sequence(), 4u);
  // The final shows it again, and it does not end twice.
  Send(EndOfTrialRequest());
  answers = Answers();
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_EQ(answers[0].contacts(0).id(), 1u);
  EXPECT_EQ(answers[0].contacts(0).state(), v1::Contact::STATE_RELEASED);
  EXPECT_EQ(answers[0].events_size(), 0);
}

TEST_F(StreamSessionTest, TheEndOfATrialEndsItsContacts) {
  Start();
  Send(DenseU16(1, {Touch(1)}));
  Answers();
  Send(EndOfTrialRequest());
  const auto answers = Answers();
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_EQ(answers[0].contacts(0).state(), v1::Contact::STATE_TOUCHING);
  ASSERT_EQ(answers[0].events_size(), 1);
  EXPECT_EQ(answers[0].events(0).kind(), v1::ContactEvent::KIND_RELEASED);
  EXPECT_EQ(answers[0].events(0).contact_id(), 1u);
}

// Two regions far apart: two contacts, the larger first, each with its events.
TEST_F(StreamSessionTest, TwoTouchesAreTwoContacts) {
  auto config = ConfigRequest();
  config.mutable_config()->clear_never_release();
  Start(config);
  const auto scene = [](int first, int second) {
    Counts counts = Touch(1, first);
    for (int i = 0; i < second; ++i) counts[12 * 24 + 18 + i] = 1000;
    return counts;
  };
  std::vector<v1::Answer> answers;
  for (uint64_t t = 1; t <= 120; ++t) {
    Send(DenseU16(t, {scene(t <= 20 ? 3 : 0, t > 10 ? 5 : 0)}));
    answers.push_back(Answers().at(0));
  }
  ASSERT_EQ(answers.size(), 120u);
  // It must be there in two frames.
  EXPECT_EQ(answers[10].contacts_size(), 1);
  EXPECT_EQ(answers[10].region_count(), 2u);
  ASSERT_EQ(answers[11].contacts_size(), 2);
  EXPECT_EQ(answers[11].contacts(0).id(), 2u);
  EXPECT_EQ(answers[11].contacts(0).patch().area_taxels(), 5u);
  EXPECT_EQ(answers[11].contacts(1).id(), 1u);
  EXPECT_EQ(answers[11].contacts(1).patch().area_taxels(), 3u);
  EXPECT_EQ(answers[20].contacts(1).state(), v1::Contact::STATE_LOST);
  std::vector<std::pair<v1::ContactEvent::Kind, uint64_t>> events;
  for (const v1::Answer& answer : answers) {
    for (const v1::ContactEvent& event : answer.events()) {
      if (event.kind() == v1::ContactEvent::KIND_TOUCHED ||
          event.kind() == v1::ContactEvent::KIND_RELEASED) {
        events.emplace_back(event.kind(), event.contact_id());
      }
    }
  }
  using Event = v1::ContactEvent;
  EXPECT_EQ(events, (std::vector<std::pair<Event::Kind, uint64_t>>{
                        {Event::KIND_TOUCHED, 1},
                        {Event::KIND_TOUCHED, 2},
                        {Event::KIND_RELEASED, 1}}));
}

TEST_F(StreamSessionTest, CadenceOfEveryThirdFrameCountsWithinTheTrial) {
  auto config = ConfigRequest();
  config.mutable_config()->set_cadence(v1::RESULT_CADENCE_EVERY_N_FRAMES);
  config.mutable_config()->set_result_interval_frames(3);
  Start(config);
  for (int trial = 0; trial < 2; ++trial) {
    const uint64_t first = 1 + 100 * trial;
    Send(DenseU16(first, std::vector(7, Untouched())));
    Send(EndOfTrialRequest());
    const auto answers = Answers();
    ASSERT_EQ(answers.size(), 3u);
    EXPECT_EQ(answers[0].sequence(), first + 2);
    EXPECT_EQ(answers[1].sequence(), first + 5);
    EXPECT_TRUE(answers[2].is_final());
  }
}

TEST_F(StreamSessionTest, CadenceOnChangeIsSilentWhileNothingChanges) {
  auto config = ConfigRequest();
  config.mutable_config()->set_cadence(v1::RESULT_CADENCE_ON_CHANGE);
  Start(config);
  Send(DenseU16(1, std::vector(20, Untouched())));
  EXPECT_TRUE(Answers().empty());
  Send(DenseU16(21, {Touch(1)}));
  const auto answers = Answers();
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_EQ(answers[0].contacts(0).state(), v1::Contact::STATE_TOUCHING);
}

TEST_F(StreamSessionTest, GapsAreCountedPerTrialAndChangeTheScores) {
  auto config = ConfigRequest();
  config.mutable_config()->set_with_diagnostics(true);
  Start(config);
  Send(DenseU16(1, {Touch(1), Touch(1)}));
  auto answers = Answers();
  EXPECT_EQ(answers.back().frames_missing(), 0u);
  Send(DenseU16(6, {Touch(1)}));
  answers = Answers();
  ASSERT_EQ(answers.back().sequence(), 6u);
  EXPECT_EQ(answers.back().frames_missing(), 3u);
  const double with_gap = Score(answers.back());
  Send(EndOfTrialRequest());
  // Between trials, sequences may jump by any amount.
  Send(DenseU16(1000, {Touch(1), Touch(1), Touch(1)}));
  answers = Answers();
  EXPECT_EQ(answers.back().frames_missing(), 0u);
  EXPECT_NE(Score(answers.back()), with_gap);
}

TEST_F(StreamSessionTest, AHugeGapIsBridgedAtOnce) {
  auto config = ConfigRequest();
  config.mutable_config()->set_with_diagnostics(true);
  Start(config);
  Send(DenseU16(1, {Touch(1)}));
  auto far = DenseU16(2, {Touch(1)});
  far.mutable_frames()->set_first_sequence(1'000'000'000'000);
  Send(far);
  const auto answers = Answers();
  EXPECT_EQ(answers.back().frames_missing(), 1'000'000'000'000 - 2u);
  EXPECT_TRUE(std::isfinite(Score(answers.back())));
}

TEST_F(StreamSessionTest, TheGeometryOfTrainingIsStated) {
  auto config = ConfigRequest();
  config.mutable_config()->set_model("models/vitac");
  config.mutable_config()->mutable_geometry()->set_layout("vitac-12x32");
  Start(config);
  EXPECT_EQ(started_.geometry().contact_threshold(), 20);
  EXPECT_EQ(started_.truth(), v1::TRUTH_FINAL);
  EXPECT_EQ(started_.trained_geometry().contact_threshold(), 20);
  EXPECT_EQ(started_.trained_geometry().layout(), "vitac-12x32");
}

TEST_F(StreamSessionTest, MaskedTaxelsMayHoldAnything) {
  auto config = ConfigRequest();
  config.mutable_config()->mutable_geometry()->add_masked_taxels(3);
  config.mutable_config()->set_taxel_type(v1::TAXEL_TYPE_FLOAT32);
  config.mutable_config()->set_scale(1);
  Start(config);
  for (const float value :
       {std::numeric_limits<float>::quiet_NaN(), -5.0F, 1e30F, 100.0F}) {
    auto request = DenseF32(session_.frames() + 1, {Touch(0.5)});
    std::memcpy(request.mutable_frames()->mutable_taxels()->data() + 12, &value,
                4);
    Send(request);
    const auto answers = Answers();
    EXPECT_FLOAT_EQ(answers[0].contacts(0).patch().max_force(), 0.5);
    EXPECT_EQ(answers[0].region_count(), 1u);
  }
}

TEST_F(StreamSessionTest, DrainingSendsANoticeThenTheFinal) {
  Start();
  Send(DenseU16(1, {Touch(1)}));
  Answers();
  session_.OnDraining(5000);
  const v1::ClassifyContactResponse notice = Next();
  EXPECT_EQ(notice.notice().kind(), v1::StreamNotice::KIND_DRAINING);
  EXPECT_EQ(notice.notice().grace_ms(), 5000u);
  // Within the grace, the trial that was begun continues.
  Send(DenseU16(2, {Touch(1)}));
  Answers();
  session_.Finish(Draining());
  const auto answers = Answers();
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_TRUE(answers[0].is_final());
  EXPECT_EQ(session_.state(), State::kDone);
  EXPECT_EQ(ReasonOf(session_.final_status()), "DRAINING");
}

TEST_F(StreamSessionTest, DrainingBeforeConfigEndsAtOnce) {
  session_.OnDraining(5000);
  EXPECT_EQ(session_.state(), State::kDone);
  EXPECT_EQ(session_.final_status().code(), absl::StatusCode::kUnavailable);
}

TEST_F(StreamSessionTest, FirstEndWins) {
  Start();
  session_.Finish(StreamIdle(10));
  session_.OnHalfClose();
  session_.OnDraining(5);
  session_.Finish(Draining());
  EXPECT_EQ(ReasonOf(session_.final_status()), "STREAM_IDLE");
  EXPECT_EQ(session_.state(), State::kDone);
}

TEST_F(StreamSessionTest, ErrorsWaitForFinalsAlreadyOwed) {
  Start();
  Send(DenseU16(1, {Touch(1)}));
  Send(EndOfTrialRequest());
  EXPECT_FALSE(session_.OnRequest(ConfigRequest()).ok());
  EXPECT_EQ(session_.state(), State::kFinishing);
  EXPECT_EQ(Answers().size(), 2u);
  EXPECT_EQ(session_.state(), State::kDone);
}

TEST_F(StreamSessionTest, ASlowReaderIsOwedBoundedMemoryAndNoFinalIsLost) {
  auto config = ConfigRequest();
  config.mutable_config()->set_decision_frames(limits::kMaxDecisionFrames);
  Start(config);
  uint64_t sequence = 1;
  int ends = 0;
  while (session_.wants_request()) {
    Send(DenseU16(sequence, std::vector(64, Touch(1))));
    Send(EndOfTrialRequest());
    sequence += 64;
    ++ends;
    ASSERT_LE(ends, 1000);
  }
  // The touch and the final of each.
  EXPECT_EQ(2 * ends, static_cast<int>(limits::kMaxQueuedKept));
  EXPECT_LE(session_.responses().size(),
            2 * limits::kMaxQueuedKept + limits::kMaxFramesPerMessage);
  int finals = 0;
  uint64_t superseded = 0;
  for (const v1::Answer& answer : Answers()) {
    finals += answer.is_final();
    superseded = answer.superseded();
  }
  EXPECT_EQ(finals, ends);
  EXPECT_GT(superseded, 0u);
  EXPECT_TRUE(session_.wants_request());
}

TEST_F(StreamSessionTest, AFrameInItsStrideAllocatesNothing) {
  auto config = ConfigRequest();
  config.mutable_config()->set_with_taxels(true);
  config.mutable_config()->set_with_diagnostics(true);
  Start(config);
  std::vector<v1::ClassifyContactRequest> requests;
  for (int t = 1; t <= 400; ++t) {
    requests.push_back(t % 2 == 0
                           ? DenseU16(2 * t, {Touch(1.0 + 0.001 * t), Touch(1)})
                           : testing::SparseU16(2 * t, {Touch(2), Touch(1)}));
  }
  const auto run = [&](int begin, int end) {
    for (int t = begin; t < end; ++t) {
      ASSERT_TRUE(session_.OnRequest(requests[t]).ok());
      session_.EndRequest(0, 1000);
      while (session_.responses().StartWrite(0) != nullptr) {
        session_.responses().FinishWrite();
      }
    }
  };
  run(0, 200);
  const testing::AllocationCounter counter;
  run(200, 400);
  EXPECT_EQ(counter.count(), 0);
}

// Sessions share nothing but the model; a race would show under TSan.
TEST_F(StreamSessionTest, SessionsRunSideBySide) {
  std::vector<std::thread> threads;
  std::vector<double> scores(4);
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&score = scores[i]] {
      StreamSession session(&models(), {});
      auto config = ConfigRequest();
      config.mutable_config()->set_with_diagnostics(true);
      ASSERT_TRUE(session.OnRequest(config).ok());
      const auto frames = testing::Contact(60, 3);
      for (size_t t = 0; t < frames.size(); ++t) {
        ASSERT_TRUE(session.OnRequest(DenseU16(1 + t, {frames[t]})).ok());
        while (const auto* response = session.responses().StartWrite(0)) {
          if (response->answer().contacts_size() > 0) {
            score = Score(response->answer());
          }
          session.responses().FinishWrite();
        }
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_NE(scores[0], 0);
  for (double score : scores) EXPECT_EQ(score, scores[0]);
}

}  // namespace
}  // namespace tactus::internal::server
