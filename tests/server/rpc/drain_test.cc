// A server that stops reports NOT_SERVING, then sends notices and finals, and
// then ends the streams.
#include <thread>

#include "core/base/errors.h"
#include "gtest/gtest.h"
#include "server/ops/health_probe.h"
#include "tests/server/support/test_server.h"

namespace tactus::internal {
namespace {

using testing::ConfigRequest;
using testing::DenseU16;
using testing::RawStream;
using testing::TestServer;
using testing::Touch;

constexpr char kService[] = "tactus.v1.ContactService";

bool Serves(const TestServer& server, const std::string& service) {
  const auto serving =
      server::ProbeHealth(server.channel(), service, std::chrono::seconds(10));
  EXPECT_TRUE(serving.ok()) << serving.status();
  return serving.value_or(false);
}

TEST(DrainTest, AStreamThatFinishesInTimeEndsWell) {
  TestServer server(TestServer::OnLoopback(60'000));
  RawStream stream(server.channel());
  ASSERT_TRUE(stream.Write(ConfigRequest()));
  ASSERT_TRUE(stream.Read().has_started());
  EXPECT_TRUE(Serves(server, ""));
  EXPECT_TRUE(Serves(server, kService));

  std::thread stop([&] { server.server().Stop(); });
  const v1::ClassifyContactResponse notice = stream.Read();
  EXPECT_EQ(notice.notice().kind(), v1::StreamNotice::KIND_DRAINING);
  EXPECT_EQ(notice.notice().grace_ms(), 60'000u);
  EXPECT_FALSE(Serves(server, ""));
  EXPECT_FALSE(Serves(server, kService));
  // No new streams, but this one may complete its contact.
  RawStream late(server.channel());
  const absl::Status refused = late.Finish();
  EXPECT_EQ(refused.code(), absl::StatusCode::kUnavailable);
  EXPECT_EQ(ReasonOf(refused), "DRAINING");
  ASSERT_TRUE(stream.Write(DenseU16(1, {Touch(1)})));
  EXPECT_EQ(stream.Read().answer().sequence(), 1u);
  stream.HalfClose();
  EXPECT_TRUE(stream.Finish().ok());
  ASSERT_EQ(stream.rest().size(), 1u);
  EXPECT_TRUE(stream.rest()[0].answer().is_final());
  stop.join();
  EXPECT_EQ(server.server().gate().live(), 0);
}

TEST(DrainTest, StreamsThatStayGetTheirFinalAndTheReason) {
  TestServer server(TestServer::OnLoopback(50));
  std::vector<std::unique_ptr<RawStream>> streams;
  for (int i = 0; i < 20; ++i) {
    streams.push_back(std::make_unique<RawStream>(server.channel()));
    ASSERT_TRUE(streams.back()->Write(ConfigRequest()));
    ASSERT_TRUE(streams.back()->Read().has_started());
    ASSERT_TRUE(streams.back()->Write(DenseU16(1, {Touch(1)})));
    ASSERT_TRUE(streams.back()->Read().has_answer());
  }
  std::thread stop([&] { server.server().Stop(); });
  for (auto& stream : streams) {
    const absl::Status status = stream->Finish();
    EXPECT_EQ(status.code(), absl::StatusCode::kUnavailable);
    EXPECT_EQ(ReasonOf(status), "DRAINING");
    ASSERT_EQ(stream->rest().size(), 2u);
    EXPECT_TRUE(stream->rest()[0].has_notice());
    EXPECT_TRUE(stream->rest()[1].answer().is_final());
  }
  stop.join();
}

TEST(DrainTest, AStreamWithoutConfigEndsAtOnce) {
  TestServer server(TestServer::OnLoopback(60'000));
  RawStream stream(server.channel());
  ASSERT_TRUE(
      testing::Eventually([&] { return server.server().gate().live() == 1; }));
  std::thread stop([&] { server.server().Stop(); });
  EXPECT_EQ(ReasonOf(stream.Finish()), "DRAINING");
  stop.join();
}

TEST(DrainTest, AReaderThatNeverReadsCannotHoldTheServer) {
  TestServer server(TestServer::OnLoopback(50));
  RawStream stream(server.channel());
  ASSERT_TRUE(stream.Write(ConfigRequest()));
  // Send frames until the server has more answers than it can deliver.
  std::thread writer([&] {
    for (uint64_t sequence = 1; sequence < 40'000; sequence += 40) {
      if (!stream.Write(DenseU16(sequence, std::vector(40, Touch(1)))) ||
          !stream.Write(testing::EndOfTrialRequest())) {
        return;
      }
    }
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  server.server().Stop();
  EXPECT_FALSE(stream.Finish().ok());
  writer.join();
}

}  // namespace
}  // namespace tactus::internal
