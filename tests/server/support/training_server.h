// File: training_server.h
//
// A server with an empty data directory, reached over the in-process channel. A
// target that uses it defines TACTUS_TRAINER as the path of the program
// tactus-trainer and depends on it.
//
//   TrainingServer server;
//   EXPECT_EQ(server.Upload("datasets/arm", SmallPack()),
//             "datasets/arm/versions/1");
//
// Owns the directory and removes it at the end.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>

#include "client/stream/status.h"
#include "core/base/crc32c.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/bundle/bundle.h"
#include "grpcpp/grpcpp.h"
#include "gtest/gtest.h"
#include "server/jobs/training_backend.h"
#include "server/tactus_server.h"
#include "tactus/v1/admin.grpc.pb.h"
#include "tactus/v1/models.grpc.pb.h"
#include "tactus/v1/operations.grpc.pb.h"
#include "tactus/v1/training.grpc.pb.h"
#include "tests/support/small_model.h"
#include "tests/support/small_trials.h"

namespace tactus::internal::testing {

// A training of less than a second on the newest version of "datasets/arm".
inline v1::TrainModelRequest SmallTraining() {
  v1::TrainModelRequest request;
  request.mutable_spec()->set_dataset_version("datasets/arm");
  request.mutable_spec()->set_model("models/arm");
  request.mutable_spec()->set_preset("paper");
  request.mutable_spec()->set_networks(0);
  return request;
}

class TrainingServer {
 public:
  // A new folder if `options` names none, and tactus-trainer if it names no
  // program.
  explicit TrainingServer(server::TrainingBackend::Options options = {},
                          server::TactusServer::Options serving = {})
      : folder_(options.folder.empty() ? NewFolder() : options.folder) {
    EXPECT_TRUE(
        registry_.AddBuiltIn("default", *EncodeBundle(SmallModel())).ok());
    options.folder = folder_;
    std::string& program = options.jobs.process.program;
    if (program.empty()) program = TACTUS_TRAINER;
    options.jobs.host = "test";
    backend_ = *server::TrainingBackend::Open(options, &registry_);
    backend_->Start();
    serving.training = backend_.get();
    server_ = *server::TactusServer::Start(&registry_, serving);
    channel_ = server_->InProcessChannel();
    training_ = v1::TrainingService::NewStub(channel_);
    operations_ = v1::OperationService::NewStub(channel_);
    models_ = v1::ModelService::NewStub(channel_);
    admin_ = v1::AdminService::NewStub(channel_);
  }
  ~TrainingServer() {
    backend_->Stop();
    channel_.reset();
    server_.reset();
    backend_.reset();
    std::filesystem::remove_all(folder_);
  }

  const std::shared_ptr<grpc::Channel>& channel() const { return channel_; }
  v1::TrainingService::Stub& training() { return *training_; }
  v1::OperationService::Stub& operations() { return *operations_; }
  v1::ModelService::Stub& models() { return *models_; }
  // Port of the address with this index.
  int port(size_t index) const { return server_->ports()[index]; }
  v1::AdminService::Stub& admin() { return *admin_; }
  server::TrainingBackend& backend() { return *backend_; }

  // Makes the dataset if it does not exist, and a version of `pack`. Returns
  // the version's name, or the error's text.
  std::string Upload(const std::string& dataset, const std::string& pack) {
    v1::CreateDatasetRequest create;
    v1::CreateDatasetResponse created;
    create.set_name(dataset);
    grpc::ClientContext context;
    training_->CreateDataset(&context, create, &created);
    v1::FinishUploadRequest finish;
    finish.set_upload(Send(dataset, pack));
    finish.set_size(static_cast<int64_t>(pack.size()));
    finish.set_crc32c(ExtendCrc32c(0, pack));
    v1::FinishUploadResponse response;
    grpc::ClientContext finish_context;
    const grpc::Status status =
        training_->FinishUpload(&finish_context, finish, &response);
    return status.ok() ? response.version().name() : status.error_message();
  }

  // Sends `pack`; returns the upload's name.
  std::string Send(const std::string& dataset, const std::string& pack) {
    v1::CreateUploadRequest create;
    create.set_dataset(dataset);
    v1::CreateUploadResponse upload;
    grpc::ClientContext context;
    EXPECT_TRUE(training_->CreateUpload(&context, create, &upload).ok());
    EXPECT_EQ(Write(upload.upload(), 0, pack), "");
    return upload.upload();
  }

  // Sends `bytes`, which begin at `offset` of an upload, in one call. Returns
  // the error's reason; empty if the server has all of them.
  std::string Write(const std::string& upload, int64_t offset,
                    absl::string_view bytes) {
    grpc::ClientContext context;
    v1::WriteUploadResponse response;
    const auto writer = training_->WriteUpload(&context, &response);
    for (size_t at = 0; at < bytes.size(); at += limits::kMaxChunkBytes) {
      v1::WriteUploadRequest chunk;
      chunk.set_upload(upload);
      chunk.set_write_offset(offset + static_cast<int64_t>(at));
      chunk.set_data(std::string(bytes.substr(at, limits::kMaxChunkBytes)));
      chunk.set_crc32c(ExtendCrc32c(0, chunk.data()));
      if (!writer->Write(chunk)) break;
    }
    writer->WritesDone();
    const grpc::Status status = writer->Finish();
    if (!status.ok()) return ReasonOf(client::FromGrpcStatus(status));
    EXPECT_EQ(response.committed_size(),
              offset + static_cast<int64_t>(bytes.size()));
    return "";
  }

  // Waits for the end of an operation.
  v1::Operation Await(const std::string& name) {
    v1::WaitOperationRequest request;
    request.set_name(name);
    request.set_timeout_ms(60'000);
    v1::WaitOperationResponse response;
    for (int i = 0; i < 10; ++i) {
      grpc::ClientContext context;
      const grpc::Status status =
          operations_->WaitOperation(&context, request, &response);
      EXPECT_TRUE(status.ok()) << status.error_message();
      if (!status.ok() || server::HasEnded(response.operation())) break;
    }
    return response.operation();
  }

 private:
  static std::string NewFolder() {
    std::string name = ::testing::TempDir() + "/tactus-training-XXXXXX";
    EXPECT_NE(mkdtemp(name.data()), nullptr);
    return name;
  }

  const std::string folder_;
  server::ModelRegistry registry_;
  std::unique_ptr<server::TrainingBackend> backend_;
  std::unique_ptr<server::TactusServer> server_;
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<v1::TrainingService::Stub> training_;
  std::unique_ptr<v1::OperationService::Stub> operations_;
  std::unique_ptr<v1::ModelService::Stub> models_;
  std::unique_ptr<v1::AdminService::Stub> admin_;
};

}  // namespace tactus::internal::testing
