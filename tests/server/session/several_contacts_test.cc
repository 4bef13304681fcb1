// With several contacts at once, the packing and encoding of frames and the
// number of threads that serve streams change no bit of the answers.
#include <algorithm>
#include <string>
#include <thread>
#include <vector>

#include "core/base/random.h"
#include "core/skin/layout_proto.h"
#include "gtest/gtest.h"
#include "server/session/stream_session.h"
#include "tests/server/support/requests.h"
#include "tests/server/support/test_models.h"

namespace tactus::internal::server {
namespace {

using testing::Counts;

constexpr int kColumns = 24;

// Objects that press the skin at once: they come and go, wander, join their
// neighbours and part again.
std::vector<Counts> Presses(uint64_t seed) {
  constexpr int kObjects = 8;
  Random random(seed);
  struct Object {
    double row = 0;
    double column = 0;
    double speed = 0;
    double newton = 0;
    int from = 0;
    int until = 0;
  };
  std::vector<Object> objects;
  for (int i = 0; i < kObjects; ++i) {
    const int from = static_cast<int>(random.Index(60));
    objects.push_back(
        {.row = i % 2 == 0 ? 3.0 : 11.0,
         .column = 6.0 * (i / 2),
         .speed = i % 3 == 0 ? random.Uniform(0, 0.2) : 0,
         .newton = random.Uniform(0.1, 2),
         .from = from,
         .until = from + 20 + static_cast<int>(random.Index(90))});
  }
  std::vector<Counts> frames;
  for (int t = 0; t < 160; ++t) {
    frames.push_back(testing::Untouched());
    for (const Object& object : objects) {
      if (t < object.from || t >= object.until) continue;
      for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 2; ++c) {
          const int row = static_cast<int>(object.row) + r;
          const int column =
              static_cast<int>(object.column +
                               object.speed * (t - object.from)) +
              c;
          const double newton = object.newton * random.Uniform(0.5, 1.5);
          frames.back()[row * kColumns + column % kColumns] =
              static_cast<uint16_t>(newton / testing::kStep);
        }
      }
    }
  }
  return frames;
}

enum class Encoding {
  kDenseU16,
  kSparseU16,
  kDenseF32,
  kSparseF32,
  kDenseI16,
  kSparseI16
};

constexpr Encoding kEncodings[] = {Encoding::kDenseU16, Encoding::kSparseU16,
                                   Encoding::kDenseF32, Encoding::kSparseF32,
                                   Encoding::kDenseI16, Encoding::kSparseI16};

v1::ClassifyContactRequest PressConfig(Encoding encoding) {
  v1::ClassifyContactRequest request = testing::ConfigRequest();
  v1::StreamConfig* config = request.mutable_config();
  config->clear_never_release();
  config->set_release_after_ms(60);
  config->set_with_taxels(true);
  config->set_with_diagnostics(true);
  if (encoding == Encoding::kDenseF32 || encoding == Encoding::kSparseF32) {
    config->set_taxel_type(v1::TAXEL_TYPE_FLOAT32);
    config->clear_scale();
  }
  if (encoding == Encoding::kDenseI16 || encoding == Encoding::kSparseI16) {
    SkinLayout layout = *LayoutPreset("cody-forearm");
    layout.normal_axis = 0;
    layout.signed_values = true;
    *config->mutable_geometry() = LayoutToProto(layout);
    config->set_taxel_type(v1::TAXEL_TYPE_INT16);
  }
  return request;
}

v1::ClassifyContactRequest Encode(Encoding encoding, uint64_t sequence,
                                  const std::vector<Counts>& frames) {
  switch (encoding) {
    case Encoding::kDenseU16:
    case Encoding::kDenseI16:
      return testing::DenseU16(sequence, frames);
    case Encoding::kSparseU16:
    case Encoding::kSparseI16:
      return testing::SparseU16(sequence, frames);
    case Encoding::kDenseF32:
      return testing::DenseF32(sequence, frames);
    case Encoding::kSparseF32:
      return testing::SparseF32(sequence, frames);
  }
  return {};
}

// What a stream answers, without the times of the server.
class Listener {
 public:
  void Read(StreamSession& session) {
    while (const auto* response = session.responses().StartWrite(0)) {
      if (response->has_answer()) Keep(response->answer());
      session.responses().FinishWrite();
    }
  }

  const std::vector<std::string>& answers() const { return answers_; }
  // The most contacts that an answer had, and contacts that joined another.
  int most() const { return most_; }
  int merged() const { return merged_; }

 private:
  void Keep(v1::Answer answer) {
    answer.mutable_diagnostics()->clear_server_compute_ns();
    answer.mutable_diagnostics()->clear_queue_ns();
    most_ = std::max(most_, answer.contacts_size());
    for (const v1::ContactEvent& event : answer.events()) {
      merged_ += event.kind() == v1::ContactEvent::KIND_MERGED;
    }
    answers_.push_back(answer.SerializeAsString());
  }

  std::vector<std::string> answers_;
  int most_ = 0;
  int merged_ = 0;
};

// The answers to a trial in messages of 1 to `batch` frames.
Listener PlayPresses(const ModelSource& models, Encoding encoding, size_t batch,
                     uint64_t seed) {
  const std::vector<Counts> frames = Presses(seed);
  StreamSession session(&models, {});
  Listener listener;
  EXPECT_TRUE(session.OnRequest(PressConfig(encoding)).ok())
      << session.final_status();
  Random random(seed);
  for (size_t t = 0; t < frames.size();) {
    const size_t n = std::min(frames.size() - t, 1 + random.Index(batch));
    const auto first = frames.begin() + static_cast<ptrdiff_t>(t);
    const absl::Status status = session.OnRequest(
        Encode(encoding, 1 + t, {first, first + static_cast<ptrdiff_t>(n)}));
    EXPECT_TRUE(status.ok()) << status;
    listener.Read(session);
    t += n;
  }
  EXPECT_TRUE(session.OnRequest(testing::EndOfTrialRequest()).ok());
  listener.Read(session);
  return listener;
}

TEST(SeveralContactsTest, BatchesAndEncodingsChangeNoBit) {
  const testing::TestModels models;
  int merged = 0;
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    const Listener want = PlayPresses(models, Encoding::kDenseU16, 1, seed);
    ASSERT_EQ(want.answers().size(), 161u);
    EXPECT_GE(want.most(), 5);
    merged += want.merged();
    for (const Encoding encoding : kEncodings) {
      for (const size_t batch : {size_t{1}, size_t{3}, size_t{20}}) {
        EXPECT_TRUE(PlayPresses(models, encoding, batch, seed).answers() ==
                    want.answers())
            << "encoding " << static_cast<int>(encoding) << " batch " << batch
            << " seed " << seed;
      }
    }
  }
  EXPECT_GT(merged, 0);
}

TEST(SeveralContactsTest, ThreadsChangeNoBit) {
  constexpr int kStreams = 8;
  const testing::TestModels models;
  std::vector<std::vector<std::string>> want(kStreams);
  std::vector<std::vector<std::string>> got(kStreams);
  const auto play = [&](int stream) {
    return PlayPresses(models, kEncodings[stream % 6], 5, stream).answers();
  };
  for (int stream = 0; stream < kStreams; ++stream) want[stream] = play(stream);
  for (const int threads : {2, 4, 8}) {
    std::vector<std::thread> running;
    for (int first = 0; first < threads; ++first) {
      running.emplace_back([&, first] {
        for (int i = first; i < kStreams; i += threads) got[i] = play(i);
      });
    }
    for (std::thread& thread : running) thread.join();
    EXPECT_TRUE(got == want) << threads << " threads";
  }
}

}  // namespace
}  // namespace tactus::internal::server
