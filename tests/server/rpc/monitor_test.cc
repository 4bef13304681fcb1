// Watching streams, over gRPC.
#include <chrono>
#include <list>
#include <map>

#include "core/base/errors.h"
#include "core/base/limits_monitor.h"
#include "tactus/v1/monitor.grpc.pb.h"
#include "tests/server/support/test_server.h"

namespace tactus::internal {
namespace {

using testing::ConfigRequest;
using testing::DenseU16;
using testing::Eventually;
using testing::RawStream;
using testing::TestServer;
using testing::Touch;
using testing::Untouched;

// A call that watches; cancelled when it is destroyed.
template <typename Response>
class Watch {
 public:
  using Reader = std::unique_ptr<grpc::ClientReader<Response>>;

  template <typename Request>
  Watch(const TestServer& server, const Request& request)
      : stub_(v1::MonitorService::NewStub(server.channel())) {
    context_.set_deadline(std::chrono::system_clock::now() +
                          std::chrono::seconds(60));
    reader_ = Call(request);
  }
  ~Watch() {
    context_.TryCancel();
    Response response;
    while (reader_->Read(&response)) {
    }
    if (!finished_) reader_->Finish();
  }

  bool Read(Response* response) { return reader_->Read(response); }
  absl::Status Finish() {
    finished_ = true;
    return client::FromGrpcStatus(reader_->Finish());
  }

 private:
  Reader Call(const v1::WatchStreamRequest& request) {
    return stub_->WatchStream(&context_, request);
  }
  Reader Call(const v1::WatchAllRequest& request) {
    return stub_->WatchAll(&context_, request);
  }

  std::unique_ptr<v1::MonitorService::Stub> stub_;
  grpc::ClientContext context_;
  Reader reader_;
  bool finished_ = false;
};

using WatchAll = Watch<v1::WatchAllResponse>;
using WatchOne = Watch<v1::WatchStreamResponse>;

std::vector<v1::OpenStream> List(const TestServer& server) {
  const auto stub = v1::MonitorService::NewStub(server.channel());
  std::vector<v1::OpenStream> streams;
  v1::ListStreamsRequest request;
  do {
    request.set_page_size(2);
    v1::ListStreamsResponse response;
    grpc::ClientContext context;
    const grpc::Status status = stub->ListStreams(&context, request, &response);
    EXPECT_TRUE(status.ok()) << status.error_message();
    streams.insert(streams.end(), response.streams().begin(),
                   response.streams().end());
    request.set_page_token(response.next_page_token());
  } while (!request.page_token().empty());
  return streams;
}

// Opens a stream and reads what it says at the start.
v1::StreamStarted Start(RawStream& stream) {
  EXPECT_TRUE(stream.Write(ConfigRequest()));
  return stream.Read().started();
}

TEST(MonitorTest, ListsOpenStreamsWithWhatTheyAre) {
  const TestServer server;
  EXPECT_TRUE(List(server).empty());
  std::vector<std::unique_ptr<RawStream>> streams;
  std::vector<std::string> ids;
  for (int i = 0; i < 5; ++i) {
    streams.push_back(std::make_unique<RawStream>(server.channel()));
    ids.push_back(Start(*streams.back()).stream_id());
  }
  ASSERT_TRUE(streams[0]->Write(DenseU16(3, {Touch(1), Touch(2)})));
  streams[0]->Read();
  streams[0]->Read();
  const auto open = List(server);
  ASSERT_EQ(open.size(), 5u);
  for (size_t i = 0; i < open.size(); ++i) {
    EXPECT_EQ(open[i].stream_id(), ids[i]);
    EXPECT_NE(open[i].started().model_version(), "");
    EXPECT_GT(open[i].started().geometry().rows(), 0u);
    EXPECT_GT(open[i].start_time_ms(), 0);
    EXPECT_NE(open[i].peer(), "");
    EXPECT_NE(open[i].caller(), "");
    EXPECT_EQ(open[i].sample_rate_hz(), 100);
  }
  EXPECT_EQ(open[0].counts().frames(), 2u);
  EXPECT_EQ(open[0].counts().contacts_now(), 1u);
  streams.clear();
  EXPECT_TRUE(Eventually([&] { return List(server).empty(); }));
}

TEST(MonitorTest, AWatcherSeesTheRobotsAnswers) {
  const TestServer server;
  WatchAll watch(server, v1::WatchAllRequest());
  v1::WatchAllResponse response;
  ASSERT_TRUE(watch.Read(&response));
  EXPECT_EQ(response.updates_size(), 0);

  RawStream stream(server.channel());
  const v1::StreamStarted started = Start(stream);
  ASSERT_TRUE(watch.Read(&response));
  ASSERT_EQ(response.updates_size(), 1);
  EXPECT_EQ(response.updates(0).opened().started().DebugString(),
            started.DebugString());
  std::map<uint64_t, v1::Answer> answers;
  int events = 0;
  int events_seen = 0;
  for (int frames = 0; frames < 5;) {
    const uint64_t sequence = answers.size() + 1;
    const double newton = 1 + static_cast<double>(sequence % 7);
    ASSERT_TRUE(stream.Write(DenseU16(sequence, {Touch(newton)})));
    answers[sequence] = stream.Read().answer();
    events += answers[sequence].events_size();
    // A frame that was asked for, or counts after a second.
    ASSERT_TRUE(watch.Read(&response));
    const v1::StreamUpdate& update = response.updates(0);
    EXPECT_EQ(update.stream_id(), started.stream_id());
    events_seen += update.events_size();
    if (!update.has_frame()) continue;
    ++frames;
    EXPECT_EQ(update.frame().taxels().size(),
              4u * started.geometry().rows() * started.geometry().columns());
    v1::Answer seen = update.frame().answer();
    ASSERT_EQ(seen.contacts_size(), 1);
    EXPECT_GT(seen.contacts(0).patch().taxels_size(), 0);
    seen.mutable_contacts(0)->mutable_patch()->clear_taxels();
    v1::Answer answer = answers[seen.sequence()];
    answer.clear_events();
    EXPECT_EQ(seen.SerializeAsString(), answer.SerializeAsString());
  }
  stream.HalfClose();
  EXPECT_TRUE(stream.Finish().ok());
  for (const auto& last : stream.rest()) events += last.answer().events_size();
  do {
    ASSERT_TRUE(watch.Read(&response));
    events_seen += response.updates(0).events_size();
  } while (!response.updates(0).ended());
  EXPECT_EQ(events_seen, events);
}

// All answers of a stream of some touches.
std::string Answers(const TestServer& server) {
  RawStream stream(server.channel());
  Start(stream);
  std::string bytes;
  for (uint64_t sequence = 1; sequence <= 60; ++sequence) {
    const bool touched = sequence % 20 > 5;
    EXPECT_TRUE(stream.Write(
        DenseU16(sequence, {touched ? Touch(sequence) : Untouched()})));
    v1::Answer answer = stream.Read().answer();
    bytes += answer.SerializeAsString();
  }
  return bytes;
}

TEST(MonitorTest, WatchingChangesNoBitOfAnAnswer) {
  const TestServer server;
  const std::string alone = Answers(server);
  WatchAll watch(server, v1::WatchAllRequest());
  v1::WatchAllResponse response;
  ASSERT_TRUE(watch.Read(&response));
  EXPECT_EQ(Answers(server), alone);
}

TEST(MonitorTest, WatchingOneStreamEndsWithIt) {
  const TestServer server;
  RawStream stream(server.channel());
  v1::WatchStreamRequest request;
  request.set_stream_id(Start(stream).stream_id());
  request.set_without_taxels(true);
  WatchOne watch(server, request);
  v1::WatchStreamResponse response;
  ASSERT_TRUE(watch.Read(&response));
  EXPECT_TRUE(response.update().has_opened());
  ASSERT_TRUE(stream.Write(DenseU16(1, {Touch(1)})));
  do {
    ASSERT_TRUE(watch.Read(&response));
  } while (!response.update().has_frame());
  EXPECT_EQ(response.update().frame().taxels(), "");
  stream.HalfClose();
  EXPECT_TRUE(stream.Finish().ok());
  while (watch.Read(&response)) {
  }
  EXPECT_TRUE(response.update().ended());
  EXPECT_TRUE(watch.Finish().ok());
}

TEST(MonitorTest, RefusesWhatItCannotShow) {
  const TestServer server;
  v1::WatchStreamRequest request;
  request.set_stream_id("77");
  v1::WatchStreamResponse response;
  WatchOne unknown(server, request);
  EXPECT_FALSE(unknown.Read(&response));
  EXPECT_EQ(ReasonOf(unknown.Finish()), "STREAM_NOT_FOUND");
  request.set_frames_per_second(31);
  WatchOne fast(server, request);
  EXPECT_FALSE(fast.Read(&response));
  EXPECT_EQ(ReasonOf(fast.Finish()), "INVALID_CONFIG");
}

TEST(MonitorTest, HasRoomForSoManyWatchers) {
  const TestServer server;
  std::list<WatchAll> watches;
  v1::WatchAllResponse response;
  for (int i = 0; i < limits::kMaxWatchers; ++i) {
    ASSERT_TRUE(
        watches.emplace_back(server, v1::WatchAllRequest()).Read(&response));
  }
  {
    WatchAll refused(server, v1::WatchAllRequest());
    EXPECT_FALSE(refused.Read(&response));
    EXPECT_EQ(ReasonOf(refused.Finish()), "STREAM_LIMIT");
  }
  watches.pop_front();
  EXPECT_TRUE(Eventually([&] {
    WatchAll another(server, v1::WatchAllRequest());
    return another.Read(&response);
  }));
}

// A server that drains does not wait for those who only watch.
TEST(MonitorTest, WatchersDoNotHoldUpTheEnd) {
  TestServer server(TestServer::OnLoopback(/*drain_grace_ms=*/5000));
  WatchAll watch(server, v1::WatchAllRequest());
  v1::WatchAllResponse response;
  ASSERT_TRUE(watch.Read(&response));
  server.server().Stop();
  EXPECT_FALSE(watch.Read(&response));
}

}  // namespace
}  // namespace tactus::internal
