// A trial in one call gets the bits that a stream gives, and the stream's
// errors.
#include "server/session/trial_session.h"

#include <algorithm>

#include "core/base/errors.h"
#include "core/base/limits.h"
#include "gtest/gtest.h"
#include "tests/server/support/requests.h"
#include "tests/server/support/test_models.h"

namespace tactus::internal::server {
namespace {

using testing::ConfigRequest;
using testing::Contact;
using testing::Counts;

class TrialSessionTest : public ::testing::Test {
 protected:
  // The trial of `frames` with `per_batch` frames in each batch.
  static v1::ClassifyTrialRequest Trial(const v1::StreamConfig& config,
                                        const std::vector<Counts>& frames,
                                        size_t per_batch) {
    v1::ClassifyTrialRequest request;
    *request.mutable_config() = config;
    for (size_t t = 0; t < frames.size(); t += per_batch) {
      const auto first = frames.begin() + static_cast<ptrdiff_t>(t);
      const auto last = frames.begin() + static_cast<ptrdiff_t>(std::min(
                                             t + per_batch, frames.size()));
      *request.add_frames() = testing::SparseU16(1 + t, {first, last}).frames();
    }
    return request;
  }

  absl::Status Run(const std::string& bytes) {
    TrialSession trial(&models_, {.stream_id = "t-1", .server_version = "9.9"},
                       bytes);
    v1::ClassifyContactRequest parsed;
    steps_ = 0;
    while (!trial.done()) {
      trial.Step(&parsed);
      ++steps_;
    }
    response_ = trial.response();
    frames_ = trial.session().frames();
    return trial.status();
  }

  // What a stream answers to the same trial.
  v1::ClassifyTrialResponse Stream(const v1::ClassifyTrialRequest& trial) {
    StreamSession session(&models_,
                          {.stream_id = "t-1", .server_version = "9.9"});
    v1::ClassifyContactRequest request;
    *request.mutable_config() = trial.config();
    EXPECT_TRUE(session.OnRequest(request).ok());
    for (const v1::FrameBatch& batch : trial.frames()) {
      *request.mutable_frames() = batch;
      EXPECT_TRUE(session.OnRequest(request).ok());
    }
    EXPECT_TRUE(session.OnRequest(testing::EndOfTrialRequest()).ok());
    v1::ClassifyTrialResponse response;
    while (const auto* answer = session.responses().StartWrite(0)) {
      if (answer->has_started()) {
        *response.mutable_started() = answer->started();
      } else if (answer->answer().is_final()) {
        *response.mutable_answer() = answer->answer();
      } else {
        for (const v1::Contact& contact : answer->answer().contacts()) {
          if (contact.state() != v1::Contact::STATE_RELEASED) continue;
          *response.add_ended_contacts() = contact;
        }
      }
      session.responses().FinishWrite();
    }
    response.mutable_answer()->clear_superseded();
    return response;
  }

  testing::TestModels models_;
  v1::ClassifyTrialResponse response_;
  uint64_t frames_ = 0;
  int steps_ = 0;
};

TEST_F(TrialSessionTest, AnswersTheBitsOfAStream) {
  v1::StreamConfig config = ConfigRequest().config();
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    config.set_with_diagnostics(seed % 2 == 0);
    config.set_never_release(seed % 3 != 0);
    config.clear_release_after_ms();
    if (seed % 3 == 0) config.set_release_after_ms(30);
    config.set_cadence(seed % 5 == 0 ? v1::RESULT_CADENCE_EVENTS
                                     : v1::RESULT_CADENCE_UNSPECIFIED);
    const auto trial = Trial(config, Contact(100, seed), 1 + seed * 3);
    const absl::Status status = Run(trial.SerializeAsString());
    ASSERT_TRUE(status.ok()) << status;
    EXPECT_TRUE(response_.answer().is_final());
    EXPECT_EQ(response_.SerializeAsString(), Stream(trial).SerializeAsString());
    EXPECT_EQ(frames_, 100u);
    // One step for each part, and one for the end.
    EXPECT_EQ(steps_, trial.frames_size() + 2);
  }
}

// The contact of this id among those that ended; null if there is none.
const v1::Contact* Ended(const v1::ClassifyTrialResponse& response,
                         uint64_t id) {
  const auto& ended = response.ended_contacts();
  const auto found = std::ranges::find(ended, id, &v1::Contact::id);
  return found == ended.end() ? nullptr : &*found;
}

// Contacts end in another order than they begin, and two in one frame.
TEST_F(TrialSessionTest, ContactsThatEndedAreFoundByTheirIds) {
  struct Press {
    int column, from, until;
  };
  const Press presses[] = {{2, 0, 60}, {8, 10, 30}, {14, 20, 60}, {20, 70, 75}};
  std::vector<Counts> frames;
  for (int t = 0; t < 100; ++t) {
    frames.push_back(testing::Untouched());
    for (const Press& press : presses) {
      if (t < press.from || t >= press.until) continue;
      for (int row = 4; row < 7; ++row) {
        frames.back()[row * 24 + press.column] = 1024;
      }
    }
  }
  v1::StreamConfig config = ConfigRequest().config();
  config.clear_never_release();
  config.set_release_after_ms(30);
  for (const bool whole : {false, true}) {
    ASSERT_TRUE(
        Run(Trial(config, frames, whole ? 20 : 1).SerializeAsString()).ok());
    ASSERT_EQ(response_.ended_contacts_size(), 4);
    for (uint64_t id = 1; id <= 4; ++id) {
      SCOPED_TRACE(id);
      const v1::Contact* const contact = Ended(response_, id);
      ASSERT_NE(contact, nullptr);
      EXPECT_EQ(contact->state(), v1::Contact::STATE_RELEASED);
      const Press& press = presses[id - 1];
      // One that touches beside others is a contact in its second frame.
      EXPECT_NEAR(contact->onset_sequence(), 1 + press.from, 1);
      EXPECT_NEAR(contact->time_since_onset_ns() / 1e6,
                  10 * (press.until - press.from) + 20, 10);
    }
  }
}

TEST_F(TrialSessionTest, ATrialWithoutFramesHasNoContact) {
  ASSERT_TRUE(
      Run(Trial(ConfigRequest().config(), {}, 1).SerializeAsString()).ok());
  EXPECT_TRUE(response_.answer().is_final());
  EXPECT_EQ(response_.answer().contacts_size(), 0);
}

TEST_F(TrialSessionTest, ErrorsAreThoseOfTheStream) {
  const v1::StreamConfig config = ConfigRequest().config();
  const auto good = Trial(config, Contact(20, 1), 5);

  auto bad = good;
  bad.mutable_config()->set_model("no-such-model");
  EXPECT_EQ(ReasonOf(Run(bad.SerializeAsString())), "MODEL_NOT_FOUND");
  bad = good;
  bad.mutable_frames(2)->set_first_sequence(1);
  EXPECT_EQ(ReasonOf(Run(bad.SerializeAsString())), "SEQUENCE_REGRESSION");
  bad = good;
  bad.mutable_frames(1)->set_frame_count(0);
  EXPECT_EQ(ReasonOf(Run(bad.SerializeAsString())), "FRAME_COUNT_OUT_OF_RANGE");
  bad = good;
  bad.clear_config();
  EXPECT_EQ(ReasonOf(Run(bad.SerializeAsString())), "CONFIG_REQUIRED");
  EXPECT_EQ(ReasonOf(Run("")), "CONFIG_REQUIRED");
  EXPECT_EQ(ReasonOf(Run(good.SerializeAsString() + good.SerializeAsString())),
            "CONFIG_REPEATED");
  // A batch may not be larger than a message of a stream.
  bad = good;
  bad.mutable_frames(0)->set_taxels(std::string(limits::kMaxMessageBytes, 'x'));
  EXPECT_EQ(ReasonOf(Run(bad.SerializeAsString())), "MESSAGE_TOO_LARGE");
}

TEST_F(TrialSessionTest, BytesThatAreNoTrial) {
  const std::string good =
      Trial(ConfigRequest().config(), Contact(20, 1), 5).SerializeAsString();
  for (const std::string& bytes :
       {std::string("\xff\xff\xff\xff"), std::string("\x0a\x7f"),
        std::string(100, '\x07'), std::string(1, '\0'),
        good.substr(0, good.size() - 1)}) {
    EXPECT_EQ(ReasonOf(Run(bytes)), "MALFORMED_REQUEST");
  }
  EXPECT_EQ(ReasonOf(Run(std::string(limits::kMaxTrialBytes + 1, '\xff'))),
            "MESSAGE_TOO_LARGE");
}

// Field 3 of a stream's request is end_of_trial; here it has no meaning.
TEST_F(TrialSessionTest, UnknownFieldsAreIgnored) {
  const std::string good =
      Trial(ConfigRequest().config(), Contact(20, 1), 5).SerializeAsString();
  ASSERT_TRUE(Run(good).ok());
  const std::string answer = response_.SerializeAsString();
  ASSERT_TRUE(Run(std::string("\x1a\x00", 2) + good +
                  std::string("\x1a\x00\x08\x01", 4))
                  .ok());
  EXPECT_EQ(response_.SerializeAsString(), answer);
}

// Many small batches: the request is never parsed as a whole.
TEST_F(TrialSessionTest, ARequestOfEmptyBatchesEndsAtTheFirst) {
  std::string bytes =
      Trial(ConfigRequest().config(), {}, 1).SerializeAsString();
  while (bytes.size() + 2 <= limits::kMaxTrialBytes) {
    bytes += std::string("\x12\x00", 2);
  }
  EXPECT_EQ(ReasonOf(Run(bytes)), "FRAME_COUNT_OUT_OF_RANGE");
  EXPECT_EQ(steps_, 2);
}

}  // namespace
}  // namespace tactus::internal::server
