#include "client/stream/contact_stream.h"

#include <atomic>
#include <mutex>

#include "client/stream/frame_encoder.h"
#include "client/stream/robot_id.h"
#include "core/base/errors.h"
#include "gtest/gtest.h"
#include "tests/server/support/test_server.h"
#include "tests/support/scripted_server.h"

namespace tactus::internal::client {
namespace {

using testing::DenseU16;
using testing::TestServer;
using testing::Touch;

v1::StreamConfig GoodConfig() { return testing::ConfigRequest().config(); }
void Ignore(const v1::ClassifyContactResponse&) {}

TEST(ContactStreamTest, CarriesAContactFromStartToClose) {
  TestServer server;
  std::vector<v1::Answer> posteriors;
  auto stream = ContactStream::Open(
      server.channel(), GoodConfig(),
      [&](const auto& r) { posteriors.push_back(r.answer()); });
  ASSERT_TRUE(stream.ok()) << stream.status();
  EXPECT_EQ((*stream)->started().class_names_size(), 4);
  ASSERT_TRUE((*stream)->Send(DenseU16(1, {Touch(1), Touch(2)})).ok());
  ASSERT_TRUE((*stream)->EndTrial().ok());
  ASSERT_TRUE((*stream)->Close().ok());
  EXPECT_TRUE((*stream)->ended());
  ASSERT_GE(posteriors.size(), 1u);
  EXPECT_TRUE(posteriors.back().is_final());
  EXPECT_EQ(posteriors.back().sequence(), 2u);
  EXPECT_TRUE((*stream)->Close().ok());
  EXPECT_EQ(ReasonOf((*stream)->EndTrial().status()), "STREAM_FINISHED");
  EXPECT_TRUE((*stream)->Close().ok());
}

TEST(ContactStreamTest, OpenGivesTheServersReason) {
  TestServer server;
  v1::StreamConfig config = GoodConfig();
  config.set_model("models/none");
  const auto stream = ContactStream::Open(server.channel(), config, Ignore);
  EXPECT_EQ(stream.status().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(ReasonOf(stream.status()), "MODEL_NOT_FOUND");
}

TEST(ContactStreamTest, SendGivesTheReasonTheStreamEndedWith) {
  TestServer server;
  auto stream = *ContactStream::Open(server.channel(), GoodConfig(), Ignore);
  ASSERT_TRUE(stream->Send(DenseU16(5, {Touch(1)})).ok());
  absl::Status status;
  ASSERT_TRUE(testing::Eventually([&] {
    status = stream->Send(DenseU16(5, {Touch(1)}));
    return !status.ok();
  }));
  EXPECT_EQ(ReasonOf(status), "SEQUENCE_REGRESSION") << status;
  // The status stays.
  EXPECT_EQ(stream->Send(DenseU16(6, {Touch(1)})), status);
  EXPECT_EQ(stream->EndTrial().status(), status);
  EXPECT_EQ(stream->Close(), status);
  EXPECT_EQ(stream->Close(), status);
}

TEST(ContactStreamTest, EndTrialReturnsTheFinalPosteriorOfEachTrial) {
  TestServer server;
  int finals = 0;
  auto stream = *ContactStream::Open(
      server.channel(), GoodConfig(),
      [&](const auto& r) { finals += r.answer().is_final(); });
  ASSERT_TRUE(stream->Send(DenseU16(1, {Touch(1), Touch(2)})).ok());
  const auto first = stream->EndTrial();
  ASSERT_TRUE(first.ok()) << first.status();
  EXPECT_TRUE(first->is_final());
  EXPECT_EQ(first->sequence(), 2u);
  ASSERT_EQ(first->contacts_size(), 1);
  EXPECT_EQ(first->contacts(0).state(), v1::Contact::STATE_TOUCHING);
  ASSERT_TRUE(stream->Send(DenseU16(3, {testing::Untouched()})).ok());
  const auto second = stream->EndTrial();
  ASSERT_TRUE(second.ok()) << second.status();
  EXPECT_EQ(second->sequence(), 3u);
  EXPECT_EQ(second->contacts_size(), 0);
  EXPECT_EQ(finals, 2);
  EXPECT_TRUE(stream->Close().ok());
}

TEST(ContactStreamTest, ARobotGivesItsOwnGeometry) {
  TestServer server;
  SkinInfo info;
  info.layout = *LayoutPreset("cody-forearm");
  info.layout.contact_threshold = 0.5;
  info.layout.onset_threshold = 1.5;
  info.layout.mask.assign(info.layout.taxels(), 1);
  info.layout.mask[7] = 0;
  info.scale = testing::kStep;
  auto stream =
      *ContactStream::Open(server.channel(), MakeConfig(info), Ignore);
  const v1::SensorGeometry& geometry = stream->started().geometry();
  EXPECT_EQ(geometry.onset_threshold(), 1.5);
  ASSERT_EQ(geometry.masked_taxels_size(), 1);
  EXPECT_EQ(geometry.masked_taxels(0), 7u);
  FrameEncoder encoder(info, {});
  SkinFrame frame;
  for (const double newton : {1.0, 1.4}) {
    frame.u16 = Touch(newton);
    frame.capture_time_ns += 10'000'000;
    encoder.Add(frame);
  }
  ASSERT_TRUE(stream->Send(encoder.request()).ok());
  // Below the onset's threshold.
  EXPECT_EQ(stream->EndTrial()->contacts_size(), 0);

  // No preset at all.
  info.layout.name = "my-palm";
  info.layout.rows = 8;
  info.layout.mask.clear();
  stream = *ContactStream::Open(server.channel(), MakeConfig(info), Ignore);
  EXPECT_EQ(stream->started().geometry().layout(), "my-palm");
  EXPECT_EQ(stream->started().geometry().rows(), 8u);
}

// The values of x-robot-id that a server sees from a robot with this client_id.
std::vector<std::string> RobotIds(const std::string& client_id) {
  std::vector<std::string> ids;
  testing::ScriptedServer server([&](grpc::ServerContext* context,
                                     testing::ScriptedServer::Stream* stream) {
    const auto [begin, end] =
        context->client_metadata().equal_range(kRobotIdKey);
    for (auto id = begin; id != end; ++id) {
      ids.emplace_back(id->second.data(), id->second.size());
    }
    stream->Write(testing::GoodStarted());
    return grpc::Status::OK;
  });
  v1::StreamConfig config = GoodConfig();
  config.set_client_id(client_id);
  const auto stream =
      ContactStream::Open(MakeChannel(server.address()), config, Ignore);
  EXPECT_TRUE(stream.ok()) << stream.status();
  return ids;
}

TEST(ContactStreamTest, AProxySeesWhichRobotItIs) {
  EXPECT_EQ(RobotIds("left arm 7"), std::vector<std::string>{"left arm 7"});
  // gRPC ends the process if a value has other bytes.
  for (const char* id : {"", " arm", "arm ", "Ärm", "a\nb", "a\tb", "\x7f"}) {
    EXPECT_EQ(RobotIds(id), std::vector<std::string>{}) << id;
  }
}

TEST(ContactStreamTest, ReportsItsEndOnce) {
  TestServer server;
  std::atomic<int> ends = 0;
  auto stream = *ContactStream::Open(server.channel(), GoodConfig(), Ignore, {},
                                     "", [&] { ++ends; });
  EXPECT_EQ(ends, 0);
  EXPECT_TRUE(stream->Close().ok());
  stream.reset();
  EXPECT_EQ(ends, 1);
}

TEST(ContactStreamTest, NobodyListens) {
  const auto stream = ContactStream::Open(MakeChannel("unix:/no/such/socket"),
                                          GoodConfig(), Ignore);
  EXPECT_EQ(stream.status().code(), absl::StatusCode::kUnavailable);
}

TEST(ContactStreamTest, DestructionAndCancelEndAnOpenStream) {
  TestServer server;
  {
    auto stream = *ContactStream::Open(server.channel(), GoodConfig(), Ignore);
  }
  auto stream = *ContactStream::Open(server.channel(), GoodConfig(), Ignore);
  stream->Cancel();
  EXPECT_EQ(stream->Close().code(), absl::StatusCode::kCancelled);
  EXPECT_TRUE(
      testing::Eventually([&] { return server.server().gate().live() == 0; }));
}

TEST(ContactStreamTest, OverTcpAndUnixSocket) {
  const std::string socket = ::testing::TempDir() + "tactus-test.sock";
  TestServer server({.listen = {"127.0.0.1:0", "unix:" + socket}});
  const int port = server.server().ports()[0];
  ASSERT_GT(port, 0);
  for (const std::string& address :
       {"127.0.0.1:" + std::to_string(port), "unix:" + socket}) {
    testing::ExpectGoodStream(MakeChannel(address));
  }
}

TEST(ContactStreamTest, ASecondServerOnThePortIsRefused) {
  TestServer server({.listen = {"127.0.0.1:0"}});
  const std::string address =
      "127.0.0.1:" + std::to_string(server.server().ports()[0]);
  const auto second =
      server::TactusServer::Start(&server.models(), {.listen = {address}});
  EXPECT_EQ(ReasonOf(second.status()), "IO") << second.status();
}

TEST(FrameEncoderTest, PacksWhatTheServerExpects) {
  SkinInfo info;
  info.layout = *LayoutPreset("cody-forearm");
  info.scale = testing::kStep;
  info.with_poses = true;
  const auto contact = testing::Contact(6, 5);
  Pose pose;
  pose.position = {1, 2, 3};
  for (const bool sparse : {false, true}) {
    FrameEncoder encoder(info, {.sparse = sparse});
    SkinFrame frame;
    frame.pose = pose;
    for (int message = 0; message < 2; ++message) {
      encoder.Clear();
      for (int i = 0; i < 3; ++i) {
        const int t = 3 * message + i;
        frame.u16 = contact[t];
        frame.capture_time_ns = (t + 1) * 10'000'000;
        encoder.Add(frame);
      }
      const std::vector<testing::Counts> part(
          contact.begin() + 3 * message, contact.begin() + 3 * message + 3);
      auto want = sparse ? testing::SparseU16(1 + 3 * message, part)
                         : DenseU16(1 + 3 * message, part);
      for (int i = 0; i < 3; ++i) {
        testing::AddPose(pose, want.mutable_frames());
      }
      EXPECT_EQ(encoder.request().SerializeAsString(),
                want.SerializeAsString());
      EXPECT_EQ(encoder.frames(), 3u);
      EXPECT_EQ(encoder.last_sequence(), 3u * message + 3);
    }
  }
}

TEST(FrameEncoderTest, FloatsTravelAsTheyAre) {
  SkinInfo info;
  info.taxel_type = v1::TAXEL_TYPE_FLOAT32;
  FrameEncoder encoder(info, {});
  SkinFrame frame;
  frame.f32 = testing::Newtons(Touch(1.25));
  frame.capture_time_ns = 10'000'000;
  encoder.Add(frame);
  EXPECT_EQ(encoder.request().SerializeAsString(),
            testing::DenseF32(1, {Touch(1.25)}).SerializeAsString());
}

}  // namespace
}  // namespace tactus::internal::client
