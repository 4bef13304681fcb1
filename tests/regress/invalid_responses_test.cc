// A server that decided for class 200,000 crashed tactus-stream, because the
// client used responses without a check.
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "client/drivers/sim_driver.h"
#include "client/stream/contact_stream.h"
#include "client/stream/response_checker.h"
#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/server/support/requests.h"
#include "tests/support/scripted_server.h"
#include "tools/stream/trial_player.h"

namespace tactus::client {
namespace {

using testing::GoodPosterior;
using testing::GoodStarted;
using ::testing::HasSubstr;
using testing::ScriptedServer;
using Stream = ScriptedServer::Stream;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

struct Change {
  // Part of the error's text.
  std::string field;
  std::function<void(v1::Posterior*)> apply;
};

// Each makes a posterior for frame 3 invalid.
std::vector<Change> Changes() {
  return {
      {"decision.class_index",
       [](auto* p) { p->mutable_decision()->set_class_index(200'000); }},
      {"decision.class_index",
       [](auto* p) { p->mutable_decision()->set_class_index(4); }},
      {"decision.sequence",
       [](auto* p) { p->mutable_decision()->set_sequence(4); }},
      {"decision.time_since_onset_ns",
       [](auto* p) { p->mutable_decision()->set_time_since_onset_ns(-1); }},
      {"size of posterior.probability",
       [](auto* p) { p->clear_probability(); }},
      {"size of posterior.probability",
       [](auto* p) { p->mutable_probability()->Resize(10'000, 0); }},
      {"posterior.probability", [](auto* p) { p->set_probability(1, kNan); }},
      {"posterior.probability", [](auto* p) { p->set_probability(1, 1.5); }},
      {"posterior.probability", [](auto* p) { p->set_probability(1, -0.25); }},
      {"sum of posterior.probability",
       [](auto* p) { p->set_probability(1, 0.5); }},
      {"size of posterior.hmm_probability",
       [](auto* p) { p->add_hmm_probability(0); }},
      {"size of posterior.lstm_probability",
       [](auto* p) { p->add_lstm_probability(1); }},
      {"size of posterior.log_likelihood",
       [](auto* p) { p->clear_log_likelihood(); }},
      {"log_likelihood", [](auto* p) { p->set_log_likelihood(0, kNan); }},
      {"log_likelihood", [](auto* p) { p->set_log_likelihood(0, kInf); }},
      {"posterior.unknown", [](auto* p) { p->set_unknown(kNan); }},
      {"posterior.stability", [](auto* p) { p->set_stability(2); }},
      {"contact_state",
       [](auto* p) { p->set_contact_state(v1::CONTACT_STATE_UNSPECIFIED); }},
      {"contact_state",
       [](auto* p) {
         p->set_contact_state(static_cast<v1::ContactState>(77));
       }},
      {"posterior.sequence", [](auto* p) { p->set_sequence(4); }},
      {"posterior.sequence", [](auto* p) { p->set_sequence(1); }},
      {"posterior.sequence",
       [](auto* p) { p->set_sequence(std::numeric_limits<uint64_t>::max()); }},
      {"onset_sequence", [](auto* p) { p->set_onset_sequence(4); }},
      {"time_since_onset_ns", [](auto* p) { p->set_time_since_onset_ns(-1); }},
      {"posterior.features",
       [](auto* p) { p->mutable_features()->set_max_force(kNan); }},
      {"area_taxels",
       [](auto* p) { p->mutable_features()->set_area_taxels(385); }},
      {"posterior.object",
       [](auto* p) { p->mutable_object()->set_moved_m(kInf); }},
      {"deviations",
       [](auto* p) { p->mutable_object()->set_moved_deviation_m(-1); }},
  };
}

// A checker for a stream with frames 1 to 3.
struct Checker : ResponseChecker {
  Checker() {
    OnSent(testing::ConfigRequest());
    OnSent(testing::DenseU16(
        1, {testing::Touch(1), testing::Touch(1), testing::Touch(1)}));
  }
};

// The same after `started` and an answer to frame 1.
struct StartedChecker : Checker {
  StartedChecker() {
    EXPECT_TRUE(Check(GoodStarted()).ok());
    EXPECT_TRUE(Check(GoodPosterior(1)).ok());
  }
};

void ExpectInvalid(ResponseChecker&& checker,
                   const v1::ClassifyContactResponse& response,
                   const std::string& field) {
  const absl::Status status = checker.Check(response);
  EXPECT_EQ(status.code(), absl::StatusCode::kInternal);
  EXPECT_EQ(ReasonOf(status), "INVALID_RESPONSE") << field;
  EXPECT_THAT(std::string(status.message()), HasSubstr(field));
}

TEST(InvalidResponsesTest, EachFieldIsChecked) {
  EXPECT_TRUE(StartedChecker().Check(GoodPosterior(3)).ok());
  for (const Change& change : Changes()) {
    v1::ClassifyContactResponse response = GoodPosterior(3);
    change.apply(response.mutable_posterior());
    ExpectInvalid(StartedChecker(), response, change.field);
  }
}

TEST(InvalidResponsesTest, ImpossibleClassesAndUnknownKindsPass) {
  StartedChecker checker;
  v1::ClassifyContactResponse response = GoodPosterior(2);
  response.mutable_posterior()->set_log_likelihood(0, -kInf);
  EXPECT_TRUE(checker.Check(response).ok());
  EXPECT_TRUE(checker.Check({}).ok());
  response.mutable_notice()->set_kind(
      static_cast<v1::StreamNotice::Kind>(1000));
  EXPECT_TRUE(checker.Check(response).ok());
}

TEST(InvalidResponsesTest, StartedComesFirstAndOnce) {
  ExpectInvalid(Checker(), GoodPosterior(1), "first response");
  ExpectInvalid(Checker(), {}, "first response");
  ExpectInvalid(StartedChecker(), GoodStarted(), "number of `started`");
}

TEST(InvalidResponsesTest, StartedIsChecked) {
  const std::pair<const char*, std::function<void(v1::StreamStarted*)>>
      changes[] = {
          {"class_names", [](auto* s) { s->clear_class_names(); }},
          {"class_names",
           [](auto* s) {
             for (int i = 0; i < 200'000; ++i) s->add_class_names("x");
           }},
          {"class_names", [](auto* s) { s->set_class_names(1, ""); }},
          {"class_names",
           [](auto* s) { s->set_class_names(1, std::string(129, 'x')); }},
          {"geometry.rows",
           [](auto* s) { s->mutable_geometry()->set_rows(0); }},
          {"geometry.columns",
           [](auto* s) { s->mutable_geometry()->set_columns(1u << 31); }},
      };
  for (const auto& [field, apply] : changes) {
    v1::ClassifyContactResponse response = GoodStarted();
    apply(response.mutable_started());
    ExpectInvalid(Checker(), response, field);
  }
}

TEST(InvalidResponsesTest, MoreFinalsThanTrialsAreRefused) {
  StartedChecker checker;
  v1::ClassifyContactResponse response = GoodPosterior(1);
  response.mutable_posterior()->set_is_final(true);
  // The server may end the stream and with it the open trial.
  EXPECT_TRUE(checker.Check(response).ok());
  ExpectInvalid(std::move(checker), response, "number of final posteriors");
}

// Sends each change through the whole client, in a separate stream.
TEST(InvalidResponsesOnTheWireTest, EndTheStreamWithAClearError) {
  for (const Change& change : Changes()) {
    ScriptedServer server([&](grpc::ServerContext* context, Stream* stream) {
      v1::ClassifyContactRequest request;
      stream->Read(&request);
      stream->Write(GoodStarted());
      stream->Read(&request);
      stream->Write(GoodPosterior(1));
      v1::ClassifyContactResponse response = GoodPosterior(3);
      change.apply(response.mutable_posterior());
      stream->Write(response);
      return ScriptedServer::SayNothing(context);
    });
    uint64_t last = 0;
    auto stream = ContactStream::Open(
        MakeChannel(server.address()), testing::ConfigRequest().config(),
        [&](const auto& r) { last = r.posterior().sequence(); });
    ASSERT_TRUE(stream.ok()) << stream.status();
    ASSERT_TRUE(
        (*stream)
            ->Send(testing::DenseU16(
                1, {testing::Touch(1), testing::Touch(1), testing::Touch(1)}))
            .ok());
    const absl::Status status = (*stream)->Close();
    EXPECT_EQ(ReasonOf(status), "INVALID_RESPONSE") << status;
    EXPECT_THAT(std::string(status.message()), HasSubstr(change.field));
    EXPECT_EQ((*stream)->Close(), status);
    // The callback did not get it.
    EXPECT_EQ(last, 1u);
  }
}

TEST(InvalidResponsesOnTheWireTest, OpenReportsThem) {
  for (const bool empty_end : {false, true}) {
    ScriptedServer server([=](grpc::ServerContext*, Stream* stream) {
      if (!empty_end) stream->Write(GoodPosterior(1));
      return grpc::Status::OK;
    });
    const auto stream = ContactStream::Open(MakeChannel(server.address()),
                                            testing::ConfigRequest().config(),
                                            [](const auto&) { FAIL(); });
    EXPECT_EQ(ReasonOf(stream.status()), "INVALID_RESPONSE") << stream.status();
  }
}

TEST(InvalidResponsesOnTheWireTest, LargeResponsesAreRefused) {
  ScriptedServer server([](grpc::ServerContext*, Stream* stream) {
    v1::ClassifyContactResponse response = GoodStarted();
    response.mutable_started()->set_stream_id(std::string(1'000'000, 'x'));
    stream->Write(response);
    return grpc::Status::OK;
  });
  const auto stream = ContactStream::Open(MakeChannel(server.address()),
                                          testing::ConfigRequest().config(),
                                          [](const auto&) { FAIL(); });
  EXPECT_EQ(stream.status().code(), absl::StatusCode::kResourceExhausted)
      << stream.status();
}

// 10 kB of gzip would inflate to 10 MB.
TEST(InvalidResponsesOnTheWireTest, CompressedResponsesAreRefused) {
  ScriptedServer server([](grpc::ServerContext* context, Stream* stream) {
    context->set_compression_algorithm(GRPC_COMPRESS_GZIP);
    v1::ClassifyContactResponse response = GoodStarted();
    response.mutable_started()->set_stream_id(std::string(10'000'000, 'x'));
    stream->Write(response);
    return grpc::Status::OK;
  });
  const auto stream = ContactStream::Open(MakeChannel(server.address()),
                                          testing::ConfigRequest().config(),
                                          [](const auto&) { FAIL(); });
  EXPECT_FALSE(stream.ok());
  EXPECT_NE(ReasonOf(stream.status()), "NO_RESPONSE");
}

TEST(InvalidResponsesOnTheWireTest, TheTrialPlayerReportsThem) {
  ScriptedServer server([](grpc::ServerContext*, Stream* stream) {
    v1::ClassifyContactRequest request;
    stream->Read(&request);
    stream->Write(GoodStarted());
    while (stream->Read(&request)) {
      const uint64_t sequence = request.frames().first_sequence();
      v1::ClassifyContactResponse response = GoodPosterior(sequence);
      response.mutable_posterior()->mutable_decision()->set_class_index(
          200'000);
      stream->Write(response);
    }
    return grpc::Status::OK;
  });
  SimDriver driver({.seed = 1}, 1, {});
  TrialPlayer player(MakeChannel(server.address()), &driver, {},
                     [](const TrialResult&) {});
  const absl::Status status = player.Run();
  EXPECT_EQ(ReasonOf(status), "INVALID_RESPONSE") << status;
}

}  // namespace
}  // namespace tactus::client
