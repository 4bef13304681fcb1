// A stream counts what it skips, and its frames allocate nothing in any
// encoding. tests/core/classify/skipping_test.cc checks that the rules change
// no bit of the answers.
#include "core/base/random.h"
#include "google/protobuf/io/zero_copy_stream_impl_lite.h"
#include "gtest/gtest.h"
#include "server/session/stream_session.h"
#include "tests/server/support/requests.h"
#include "tests/server/support/test_models.h"
#include "tests/support/allocation_counter.h"

namespace tactus::internal::server {
namespace {

using testing::Counts;
using testing::Touch;
using testing::Untouched;

using EncodeFrames = v1::ClassifyContactRequest (*)(uint64_t,
                                                    const std::vector<Counts>&);

v1::ClassifyContactRequest Config(bool f32) {
  auto request = testing::ConfigRequest();
  request.mutable_config()->clear_never_release();
  request.mutable_config()->set_release_after_ms(30);
  if (f32) {
    request.mutable_config()->set_taxel_type(v1::TAXEL_TYPE_FLOAT32);
    request.mutable_config()->set_scale(1);
  }
  return request;
}

// Untouched frames, a touch whose force and size change in steps, and its end.
std::vector<Counts> Scene() {
  std::vector<Counts> frames(10, Untouched());
  for (int t = 0; t < 60; ++t) {
    frames.push_back(Touch(1 + t / 10, 2 + t / 20));
  }
  frames.resize(frames.size() + 10, Untouched());
  return frames;
}

class SessionSkippingTest : public ::testing::Test {
 protected:
  testing::TestModels models_;
};

TEST_F(SessionSkippingTest, AStreamCountsWhatItSkips) {
  StreamSession session(&models_, {});
  EXPECT_EQ(session.skipped()[SkipRule::kUntouchedFrames], 0u);
  ASSERT_TRUE(session.OnRequest(Config(false)).ok());
  const std::vector<Counts> frames = Scene();
  for (size_t t = 0; t < frames.size(); ++t) {
    ASSERT_TRUE(session.OnRequest(testing::SparseU16(1 + t, {frames[t]})).ok());
  }
  const SkipCounters skipped = session.skipped();
  // Ten before the touch; of those after it the third ends the contact.
  EXPECT_EQ(skipped[SkipRule::kUntouchedFrames], 18u);
  EXPECT_EQ(skipped[SkipRule::kUnchangedFrames], 54u);
  EXPECT_EQ(skipped[SkipRule::kUnusedCues], CueCount() - kFeatureCount);
  EXPECT_EQ(skipped[SkipRule::kUnusedLstms], 0u);
  EXPECT_EQ(skipped[SkipRule::kUnlistedTaxels], 80u);
}

// Many frames per message, dense and sparse in turn, with masked taxels.
TEST_F(SessionSkippingTest, SparseFramesLeaveNothingBehind) {
  for (const bool skip : {true, false}) {
    auto config = Config(false);
    config.mutable_config()->mutable_geometry()->add_masked_taxels(5 * 24 + 8);
    StreamSettings settings = *ParseStreamConfig(config.config());
    settings.pipeline.skip[SkipRule::kUnlistedTaxels] = skip;
    FrameDecoder decoder(settings);
    Random random(4);
    uint64_t sequence = 1;
    uint64_t sparse_frames = 0;
    for (int message = 0; message < 300; ++message) {
      std::vector<Counts> frames(1 + random.Index(5), Untouched());
      for (Counts& frame : frames) {
        for (size_t i = random.Index(20); i > 0; --i) {
          frame[random.Index(frame.size())] =
              static_cast<uint16_t>(random.Index(5000));
        }
        frame[5 * 24 + 8] = 9;
      }
      const bool sparse = random.Index(2) == 0;
      const auto request = sparse ? testing::SparseU16(sequence, frames)
                                  : testing::DenseU16(sequence, frames);
      ASSERT_TRUE(decoder.Check(request.frames()).ok());
      for (size_t i = 0; i < frames.size(); ++i) {
        const FrameView got = decoder.Frame(request.frames(), i);
        frames[i][5 * 24 + 8] = 0;
        ASSERT_TRUE(
            std::ranges::equal(got.taxels, testing::Newtons(frames[i])));
      }
      decoder.Accept(request.frames());
      sequence += frames.size();
      if (sparse) sparse_frames += frames.size();
    }
    EXPECT_EQ(decoder.sparse_frames(), skip ? sparse_frames : 0);
  }
}

TEST_F(SessionSkippingTest, LowEffortLeavesOutTheLstms) {
  auto config = Config(false);
  config.mutable_config()->set_with_diagnostics(true);
  config.mutable_config()->set_effort(v1::EFFORT_LOW);
  Model model = testing::SmallModel();
  testing::AddLstms(2, model);
  class LstmModels : public ModelSource {
   public:
    explicit LstmModels(Model model)
        : model_(*CompiledModel::Create(std::move(model))) {}
    absl::StatusOr<PinnedModel> Find(absl::string_view,
                                     absl::string_view) const override {
      return PinnedModel{model_, "models/default/versions/1",
                         std::string(64, 'a')};
    }

   private:
    std::shared_ptr<const CompiledModel> model_;
  };
  const LstmModels models(std::move(model));
  StreamSession session(&models, {});
  ASSERT_TRUE(session.OnRequest(config).ok());
  ASSERT_TRUE(
      session.OnRequest(testing::DenseU16(1, std::vector(9, Touch(2)))).ok());
  session.OnHalfClose();
  EXPECT_EQ(session.skipped()[SkipRule::kUnusedLstms], 9u);
  int answers = 0;
  while (const auto* response = session.responses().StartWrite(0)) {
    if (response->has_answer()) {
      const v1::Answer& answer = response->answer();
      const v1::ContactScores& scores = answer.diagnostics().contacts(0);
      EXPECT_EQ(scores.lstm_probability_size(), 0);
      EXPECT_EQ(answer.contacts(0).probability(1), scores.hmm_probability(1));
      ++answers;
    }
    session.responses().FinishWrite();
  }
  EXPECT_EQ(answers, 10);
}

// From the bytes of the message to the answer, one and several frames each.
TEST_F(SessionSkippingTest, NoEncodingAllocates) {
  struct Case {
    EncodeFrames encode;
    bool f32;
  };
  for (const Case& c :
       {Case{testing::DenseU16, false}, Case{testing::DenseF32, true},
        Case{testing::SparseU16, false}, Case{testing::SparseF32, true}}) {
    for (const bool poses : {false, true}) {
      StreamSession session(&models_, {});
      auto config = Config(c.f32);
      config.mutable_config()->set_with_poses(poses);
      config.mutable_config()->set_with_taxels(true);
      config.mutable_config()->set_with_diagnostics(true);
      ASSERT_TRUE(session.OnRequest(config).ok());
      std::vector<std::string> messages;
      for (int t = 0; t < 200; ++t) {
        const bool touched = t % 60 < 59;
        const std::vector<Counts> frames(
            1 + t % 3, touched ? Touch(1 + 0.01 * (t % 7)) : Untouched());
        auto request = c.encode(1 + 3 * t, frames);
        for (size_t i = 0; poses && i < frames.size(); ++i) {
          testing::AddPose({}, request.mutable_frames());
        }
        messages.push_back(request.SerializeAsString());
      }
      int64_t allocations = 0;
      v1::ClassifyContactRequest parsed;
      for (size_t t = 0; t < messages.size(); ++t) {
        const testing::AllocationCounter counter;
        google::protobuf::io::ArrayInputStream bytes(
            messages[t].data(), static_cast<int>(messages[t].size()));
        ASSERT_TRUE(
            session.OnMessage(&bytes, messages[t].size(), &parsed).ok());
        session.EndRequest(0, 1000);
        while (session.responses().StartWrite(0) != nullptr) {
          session.responses().FinishWrite();
        }
        if (t >= 100) allocations += counter.count();
      }
      EXPECT_EQ(allocations, 0);
    }
  }
}

}  // namespace
}  // namespace tactus::internal::server
