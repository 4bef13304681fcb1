// The packing of frames into messages does not change the answers: they are
// those of the pipeline, bit for bit.
#include <cstring>

#include "core/base/random.h"
#include "gtest/gtest.h"
#include "server/session/stream_session.h"
#include "tests/server/support/requests.h"
#include "tests/server/support/test_models.h"

namespace tactus::internal::server {
namespace {

using testing::Counts;

// The fields that must agree, as text of exact numbers.
std::string Fingerprint(double unknown, std::span<const double> likelihood,
                        std::span<const double> probability) {
  std::string bytes(reinterpret_cast<const char*>(&unknown), sizeof(unknown));
  for (const auto values : {likelihood, probability}) {
    bytes.append(reinterpret_cast<const char*>(values.data()),
                 values.size_bytes());
  }
  return bytes;
}

// Empty without a contact.
std::string Fingerprint(const v1::Answer& answer) {
  if (answer.contacts().empty()) return "";
  const v1::Contact& contact = answer.contacts(0);
  const auto span = [](const google::protobuf::RepeatedField<double>& field) {
    return std::span<const double>(field.data(), field.size());
  };
  return Fingerprint(contact.unknown(),
                     span(answer.diagnostics().contacts(0).log_likelihood()),
                     span(contact.probability()));
}

struct Recording {
  std::vector<Counts> frames;
  // One per frame, empty or equal in number.
  std::vector<Pose> poses;
};

Recording MakeRecording(uint64_t seed, bool with_poses) {
  Recording recording;
  Random random(seed);
  recording.frames = testing::Contact(30 + random.Index(90), seed);
  if (!with_poses) return recording;
  for (size_t t = 0; t < recording.frames.size(); ++t) {
    Pose pose;
    pose.position = {random.Gaussian(), random.Gaussian(), random.Gaussian()};
    pose.orientation = Eigen::Quaterniond(random.Gaussian(), random.Gaussian(),
                                          random.Gaussian(), random.Gaussian())
                           .normalized();
    recording.poses.push_back(pose);
  }
  return recording;
}

std::vector<std::string> Offline(const testing::TestModels& models,
                                 const Recording& recording) {
  ContactPipeline::Options options;
  options.release_after_s = -1;
  auto pipeline = *ContactPipeline::Create(*LayoutPreset("cody-forearm"),
                                           models.model(), options);
  std::vector<std::string> prints;
  for (size_t t = 0; t < recording.frames.size(); ++t) {
    const std::vector<float> taxels = testing::Newtons(recording.frames[t]);
    FrameView frame{.taxels = taxels};
    if (!recording.poses.empty()) frame.pose = &recording.poses[t];
    pipeline->Step(frame);
    const ContactReport* contact = pipeline->main_contact();
    if (contact == nullptr) {
      prints.emplace_back();
      continue;
    }
    const ContactClassifier& c = *contact->classifier;
    prints.push_back(
        Fingerprint(c.unknown(), c.log_likelihood(), c.probability()));
  }
  return prints;
}

enum class Packing { kDenseU16, kDenseF32, kSparseU16, kSparseF32 };

v1::ClassifyContactRequest Pack(Packing packing, uint64_t sequence,
                                const std::vector<Counts>& frames) {
  switch (packing) {
    case Packing::kDenseU16:
      return testing::DenseU16(sequence, frames);
    case Packing::kDenseF32:
      return testing::DenseF32(sequence, frames);
    case Packing::kSparseU16:
      return testing::SparseU16(sequence, frames);
    case Packing::kSparseF32:
      return testing::SparseF32(sequence, frames);
  }
  return {};
}

v1::ClassifyContactRequest Config(Packing packing, bool with_poses) {
  auto request = testing::ConfigRequest();
  v1::StreamConfig* config = request.mutable_config();
  config->set_with_poses(with_poses);
  config->set_with_diagnostics(true);
  if (packing == Packing::kDenseF32 || packing == Packing::kSparseF32) {
    config->set_taxel_type(v1::TAXEL_TYPE_FLOAT32);
    config->clear_scale();
  }
  return request;
}

// Takes the waiting answers; returns how many of them were finals.
int Collect(StreamSession& session, std::vector<std::string>& prints) {
  int finals = 0;
  while (const auto* response = session.responses().StartWrite(0)) {
    if (response->has_answer()) {
      prints.push_back(Fingerprint(response->answer()));
      finals += response->answer().is_final();
    }
    session.responses().FinishWrite();
  }
  return finals;
}

TEST(ChunkingTest, AnyPackingGivesThePipelinesBits) {
  const testing::TestModels models;
  Random random(17);
  // The trials of one packing follow one another on one stream.
  for (const Packing packing : {Packing::kDenseU16, Packing::kDenseF32,
                                Packing::kSparseU16, Packing::kSparseF32}) {
    for (const bool with_poses : {false, true}) {
      StreamSession session(&models, {});
      ASSERT_TRUE(session.OnRequest(Config(packing, with_poses)).ok());
      uint64_t sequence = 1;
      for (uint64_t seed = 1; seed <= 25; ++seed) {
        const Recording recording = MakeRecording(seed, with_poses);
        std::vector<std::string> want = Offline(models, recording);
        std::vector<std::string> got;
        const size_t frames = recording.frames.size();
        // 40 dense frames of four bytes a taxel just fit into 64 KiB.
        for (size_t t = 0; t < frames;) {
          const size_t n = std::min(frames - t, 1 + random.Index(40));
          auto request =
              Pack(packing, sequence,
                   {recording.frames.begin() + static_cast<ptrdiff_t>(t),
                    recording.frames.begin() + static_cast<ptrdiff_t>(t + n)});
          for (size_t i = 0; with_poses && i < n; ++i) {
            testing::AddPose(recording.poses[t + i], request.mutable_frames());
          }
          ASSERT_TRUE(session.OnRequest(request).ok());
          EXPECT_EQ(Collect(session, got), 0);
          t += n;
          sequence += n;
        }
        ASSERT_TRUE(session.OnRequest(testing::EndOfTrialRequest()).ok());
        EXPECT_EQ(Collect(session, got), 1);
        want.push_back(want.back());
        ASSERT_EQ(got.size(), want.size());
        EXPECT_TRUE(got == want) << "seed " << seed;
      }
    }
  }
}

}  // namespace
}  // namespace tactus::internal::server
