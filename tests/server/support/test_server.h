// File: test_server.h
//
// A TactusServer on test models, reached over the in-process channel, and a
// stream spoken to message by message.
#pragma once

#include <chrono>
#include <memory>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/stream/status.h"
#include "grpcpp/grpcpp.h"
#include "gtest/gtest.h"
#include "server/tactus_server.h"
#include "tests/server/support/requests.h"
#include "tests/server/support/test_models.h"

namespace tactus::internal::testing {

// Waits for `condition`, for as long as a loaded machine may need.
template <typename Condition>
bool Eventually(Condition condition) {
  for (int i = 0; i < 5000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return false;
}

class TestServer {
 public:
  explicit TestServer(const server::TactusServer::Options& options = {})
      : server_(*server::TactusServer::Start(&models_, options)),
        channel_(options.listen.empty()
                     ? server_->InProcessChannel()
                     : grpc::CreateChannel(
                           absl::StrCat("127.0.0.1:", server_->ports()[0]),
                           grpc::InsecureChannelCredentials())) {}

  // For tests of a stop: when a server stops, an in-process channel may close
  // before its last messages were taken; a socket delivers them.
  static server::TactusServer::Options OnLoopback(int drain_grace_ms) {
    server::TactusServer::Options options;
    options.listen = {"127.0.0.1:0"};
    options.drain_grace_ms = drain_grace_ms;
    return options;
  }

  server::TactusServer& server() { return *server_; }
  const std::shared_ptr<grpc::Channel>& channel() const { return channel_; }
  const TestModels& models() const { return models_; }

 private:
  TestModels models_;
  std::unique_ptr<server::TactusServer> server_;
  std::shared_ptr<grpc::Channel> channel_;
};

// A client that checks nothing.
class RawStream {
 public:
  explicit RawStream(const std::shared_ptr<grpc::Channel>& channel)
      : stub_(v1::ContactService::NewStub(channel)),
        rpc_(stub_->ClassifyContact(&context_)) {}
  ~RawStream() {
    if (!finished_) {
      context_.TryCancel();
      Finish().IgnoreError();
    }
  }

  bool Write(const v1::ClassifyContactRequest& request) {
    return rpc_->Write(request);
  }
  void HalfClose() { rpc_->WritesDone(); }
  void Cancel() { context_.TryCancel(); }
  // The next answer; an empty message at the end of the stream.
  v1::ClassifyContactResponse Read() {
    v1::ClassifyContactResponse response;
    if (!rpc_->Read(&response)) response.Clear();
    return response;
  }
  // Reads what is left and returns how the stream ended.
  absl::Status Finish() {
    finished_ = true;
    v1::ClassifyContactResponse response;
    while (rpc_->Read(&response)) rest_.push_back(response);
    return client::FromGrpcStatus(rpc_->Finish());
  }
  // What Finish read.
  const std::vector<v1::ClassifyContactResponse>& rest() const { return rest_; }

 private:
  grpc::ClientContext context_;
  std::unique_ptr<v1::ContactService::Stub> stub_;
  std::unique_ptr<grpc::ClientReaderWriter<v1::ClassifyContactRequest,
                                           v1::ClassifyContactResponse>>
      rpc_;
  std::vector<v1::ClassifyContactResponse> rest_;
  bool finished_ = false;
};

// A short good stream must work from start to end.
inline void ExpectGoodStream(const std::shared_ptr<grpc::Channel>& channel,
                             const std::string& model = "") {
  RawStream stream(channel);
  ASSERT_TRUE(stream.Write(ConfigRequest(model)));
  ASSERT_TRUE(stream.Read().has_started());
  ASSERT_TRUE(stream.Write(DenseU16(1, {Untouched(), Touch(1), Touch(2)})));
  for (uint64_t sequence = 1; sequence <= 3; ++sequence) {
    ASSERT_EQ(stream.Read().answer().sequence(), sequence);
  }
  stream.HalfClose();
  const absl::Status status = stream.Finish();
  EXPECT_TRUE(status.ok()) << status;
  ASSERT_EQ(stream.rest().size(), 1u);
  const v1::Answer& final_answer = stream.rest()[0].answer();
  EXPECT_TRUE(final_answer.is_final());
  ASSERT_EQ(final_answer.contacts_size(), 1);
  EXPECT_EQ(final_answer.contacts(0).state(), v1::Contact::STATE_TOUCHING);
}

}  // namespace tactus::internal::testing
