// A server that sends posteriors before it has accepted the stream crashed the
// load generator: it looked up when the answered message had been due, although
// no message had been scheduled yet. So did a server that answers frames that
// were never sent. A write that was over after its stream half-closed it on a
// completion queue that was shut down.
#include <limits>

#include "gtest/gtest.h"
#include "tests/support/scripted_server.h"
#include "tools/load/load.h"

namespace tactus::internal::client {
namespace {

using testing::ScriptedServer;
using Stream = ScriptedServer::Stream;

LoadReport Load(const ScriptedServer& server) {
  const FrameScript script = *FrameScript::Create({.contacts = 1});
  const auto report = RunLoad({.servers = {server.address()},
                               .robots = 3,
                               .seconds = 0.1,
                               .warm_up_seconds = 0},
                              script);
  EXPECT_TRUE(report.ok()) << report.status();
  return report.ok() ? *report : LoadReport();
}

TEST(LoadOfAnotherServiceTest, IsReportedAsRefused) {
  ScriptedServer server([](grpc::ServerContext*, Stream* stream) {
    v1::ClassifyContactRequest request;
    while (stream->Read(&request)) stream->Write(testing::GoodAnswer(1));
    return grpc::Status::OK;
  });
  const LoadReport report = Load(server);
  EXPECT_EQ(report.refused, 3);
  EXPECT_EQ(report.sent, 0u);
  EXPECT_FALSE(report.first_error.empty());
}

TEST(LoadOfAnotherServiceTest, AnswersToFramesNeverSentEndTheStream) {
  ScriptedServer server([](grpc::ServerContext*, Stream* stream) {
    v1::ClassifyContactRequest request;
    stream->Read(&request);
    stream->Write(testing::GoodStarted());
    while (stream->Read(&request)) {
      stream->Write(testing::GoodAnswer(std::numeric_limits<uint64_t>::max()));
    }
    return grpc::Status::OK;
  });
  const LoadReport report = Load(server);
  EXPECT_EQ(report.answered, 0u);
  EXPECT_EQ(report.failed, 3);
}

}  // namespace
}  // namespace tactus::internal::client
