// Probes and load balancers get the server's health and its changes.
#include <chrono>
#include <thread>

#include "grpc/health/v1/health.grpc.pb.h"
#include "gtest/gtest.h"
#include "tests/server/support/test_server.h"

namespace tactus::internal {
namespace {

using grpc::health::v1::Health;
using grpc::health::v1::HealthCheckRequest;
using grpc::health::v1::HealthCheckResponse;
using testing::TestServer;

class Watcher {
 public:
  Watcher(const TestServer& server, const std::string& service)
      : stub_(Health::NewStub(server.channel())) {
    HealthCheckRequest request;
    request.set_service(service);
    reader_ = stub_->Watch(&context_, request);
  }
  ~Watcher() {
    context_.TryCancel();
    while (Next() != HealthCheckResponse::UNKNOWN) {
    }
    reader_->Finish();
  }

  // UNKNOWN at the end.
  HealthCheckResponse::ServingStatus Next() {
    HealthCheckResponse response;
    return reader_->Read(&response) ? response.status()
                                    : HealthCheckResponse::UNKNOWN;
  }

 private:
  std::unique_ptr<Health::Stub> stub_;
  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReader<HealthCheckResponse>> reader_;
};

TEST(HealthTest, CheckAnswersForTheServerAndItsService) {
  TestServer server;
  const auto stub = Health::NewStub(server.channel());
  for (const char* service : {"", "tactus.v1.ContactService"}) {
    grpc::ClientContext context;
    HealthCheckRequest request;
    request.set_service(service);
    HealthCheckResponse response;
    ASSERT_TRUE(stub->Check(&context, request, &response).ok());
    EXPECT_EQ(response.status(), HealthCheckResponse::SERVING) << service;
  }
  grpc::ClientContext context;
  HealthCheckRequest request;
  request.set_service("no.Service");
  HealthCheckResponse response;
  const grpc::Status status = stub->Check(&context, request, &response);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_NE(status.error_message().find("no.Service"), std::string::npos);
}

TEST(HealthTest, WatchReportsChangesAndDoesNotDelayAStop) {
  TestServer server(TestServer::OnLoopback(300));
  testing::RawStream stream(server.channel());
  ASSERT_TRUE(stream.Write(testing::ConfigRequest()));
  ASSERT_TRUE(stream.Read().has_started());
  Watcher known(server, "tactus.v1.ContactService");
  Watcher unknown(server, "no.Service");
  EXPECT_EQ(known.Next(), HealthCheckResponse::SERVING);
  EXPECT_EQ(unknown.Next(), HealthCheckResponse::SERVICE_UNKNOWN);
  std::thread stop([&] { server.server().Stop(); });
  EXPECT_EQ(known.Next(), HealthCheckResponse::NOT_SERVING);
  stop.join();
  EXPECT_EQ(known.Next(), HealthCheckResponse::UNKNOWN);
  EXPECT_EQ(unknown.Next(), HealthCheckResponse::UNKNOWN);
}

TEST(HealthTest, WatchersComeAndGo) {
  TestServer server;
  for (int i = 0; i < 50; ++i) {
    Watcher watcher(server, "");
    EXPECT_EQ(watcher.Next(), HealthCheckResponse::SERVING);
  }
  testing::ExpectGoodStream(server.channel());
}

}  // namespace
}  // namespace tactus::internal
