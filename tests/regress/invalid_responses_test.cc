// A server that decided for value 200,000 crashed tactus-stream, because the
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

namespace tactus::internal::client {
namespace {

using testing::GoodAnswer;
using testing::GoodStarted;
using ::testing::HasSubstr;
using testing::ScriptedServer;
using Stream = ScriptedServer::Stream;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

struct Change {
  // Part of the error's text.
  std::string field;
  std::function<void(v1::Answer*)> apply;
};

void AddContactChanges(std::vector<Change>& changes) {
  const auto add = [&](std::string field, auto change) {
    changes.push_back({std::move(field), [change](v1::Answer* answer) {
                         change(answer->mutable_contacts(0));
                       }});
  };
  add("size of contact.probability", [](auto* c) { c->clear_probability(); });
  add("size of contact.probability",
      [](auto* c) { c->mutable_probability()->Resize(10'000, 0); });
  add("contact.probability", [](auto* c) { c->set_probability(1, kNan); });
  add("contact.probability", [](auto* c) { c->set_probability(1, 1.5); });
  add("contact.probability", [](auto* c) { c->set_probability(1, -0.25); });
  add("sum of contact.probability",
      [](auto* c) { c->set_probability(1, 0.5); });
  add("contact.unknown", [](auto* c) { c->set_unknown(kNan); });
  add("contact.id", [](auto* c) { c->set_id(0); });
  add("contact.state",
      [](auto* c) { c->set_state(v1::Contact::STATE_UNSPECIFIED); });
  add("contact.state",
      [](auto* c) { c->set_state(static_cast<v1::Contact::State>(77)); });
  add("onset_sequence", [](auto* c) { c->set_onset_sequence(4); });
  add("time_since_onset_ns", [](auto* c) { c->set_time_since_onset_ns(-1); });
  add("contact.motion_m", [](auto* c) { c->set_motion_m(kInf); });
  add("contact.patch",
      [](auto* c) { c->mutable_patch()->set_max_force(kNan); });
  add("area_taxels", [](auto* c) { c->mutable_patch()->set_area_taxels(385); });
  add("patch.taxels", [](auto* c) { c->mutable_patch()->add_taxels(384); });
  add("size of contact.patch.taxels",
      [](auto* c) { c->mutable_patch()->mutable_taxels()->Resize(385, 0); });
  add("patch's link", [](auto* c) {
    c->mutable_patch()->mutable_centroid()->mutable_link()->set_y(kNan);
  });
  add("patch's world_normal", [](auto* c) {
    c->mutable_patch()
        ->mutable_centre_of_pressure()
        ->mutable_world_normal()
        ->set_z(kInf);
  });
  add("contact.object",
      [](auto* c) { c->mutable_object()->set_moved_m(kInf); });
  add("deviations",
      [](auto* c) { c->mutable_object()->set_moved_deviation_m(-1); });
  add("size of contact.answers", [](auto* c) { c->clear_answers(); });
  add("size of contact.answers", [](auto* c) { c->add_answers(); });
  add("contact.answers.probability",
      [](auto* c) { c->mutable_answers(1)->set_probability(0, 2); });
}

void AddDecisionChanges(std::vector<Change>& changes) {
  const auto add = [&](std::string field, auto change) {
    changes.push_back({std::move(field), [change](v1::Answer* answer) {
                         change(answer->mutable_contacts(0)
                                    ->mutable_answers(1)
                                    ->mutable_decision());
                       }});
  };
  add("decision.value", [](auto* d) { d->set_value(200'000); });
  add("decision.value", [](auto* d) { d->set_value(2); });
  add("sequence of a decision", [](auto* d) { d->set_sequence(4); });
  add("sequence of a decision", [](auto* d) { d->set_changed_sequence(4); });
  add("time_since_onset_ns of a decision",
      [](auto* d) { d->set_time_since_onset_ns(-1); });
  add("time_since_onset_ns of a decision",
      [](auto* d) { d->set_changed_time_since_onset_ns(-1); });
}

void AddScoreChanges(std::vector<Change>& changes) {
  const auto add = [&](std::string field, auto change) {
    changes.push_back(
        {std::move(field), [change](v1::Answer* answer) {
           change(answer->mutable_diagnostics()->mutable_contacts(0));
         }});
  };
  add("size of diagnostics.hmm_probability",
      [](auto* s) { s->add_hmm_probability(0); });
  add("size of diagnostics.lstm_probability",
      [](auto* s) { s->add_lstm_probability(1); });
  add("size of diagnostics.log_likelihood",
      [](auto* s) { s->clear_log_likelihood(); });
  add("log_likelihood", [](auto* s) { s->set_log_likelihood(0, kNan); });
  add("log_likelihood", [](auto* s) { s->set_log_likelihood(0, kInf); });
  add("diagnostics.stability", [](auto* s) { s->set_stability(2); });
}

// Each makes an answer to frame 3 invalid.
std::vector<Change> Changes() {
  std::vector<Change> changes = {
      {"answer.sequence", [](auto* p) { p->set_sequence(4); }},
      {"answer.sequence", [](auto* p) { p->set_sequence(1); }},
      {"answer.sequence",
       [](auto* p) { p->set_sequence(std::numeric_limits<uint64_t>::max()); }},
      {"number of answer.contacts",
       [](auto* p) {
         const v1::Contact contact = p->contacts(0);
         for (int i = 0; i < 8; ++i) *p->add_contacts() = contact;
       }},
      {"size of diagnostics.contacts",
       [](auto* p) { p->mutable_diagnostics()->clear_contacts(); }},
      {"event.contact_id", [](auto* p) { p->add_events()->set_contact_id(2); }},
      {"event.question",
       [](auto* p) {
         p->add_events()->set_contact_id(1);
         p->mutable_events(0)->set_question(2);
       }},
      {"event.value",
       [](auto* p) {
         p->add_events()->set_contact_id(1);
         p->mutable_events(0)->set_value(2);
       }},
  };
  AddContactChanges(changes);
  AddDecisionChanges(changes);
  AddScoreChanges(changes);
  return changes;
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
    EXPECT_TRUE(Check(GoodAnswer(1)).ok());
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
  EXPECT_TRUE(StartedChecker().Check(GoodAnswer(3)).ok());
  for (const Change& change : Changes()) {
    v1::ClassifyContactResponse response = GoodAnswer(3);
    change.apply(response.mutable_answer());
    ExpectInvalid(StartedChecker(), response, change.field);
  }
}

TEST(InvalidResponsesTest, ImpossibleClassesAndUnknownKindsPass) {
  StartedChecker checker;
  v1::ClassifyContactResponse response = GoodAnswer(2);
  response.mutable_answer()
      ->mutable_diagnostics()
      ->mutable_contacts(0)
      ->set_log_likelihood(0, -kInf);
  EXPECT_TRUE(checker.Check(response).ok());
  EXPECT_TRUE(checker.Check({}).ok());
  response.mutable_notice()->set_kind(
      static_cast<v1::StreamNotice::Kind>(1000));
  EXPECT_TRUE(checker.Check(response).ok());
}

TEST(InvalidResponsesTest, StartedComesFirstAndOnce) {
  ExpectInvalid(Checker(), GoodAnswer(1), "first response");
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
          {"started.questions", [](auto* s) { s->clear_questions(); }},
          {"started.questions",
           [](auto* s) {
             for (int i = 0; i < 9; ++i) *s->add_questions() = s->questions(0);
           }},
          {"question's values",
           [](auto* s) { s->mutable_questions(0)->clear_values(); }},
          {"value_of_class",
           [](auto* s) { s->mutable_questions(0)->add_value_of_class(0); }},
          {"value_of_class",
           [](auto* s) { s->mutable_questions(1)->set_value_of_class(3, 2); }},
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
  v1::ClassifyContactResponse response = GoodAnswer(1);
  response.mutable_answer()->set_is_final(true);
  // The server may end the stream and with it the open trial.
  EXPECT_TRUE(checker.Check(response).ok());
  ExpectInvalid(std::move(checker), response, "number of final answers");
}

// Sends each change through the whole client, in a separate stream.
TEST(InvalidResponsesOnTheWireTest, EndTheStreamWithAClearError) {
  for (const Change& change : Changes()) {
    ScriptedServer server([&](grpc::ServerContext* context, Stream* stream) {
      v1::ClassifyContactRequest request;
      stream->Read(&request);
      stream->Write(GoodStarted());
      stream->Read(&request);
      stream->Write(GoodAnswer(1));
      v1::ClassifyContactResponse response = GoodAnswer(3);
      change.apply(response.mutable_answer());
      stream->Write(response);
      return ScriptedServer::SayNothing(context);
    });
    uint64_t last = 0;
    auto stream = ContactStream::Open(
        MakeChannel(server.address()), testing::ConfigRequest().config(),
        [&](const auto& r) { last = r.answer().sequence(); });
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
      if (!empty_end) stream->Write(GoodAnswer(1));
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
      v1::ClassifyContactResponse response = GoodAnswer(sequence);
      response.mutable_answer()
          ->mutable_contacts(0)
          ->mutable_answers(0)
          ->mutable_decision()
          ->set_value(200'000);
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
}  // namespace tactus::internal::client
