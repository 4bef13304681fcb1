// File: keeping_server.h
//
// A training server that keeps the contacts of its robots, and what a client
// asks of them. A target that uses it defines TACTUS_TRAINER, as for a
// TrainingServer.
//
//   KeepingServer keeping;
//   keeping.Stream("left-arm", {1, 2});
//   keeping.CreateDataset("datasets/d");
//   const std::string name = keeping.List({}).contacts(0).name();
//   EXPECT_TRUE(keeping.Label("datasets/d", {{name, "SM"}}).ok());
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "gtest/gtest.h"
#include "server/contact_log/contact_log.h"
#include "tactus/v1/contact_log.grpc.pb.h"
#include "tests/server/support/test_server.h"
#include "tests/server/support/training_server.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal::testing {

class KeepingServer {
 public:
  // Frames of a contact that it streams.
  static constexpr int kFrames = 40;

  // In this process alone, or at this address too.
  explicit KeepingServer(const std::string& address = "")
      : log_(Open(scratch_.path())), server_({}, Serving(address)) {}

  TrainingServer& server() { return server_; }

  // Streams trials of one contact each, with these seeds. Returns their finals.
  std::vector<v1::Answer> Stream(
      const std::string& robot, const std::vector<uint64_t>& seeds,
      v1::ClassifyContactRequest config = ConfigRequest()) {
    RawStream stream(server_.channel());
    config.mutable_config()->set_client_id(robot);
    EXPECT_TRUE(stream.Write(config));
    uint64_t sequence = 1;
    for (const uint64_t seed : seeds) {
      for (const auto& frame : Contact(kFrames, seed)) {
        EXPECT_TRUE(stream.Write(DenseU16(sequence++, {frame})));
      }
      EXPECT_TRUE(stream.Write(EndOfTrialRequest()));
    }
    stream.HalfClose();
    EXPECT_TRUE(stream.Finish().ok());
    std::vector<v1::Answer> finals;
    for (const auto& response : stream.rest()) {
      if (response.answer().is_final()) finals.push_back(response.answer());
    }
    // The server ends the stream first, and hands over the recording then.
    EXPECT_TRUE(
        Eventually([&] { return List({}).kept() >= kept_ + seeds.size(); }));
    kept_ = List({}).kept();
    return finals;
  }

  v1::ListContactsResponse List(const v1::ListContactsRequest& request) {
    grpc::ClientContext context;
    v1::ListContactsResponse response;
    const auto status = stub_->ListContacts(&context, request, &response);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return response;
  }
  v1::ReplayContactResponse Replay(const std::string& name) {
    v1::ReplayContactRequest request;
    request.set_name(name);
    grpc::ClientContext context;
    v1::ReplayContactResponse response;
    const auto status = stub_->ReplayContact(&context, request, &response);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return response;
  }
  absl::StatusOr<v1::DatasetVersion> Label(
      const std::string& dataset,
      const std::vector<std::pair<std::string, std::string>>& labels,
      const std::string& request_id = "") {
    v1::LabelContactsRequest request;
    request.set_dataset(dataset);
    request.set_request_id(request_id);
    for (const auto& [contact, label] : labels) {
      v1::ContactLabel& out = *request.add_labels();
      out.set_contact(contact);
      out.set_label(label);
    }
    grpc::ClientContext context;
    v1::LabelContactsResponse response;
    const auto status = stub_->LabelContacts(&context, request, &response);
    if (!status.ok()) return client::FromGrpcStatus(status);
    return response.version();
  }
  void CreateDataset(const std::string& name) {
    v1::CreateDatasetRequest request;
    request.set_name(name);
    v1::CreateDatasetResponse response;
    grpc::ClientContext context;
    EXPECT_TRUE(
        server_.training().CreateDataset(&context, request, &response).ok());
  }
  std::vector<v1::TrialInfo> Trials(const std::string& version) {
    v1::ListTrialsRequest request;
    request.set_dataset_version(version);
    v1::ListTrialsResponse response;
    grpc::ClientContext context;
    EXPECT_TRUE(
        server_.training().ListTrials(&context, request, &response).ok());
    return {response.trials().begin(), response.trials().end()};
  }

 private:
  static std::unique_ptr<server::ContactLog> Open(const std::string& folder) {
    return *server::ContactLog::Open(
        {.folder = folder + "/contacts", .max_bytes = 16 << 20});
  }
  server::TactusServer::Options Serving(const std::string& address) {
    server::TactusServer::Options options;
    if (!address.empty()) options.listen = {address};
    options.contact_log = log_.get();
    return options;
  }

  ScratchDir scratch_;
  std::unique_ptr<server::ContactLog> log_;
  TrainingServer server_;
  std::unique_ptr<v1::ContactLogService::Stub> stub_ =
      v1::ContactLogService::NewStub(server_.channel());
  size_t kept_ = 0;
};

}  // namespace tactus::internal::testing
