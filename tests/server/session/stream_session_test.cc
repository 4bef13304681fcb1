#include "server/session/stream_session.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <thread>

#include "core/base/errors.h"
#include "core/base/limits.h"
#include "gtest/gtest.h"
#include "tests/server/support/requests.h"
#include "tests/server/support/test_models.h"
#include "tests/support/allocation_counter.h"

namespace tactus::server {
namespace {

using State = StreamSession::State;
using testing::ConfigRequest;
using testing::DenseF32;
using testing::DenseU16;
using testing::EndOfTrialRequest;
using testing::Touch;
using testing::Untouched;

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
  std::vector<v1::Posterior> Posteriors() {
    std::vector<v1::Posterior> result;
    for (auto next = Next(); next.has_posterior(); next = Next()) {
      result.push_back(next.posterior());
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
  EXPECT_FALSE(started_.has_lstm());
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
  EXPECT_EQ(Posteriors().size(), 2u);
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
  const auto posteriors = Posteriors();
  ASSERT_EQ(posteriors.size(), 2u);
  EXPECT_FALSE(posteriors[0].is_final());
  EXPECT_TRUE(posteriors[1].is_final());
}

TEST_F(StreamSessionTest, EndOfAnEmptyTrialAnswersThePrior) {
  Start();
  Send(EndOfTrialRequest());
  const auto posteriors = Posteriors();
  ASSERT_EQ(posteriors.size(), 1u);
  EXPECT_TRUE(posteriors[0].is_final());
  EXPECT_EQ(posteriors[0].contact_state(), v1::CONTACT_STATE_NO_CONTACT);
  EXPECT_DOUBLE_EQ(posteriors[0].probability(0), 0.25);
}

TEST_F(StreamSessionTest, PosteriorFollowsTheContact) {
  auto config = ConfigRequest();
  config.mutable_config()->set_with_features(true);
  Start(config);
  Send(DenseU16(7, {Untouched(), Touch(1), Touch(2)}));
  const auto posteriors = Posteriors();
  ASSERT_EQ(posteriors.size(), 3u);
  EXPECT_EQ(posteriors[0].sequence(), 7u);
  EXPECT_EQ(posteriors[0].contact_state(), v1::CONTACT_STATE_NO_CONTACT);
  EXPECT_EQ(posteriors[0].contact_id(), 0u);
  const v1::Posterior& last = posteriors[2];
  EXPECT_EQ(last.sequence(), 9u);
  EXPECT_EQ(last.capture_time_ns(), 90'000'000);
  EXPECT_EQ(last.contact_state(), v1::CONTACT_STATE_IN_CONTACT);
  EXPECT_EQ(last.contact_id(), 1u);
  EXPECT_EQ(last.onset_sequence(), 8u);
  EXPECT_EQ(last.time_since_onset_ns(), 10'000'000);
  EXPECT_EQ(last.log_likelihood_size(), 4);
  double sum = 0;
  for (double p : last.probability()) sum += p;
  EXPECT_NEAR(sum, 1, 1e-12);
  EXPECT_EQ(last.lstm_probability_size(), 0);
  EXPECT_DOUBLE_EQ(last.features().max_force(), 2);
  EXPECT_EQ(last.features().area_taxels(), 4u);
  EXPECT_EQ(last.features().region_count(), 1u);
}

TEST_F(StreamSessionTest, DecisionStaysWithItsContactOnly) {
  auto config = ConfigRequest();
  config.mutable_config()->set_decision_threshold(0.51);
  config.mutable_config()->set_decision_frames(3);
  config.mutable_config()->set_cadence(v1::RESULT_CADENCE_ON_DECISION);
  Start(config);
  for (int t = 0; t < 120; ++t) Send(DenseU16(1 + t, {Touch(2.7)}));
  auto posteriors = Posteriors();
  ASSERT_EQ(posteriors.size(), 1u);
  const v1::Posterior decided = posteriors[0];
  ASSERT_TRUE(decided.has_decision());
  EXPECT_EQ(decided.decision().sequence(), decided.sequence());
  EXPECT_EQ(decided.decision().time_since_onset_ns(),
            static_cast<int64_t>(decided.sequence() - 1) * 10'000'000);
  Send(EndOfTrialRequest());
  posteriors = Posteriors();
  ASSERT_EQ(posteriors.size(), 1u);
  EXPECT_TRUE(posteriors[0].is_final());
  EXPECT_EQ(posteriors[0].decision().sequence(), decided.sequence());
  Send(EndOfTrialRequest());
  posteriors = Posteriors();
  EXPECT_FALSE(posteriors[0].has_decision());
}

TEST_F(StreamSessionTest, ContactEndIsReportedOnItsFrameAtAnyCadence) {
  auto config = ConfigRequest();
  config.mutable_config()->set_release_after_ms(30);
  config.mutable_config()->set_cadence(v1::RESULT_CADENCE_ON_DECISION);
  Start(config);
  Send(DenseU16(1, {Touch(1), Untouched(), Untouched(), Untouched(),
                    Untouched(), Untouched()}));
  const auto posteriors = Posteriors();
  ASSERT_EQ(posteriors.size(), 1u);
  EXPECT_TRUE(posteriors[0].is_contact_end());
  EXPECT_FALSE(posteriors[0].is_final());
  EXPECT_EQ(posteriors[0].contact_state(), v1::CONTACT_STATE_RELEASED);
  EXPECT_EQ(posteriors[0].sequence(), 4u);
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
    const auto posteriors = Posteriors();
    ASSERT_EQ(posteriors.size(), 3u);
    EXPECT_EQ(posteriors[0].sequence(), first + 2);
    EXPECT_EQ(posteriors[1].sequence(), first + 5);
    EXPECT_TRUE(posteriors[2].is_final());
  }
}

TEST_F(StreamSessionTest, CadenceOnChangeIsSilentWhileNothingChanges) {
  auto config = ConfigRequest();
  config.mutable_config()->set_cadence(v1::RESULT_CADENCE_ON_CHANGE);
  Start(config);
  Send(DenseU16(1, std::vector(20, Untouched())));
  EXPECT_TRUE(Posteriors().empty());
  Send(DenseU16(21, {Touch(1)}));
  const auto posteriors = Posteriors();
  ASSERT_EQ(posteriors.size(), 1u);
  EXPECT_EQ(posteriors[0].contact_state(), v1::CONTACT_STATE_IN_CONTACT);
}

TEST_F(StreamSessionTest, GapsAreCountedPerTrialAndChangeTheScores) {
  Start();
  Send(DenseU16(1, {Touch(1), Touch(1)}));
  auto posteriors = Posteriors();
  EXPECT_EQ(posteriors.back().frames_missing(), 0u);
  Send(DenseU16(6, {Touch(1)}));
  posteriors = Posteriors();
  ASSERT_EQ(posteriors.back().sequence(), 6u);
  EXPECT_EQ(posteriors.back().frames_missing(), 3u);
  const double with_gap = posteriors.back().log_likelihood(0);
  Send(EndOfTrialRequest());
  // Between trials, sequences may jump by any amount.
  Send(DenseU16(1000, {Touch(1), Touch(1), Touch(1)}));
  posteriors = Posteriors();
  EXPECT_EQ(posteriors.back().frames_missing(), 0u);
  EXPECT_NE(posteriors.back().log_likelihood(0), with_gap);
}

TEST_F(StreamSessionTest, AHugeGapIsBridgedAtOnce) {
  Start();
  Send(DenseU16(1, {Touch(1)}));
  auto far = DenseU16(2, {Touch(1)});
  far.mutable_frames()->set_first_sequence(1'000'000'000'000);
  Send(far);
  const auto posteriors = Posteriors();
  EXPECT_EQ(posteriors.back().frames_missing(), 1'000'000'000'000 - 2u);
  EXPECT_TRUE(std::isfinite(posteriors.back().log_likelihood(0)));
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
  config.mutable_config()->set_with_features(true);
  Start(config);
  for (const float value :
       {std::numeric_limits<float>::quiet_NaN(), -5.0F, 1e30F, 100.0F}) {
    auto request = DenseF32(session_.frames() + 1, {Touch(0.5)});
    std::memcpy(request.mutable_frames()->mutable_taxels()->data() + 12, &value,
                4);
    Send(request);
    const auto posteriors = Posteriors();
    EXPECT_FLOAT_EQ(posteriors[0].features().max_force(), 0.5);
    EXPECT_EQ(posteriors[0].features().region_count(), 1u);
  }
}

TEST_F(StreamSessionTest, DrainingSendsANoticeThenTheFinal) {
  Start();
  Send(DenseU16(1, {Touch(1)}));
  Posteriors();
  session_.OnDraining(5000);
  const v1::ClassifyContactResponse notice = Next();
  EXPECT_EQ(notice.notice().kind(), v1::StreamNotice::KIND_DRAINING);
  EXPECT_EQ(notice.notice().grace_ms(), 5000u);
  // Within the grace, the trial that was begun continues.
  Send(DenseU16(2, {Touch(1)}));
  Posteriors();
  session_.Finish(Draining());
  const auto posteriors = Posteriors();
  ASSERT_EQ(posteriors.size(), 1u);
  EXPECT_TRUE(posteriors[0].is_final());
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
  EXPECT_EQ(Posteriors().size(), 2u);
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
  EXPECT_EQ(ends, static_cast<int>(limits::kMaxQueuedFinals));
  EXPECT_LE(session_.responses().size(),
            2 * limits::kMaxQueuedFinals + limits::kMaxFramesPerMessage);
  int finals = 0;
  uint64_t superseded = 0;
  for (const v1::Posterior& posterior : Posteriors()) {
    finals += posterior.is_final();
    superseded = posterior.superseded();
  }
  EXPECT_EQ(finals, ends);
  EXPECT_GT(superseded, 0u);
  EXPECT_TRUE(session_.wants_request());
}

TEST_F(StreamSessionTest, AFrameInItsStrideAllocatesNothing) {
  auto config = ConfigRequest();
  config.mutable_config()->set_with_features(true);
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
      ASSERT_TRUE(session.OnRequest(ConfigRequest()).ok());
      const auto frames = testing::Contact(60, 3);
      for (size_t t = 0; t < frames.size(); ++t) {
        ASSERT_TRUE(session.OnRequest(DenseU16(1 + t, {frames[t]})).ok());
        while (const auto* response = session.responses().StartWrite(0)) {
          if (response->has_posterior()) {
            score = response->posterior().log_likelihood(2);
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
}  // namespace tactus::server
