// The generator's own client of gRPC against gRPC's servers: messages of any
// size both ways, readers that take their time, statuses with their reasons,
// TLS, sockets, and connections that are lost.
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <functional>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_proto.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/server/support/test_server.h"
#include "tests/server/support/tls_files.h"
#include "tests/support/hostile_server.h"
#include "tests/support/raw_http2.h"
#include "tests/support/scripted_server.h"
#include "tools/load/connection_loop.h"
#include "tools/load/grpc_call.h"
#include "tools/load/grpc_connection.h"
#include "tools/load/load.h"

namespace tactus::internal::client {
namespace {

using std::chrono::milliseconds;
using testing::ScriptedServer;
using Stream = ScriptedServer::Stream;

constexpr char kMethod[] = "/tactus.v1.ContactService/ClassifyContact";
constexpr milliseconds kTimeout(20'000);
// Long enough for what must not come.
constexpr milliseconds kMoment(100);

// A call that sends what it is given, and keeps what comes.
class TestCall final : private GrpcCall::Listener {
 public:
  TestCall() : call_(this, kMethod) {}

  void Send(const v1::ClassifyContactRequest& request) {
    outgoing_.push_back(request.SerializeAsString());
    call_.Resume();
  }
  void SendNoMore() {
    sends_no_more_ = true;
    call_.Resume();
  }
  GrpcCall* call() { return &call_; }
  const std::vector<std::string>& messages() const { return messages_; }
  bool ended() const { return ends_ == 1; }
  const absl::Status& status() const { return status_; }

 private:
  GrpcCall::Next TakeMessage(std::string* out) override {
    if (next_ == outgoing_.size()) {
      return sends_no_more_ ? GrpcCall::Next::kNoMore : GrpcCall::Next::kLater;
    }
    out->append(outgoing_[next_++]);
    return GrpcCall::Next::kMessage;
  }
  void OnMessage(absl::string_view message) override {
    EXPECT_EQ(ends_, 0);
    messages_.emplace_back(message);
  }
  void OnEnded(const absl::Status& status) override {
    ++ends_;
    status_ = status;
  }

  std::vector<std::string> outgoing_;
  size_t next_ = 0;
  bool sends_no_more_ = false;
  std::vector<std::string> messages_;
  int ends_ = 0;
  absl::Status status_;
  GrpcCall call_;
};

class ConnectionTest : public ::testing::Test {
 protected:
  std::shared_ptr<GrpcConnection> Connect(const std::string& address) {
    return std::make_shared<GrpcConnection>(
        &loop_, *ServerPlace::Find(address, std::nullopt));
  }
  bool Await(const std::function<bool()>& done) {
    return loop_.HandleUntil(done, kTimeout);
  }

  ConnectionLoop loop_;
};

// A response of about `bytes`.
v1::ClassifyContactResponse Response(size_t bytes) {
  v1::ClassifyContactResponse response = testing::GoodStarted();
  response.mutable_started()->set_model_version(std::string(bytes, 'x'));
  return response;
}

v1::ClassifyContactRequest Request(size_t bytes) {
  v1::ClassifyContactRequest request;
  request.mutable_frames()->set_taxels(std::string(bytes, 'y'));
  return request;
}

TEST_F(ConnectionTest, MessagesOfAnySizeGoBothWays) {
  // Beyond a frame of HTTP/2, and beyond the windows of flow control.
  const std::vector<size_t> sizes = {0, 1, 5, 1000, 16'384, 70'000, 120'000};
  ScriptedServer server([](grpc::ServerContext*, Stream* stream) {
    v1::ClassifyContactRequest request;
    while (stream->Read(&request)) {
      stream->Write(Response(request.frames().taxels().size()));
    }
    return grpc::Status::OK;
  });
  const auto connection = Connect(server.address());
  std::vector<std::unique_ptr<TestCall>> calls;
  for (int i = 0; i < 8; ++i) {
    calls.push_back(std::make_unique<TestCall>());
    calls.back()->call()->ReadAll();
    connection->Start(calls.back()->call());
    for (const size_t size : sizes) calls.back()->Send(Request(size));
    calls.back()->SendNoMore();
  }
  for (const auto& call : calls) {
    ASSERT_TRUE(Await([&] { return call->ended(); }));
    EXPECT_TRUE(call->status().ok()) << call->status();
    ASSERT_EQ(call->messages().size(), sizes.size());
    for (size_t i = 0; i < sizes.size(); ++i) {
      EXPECT_EQ(call->messages()[i], Response(sizes[i]).SerializeAsString());
    }
  }
  EXPECT_TRUE(connection->takes_calls());
}

TEST_F(ConnectionTest, AReaderTakesWhatItAskedFor) {
  constexpr int kResponses = 200;
  ScriptedServer server([](grpc::ServerContext*, Stream* stream) {
    for (int i = 0; i < kResponses; ++i) stream->Write(Response(1000 + i));
    return grpc::Status::OK;
  });
  const auto connection = Connect(server.address());
  TestCall slow;
  connection->Start(slow.call());
  EXPECT_FALSE(loop_.HandleUntil([] { return false; }, kMoment));
  EXPECT_EQ(slow.messages().size(), 0u);
  // One that waits does not keep others on its connection from theirs.
  TestCall quick;
  quick.call()->ReadAll();
  connection->Start(quick.call());
  ASSERT_TRUE(Await([&] { return quick.ended(); }));
  EXPECT_EQ(quick.messages().size(), size_t{kResponses});
  for (size_t i = 1; i <= 3; ++i) {
    slow.call()->ReadOne();
    ASSERT_TRUE(Await([&] { return slow.messages().size() == i; }));
  }
  EXPECT_FALSE(slow.ended());
  slow.call()->ReadAll();
  ASSERT_TRUE(Await([&] { return slow.ended(); }));
  EXPECT_TRUE(slow.status().ok()) << slow.status();
  ASSERT_EQ(slow.messages().size(), size_t{kResponses});
  for (int i = 0; i < kResponses; ++i) {
    EXPECT_EQ(slow.messages()[i], Response(1000 + i).SerializeAsString());
  }
}

TEST_F(ConnectionTest, AMessageBeyondTheLimitEndsTheCall) {
  ScriptedServer server([](grpc::ServerContext* context, Stream* stream) {
    stream->Write(Response(limits::kMaxReceiveBytes + 1));
    return ScriptedServer::SayNothing(context);
  });
  // Also for who reads nothing: it would keep all of it.
  for (const bool reads : {true, false}) {
    const auto connection = Connect(server.address());
    TestCall call;
    if (reads) call.call()->ReadAll();
    connection->Start(call.call());
    ASSERT_TRUE(Await([&] { return call.ended(); })) << reads;
    EXPECT_EQ(ReasonOf(call.status()), "INVALID_RESPONSE") << call.status();
  }
}

TEST_F(ConnectionTest, AStatusKeepsItsReasonAndItsWords) {
  const absl::Status full = StreamLimit("100 % of them, für \"alle\"", 7);
  ScriptedServer server([&](grpc::ServerContext*, Stream*) {
    return grpc::Status(static_cast<grpc::StatusCode>(full.code()),
                        std::string(full.message()),
                        ToStatusProto(full).SerializeAsString());
  });
  TestCall call;
  call.call()->ReadAll();
  const auto connection = Connect(server.address());
  connection->Start(call.call());
  ASSERT_TRUE(Await([&] { return call.ended(); }));
  EXPECT_EQ(call.status().code(), full.code());
  EXPECT_EQ(call.status().message(), full.message());
  EXPECT_EQ(ReasonOf(call.status()), "STREAM_LIMIT");
}

TEST_F(ConnectionTest, CallsEndWhenTheyGiveUpOrTheServerGoes) {
  auto server = std::make_unique<ScriptedServer>(
      [](grpc::ServerContext* context, Stream*) {
        return ScriptedServer::SayNothing(context);
      });
  const auto connection = Connect(server->address());
  TestCall cancelled;
  TestCall left;
  {
    // One that is deleted says nothing any more.
    TestCall deleted;
    for (TestCall* call : {&cancelled, &left, &deleted}) {
      connection->Start(call->call());
    }
    loop_.HandleUntil([] { return false; }, kMoment);
  }
  cancelled.call()->Cancel();
  EXPECT_TRUE(cancelled.ended());
  EXPECT_EQ(cancelled.status().code(), absl::StatusCode::kCancelled);
  loop_.HandleUntil([] { return false; }, kMoment);
  EXPECT_FALSE(left.ended());
  server.reset();
  ASSERT_TRUE(Await([&] { return left.ended(); }));
  EXPECT_FALSE(left.status().ok());
  ASSERT_TRUE(Await([&] { return !connection->takes_calls(); }));
  TestCall late;
  connection->Start(late.call());
  EXPECT_TRUE(late.ended());
  EXPECT_EQ(late.status().code(), absl::StatusCode::kUnavailable);
}

TEST_F(ConnectionTest, NobodyListens) {
  TestCall call;
  const auto connection = Connect("unix:/no/such/socket");
  connection->Start(call.call());
  ASSERT_TRUE(Await([&] { return call.ended(); }));
  EXPECT_EQ(call.status().code(), absl::StatusCode::kUnavailable);
  EXPECT_THAT(std::string(call.status().message()),
              ::testing::HasSubstr("unix:/no/such/socket: No such file"));
  for (const char* wrong : {"nowhere", "unix:", "no.such.host.invalid:1"}) {
    EXPECT_FALSE(ServerPlace::Find(wrong, std::nullopt).ok()) << wrong;
  }
  EXPECT_EQ(ReasonOf(ServerPlace::Find("localhost:1", "no PEM").status()),
            "INVALID_CONFIG");
}

TEST_F(ConnectionTest, HostileServersTakeNeitherTimeNorMemory) {
  const std::string status_200 = "\x88";
  std::string headers;
  for (int i = 0; i < 3'000; ++i) headers += std::string("\0\1a\1b", 5);
  const auto frame = [](uint8_t type, int stream, const std::string& bytes) {
    return testing::RawHttp2::FrameBytes(type, 0, stream, bytes);
  };
  constexpr uint8_t kHeaders = 1;
  constexpr uint8_t kPing = 6;
  constexpr uint8_t kContinuation = 9;
  const struct {
    const char* what;
    std::string first;
    std::string piece;
  } cases[] = {
      {"a value of 4 GiB",
       frame(kHeaders, 1,
             status_200 + std::string("\0\1x\x7f\x80\xff\xff\xff\x0f", 9)),
       frame(kContinuation, 1, std::string(16'384, 'a'))},
      {"headers without end", frame(kHeaders, 1, status_200),
       frame(kContinuation, 1, headers)},
      {"pings without end", "", frame(kPing, 0, "12345678")},
      {"no HTTP/2", "220 mail ready\r\n", "500 what?\r\n"},
  };
  for (const auto& c : cases) {
    const testing::HostileServer server(c.first, c.piece);
    const auto connection = Connect(server.address());
    TestCall call;
    call.call()->ReadAll();
    connection->Start(call.call());
    EXPECT_TRUE(Await([&] { return call.ended(); })) << c.what;
    EXPECT_EQ(call.status().code(), absl::StatusCode::kUnavailable) << c.what;
    EXPECT_EQ(call.messages().size(), 0u) << c.what;
  }
}

LoadOptions Short(const std::string& address) {
  return {.servers = {address},
          .robots = 3,
          .seconds = 0.2,
          .warm_up_seconds = 0,
          .connections = 1};
}

TEST(LoadTransportTest, RunsOverTlsAndUnixSockets) {
  const testing::TlsFiles files;
  const testing::TlsFiles others;
  const testing::TlsFiles elsewhere("DNS:elsewhere.example");
  ASSERT_TRUE(files.made() && others.made() && elsewhere.made())
      << "needs the openssl program";
  const auto text = [](const std::string& path) {
    std::ifstream file(path);
    std::ostringstream all;
    all << file.rdbuf();
    return all.str();
  };
  const std::string socket =
      absl::StrCat("unix:", ::testing::TempDir(), "/load-", getpid(), ".sock");
  const auto serve = [&](const testing::TlsFiles& identity) {
    return std::make_unique<testing::TestServer>(server::TactusServer::Options{
        .listen = {"127.0.0.1:0", socket},
        .tls =
            *server::ReadTlsIdentity(identity.certificate(), identity.key())});
  };
  const FrameScript script = *FrameScript::Create({.contacts = 1});
  {
    const auto server = serve(files);
    const std::string address =
        absl::StrCat("localhost:", server->server().ports()[0]);
    LoadOptions options = Short(address);
    options.tls_roots = text(files.certificate());
    const LoadReport good = *RunLoad(options, script);
    EXPECT_EQ(good.refused, 0) << good.first_error;
    EXPECT_EQ(good.sent, 60u);
    options.servers = {socket};
    const LoadReport plain = *RunLoad(options, script);
    EXPECT_EQ(plain.refused, 0) << plain.first_error;
    // Somebody else's authority, and none.
    options.servers = {address};
    options.tls_roots = text(others.certificate());
    EXPECT_EQ(RunLoad(options, script)->refused, 3);
    EXPECT_EQ(RunLoad(Short(address), script)->refused, 3);
  }
  const auto server = serve(elsewhere);
  LoadOptions options =
      Short(absl::StrCat("localhost:", server->server().ports()[0]));
  options.tls_roots = text(elsewhere.certificate());
  EXPECT_EQ(RunLoad(options, script)->refused, 3);
}

}  // namespace
}  // namespace tactus::internal::client
