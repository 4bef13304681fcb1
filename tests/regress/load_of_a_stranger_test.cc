// A server that answers posteriors before it has accepted the stream, such as
// an echo, ended the load generator: it looked up when the answered message had
// been due while nothing had been scheduled yet.
#include <memory>
#include <string>

#include "client/tools/load/load.h"
#include "grpcpp/server.h"
#include "grpcpp/server_builder.h"
#include "gtest/gtest.h"
#include "tactus/v1/contact.grpc.pb.h"

namespace tactus::client {
namespace {

class Stranger final : public v1::ContactService::Service {
 public:
  grpc::Status ClassifyContact(
      grpc::ServerContext*,
      grpc::ServerReaderWriter<v1::ClassifyContactResponse,
                               v1::ClassifyContactRequest>* stream) override {
    v1::ClassifyContactResponse answer;
    answer.mutable_posterior()->set_sequence(1);
    v1::ClassifyContactRequest request;
    while (stream->Read(&request)) stream->Write(answer);
    return grpc::Status::OK;
  }
};

TEST(LoadOfAStrangerTest, IsToldAsRefused) {
  Stranger stranger;
  grpc::ServerBuilder builder;
  int port = 0;
  builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(),
                           &port);
  builder.RegisterService(&stranger);
  const std::unique_ptr<grpc::Server> server = builder.BuildAndStart();
  ASSERT_NE(server, nullptr);
  const FrameScript script = *FrameScript::Create({.contacts = 1});
  const auto report = RunLoad({.address = "127.0.0.1:" + std::to_string(port),
                               .robots = 3,
                               .seconds = 0.1,
                               .warm_up_seconds = 0},
                              script);
  ASSERT_TRUE(report.ok()) << report.status();
  EXPECT_EQ(report->refused, 3);
  EXPECT_EQ(report->sent, 0u);
  EXPECT_FALSE(report->first_error.empty());
}

}  // namespace
}  // namespace tactus::client
