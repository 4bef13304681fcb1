// A client sends faster than the server answers, so the server holds answers
// back and sends them together. The client gets all of them, in order.
#include <random>

#include "gtest/gtest.h"
#include "tests/server/support/test_server.h"

namespace tactus::internal {
namespace {

using testing::ConfigRequest;
using testing::DenseU16;
using testing::RawStream;
using testing::TestServer;
using testing::Touch;

class AheadTest : public ::testing::TestWithParam<bool> {
 protected:
  static TestServer MakeServer() {
    return GetParam() ? TestServer(TestServer::OnLoopback(50)) : TestServer();
  }
};

// Reads up to the answer of frame `last`; the server may skip some that the
// client left waiting, and reports how many.
void ReadUpTo(uint64_t last, RawStream& stream, uint64_t* answered,
              uint64_t* superseded) {
  uint64_t sequence = 0;
  while (sequence < last) {
    const v1::ClassifyContactResponse response = stream.Read();
    ASSERT_TRUE(response.has_answer()) << "after frame " << sequence;
    ASSERT_GT(response.answer().sequence(), sequence);
    sequence = response.answer().sequence();
    *superseded = response.answer().superseded();
    ++*answered;
  }
  EXPECT_EQ(sequence, last);
}

TEST_P(AheadTest, BurstsOfAnyLengthAreAnsweredToTheLast) {
  TestServer server = MakeServer();
  RawStream stream(server.channel());
  ASSERT_TRUE(stream.Write(ConfigRequest()));
  ASSERT_TRUE(stream.Read().has_started());
  std::mt19937 random(1);
  uint64_t sent = 0;
  uint64_t answered = 0;
  uint64_t superseded = 0;
  for (int burst = 0; burst < 200; ++burst) {
    const int length = 1 + static_cast<int>(random() % 40);
    for (int i = 0; i < length; ++i) {
      ASSERT_TRUE(stream.Write(DenseU16(++sent, {Touch(1)})));
    }
    ASSERT_NO_FATAL_FAILURE(ReadUpTo(sent, stream, &answered, &superseded));
  }
  EXPECT_EQ(answered + superseded, sent);
}

// No answer follows the last messages of a burst, so none would flush a held
// one.
TEST_P(AheadTest, AnAnswerThatNoneFollowsIsNotHeld) {
  TestServer server = MakeServer();
  RawStream stream(server.channel());
  v1::ClassifyContactRequest config = ConfigRequest();
  config.mutable_config()->set_cadence(v1::RESULT_CADENCE_EVERY_N_FRAMES);
  config.mutable_config()->set_result_interval_frames(5);
  ASSERT_TRUE(stream.Write(config));
  ASSERT_TRUE(stream.Read().has_started());
  uint64_t sent = 0;
  uint64_t answered = 0;
  uint64_t superseded = 0;
  for (int burst = 0; burst < 100; ++burst) {
    const uint64_t end = sent + 35 + burst % 5;
    while (sent < end) {
      ASSERT_TRUE(stream.Write(DenseU16(++sent, {Touch(1)})));
    }
    ASSERT_NO_FATAL_FAILURE(
        ReadUpTo(sent - sent % 5, stream, &answered, &superseded));
  }
}

INSTANTIATE_TEST_SUITE_P(Transports, AheadTest, ::testing::Bool(),
                         [](const auto& info) {
                           return info.param ? "Socket" : "InProcess";
                         });

}  // namespace
}  // namespace tactus::internal
