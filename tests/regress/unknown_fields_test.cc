// 60 TrainModel calls with 1 MB of unknown fields each took 3.2 GB, were stored
// for ever and took 1.3 GB after a restart. An upload of one trial with 63 MiB
// of unknown fields took 1.4 GB, four at once 5.2 GB.
#include <atomic>
#include <functional>
#include <thread>
#include <vector>

#include "client/stream/status.h"
#include "core/base/crc32c.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/bundle/bundle.h"
#include "grpcpp/grpcpp.h"
#include "gtest/gtest.h"
#include "tactus/v1/models.grpc.pb.h"
#include "tactus/v1/operations.grpc.pb.h"
#include "tactus/v1/training.grpc.pb.h"
#include "tests/server/support/raw_call.h"
#include "tests/support/bystander.h"
#include "tests/support/child_tactusd.h"
#include "tests/support/scratch_dir.h"
#include "tests/support/sealed_bundle.h"
#include "tests/support/small_model.h"
#include "tests/support/small_trials.h"

namespace tactus::internal {
namespace {

using testing::Bystander;
using testing::ChildTactusd;
using testing::RawCall;

constexpr char kDataset[] = "datasets/arm";
constexpr char kTraining[] = "/tactus.v1.TrainingService/";
// What the server may take beside what it had.
constexpr double kMostMibOfUnknown = 100;

// `bytes` of empty fields with the number 99: each takes 3 bytes here, and 48
// and more in memory.
std::string Unknown(size_t bytes) {
  // The tag is 99 << 3 | 2, the length 0.
  const std::string field("\x9a\x06\0", 3);
  std::string fields;
  fields.reserve(bytes);
  while (fields.size() + field.size() <= bytes) fields += field;
  return fields;
}

std::string Field(int number, const std::string& bytes) {
  std::string field;
  {
    google::protobuf::io::StringOutputStream stream(&field);
    google::protobuf::io::CodedOutputStream out(&stream);
    out.WriteTag(static_cast<uint32_t>(number) << 3 | 2);
    out.WriteVarint32(static_cast<uint32_t>(bytes.size()));
    out.WriteRaw(bytes.data(), static_cast<int>(bytes.size()));
  }
  return field;
}

class Trainer {
 public:
  explicit Trainer(const std::string& address)
      : channel_(Bystander::OwnConnection(address)),
        stub_(v1::TrainingService::NewStub(channel_)) {}

  const std::shared_ptr<grpc::Channel>& channel() const { return channel_; }

  void CreateDataset() {
    v1::CreateDatasetRequest request;
    request.set_name(kDataset);
    v1::CreateDatasetResponse response;
    grpc::ClientContext context;
    EXPECT_TRUE(stub_->CreateDataset(&context, request, &response).ok());
  }
  // The reason that the upload ended with; "" if it became a version.
  std::string Upload(const std::string& pack) {
    v1::CreateUploadRequest create;
    create.set_dataset(kDataset);
    v1::CreateUploadResponse upload;
    grpc::ClientContext create_context;
    EXPECT_TRUE(stub_->CreateUpload(&create_context, create, &upload).ok());
    grpc::ClientContext write_context;
    v1::WriteUploadResponse written;
    const auto writer = stub_->WriteUpload(&write_context, &written);
    v1::WriteUploadRequest chunk;
    chunk.set_upload(upload.upload());
    for (size_t at = 0; at < pack.size(); at += limits::kMaxChunkBytes) {
      chunk.set_write_offset(static_cast<int64_t>(at));
      chunk.set_data(pack.substr(at, limits::kMaxChunkBytes));
      chunk.set_crc32c(ExtendCrc32c(0, chunk.data()));
      if (!writer->Write(chunk)) break;
    }
    writer->WritesDone();
    EXPECT_TRUE(writer->Finish().ok());
    v1::FinishUploadRequest finish;
    finish.set_upload(upload.upload());
    finish.set_size(static_cast<int64_t>(pack.size()));
    finish.set_crc32c(ExtendCrc32c(0, pack));
    v1::FinishUploadResponse response;
    grpc::ClientContext finish_context;
    const grpc::Status status =
        stub_->FinishUpload(&finish_context, finish, &response);
    return ReasonOf(client::FromGrpcStatus(status));
  }
  std::string Train(const std::string& request) {
    return ReasonOf(
        RawCall(channel_, std::string(kTraining) + "TrainModel", request)
            .status);
  }
  int Operations() {
    v1::ListOperationsRequest request;
    request.set_page_size(1'000);
    v1::ListOperationsResponse response;
    grpc::ClientContext context;
    const auto stub = v1::OperationService::NewStub(channel_);
    EXPECT_TRUE(stub->ListOperations(&context, request, &response).ok());
    return response.operations_size();
  }

 private:
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<v1::TrainingService::Stub> stub_;
};

std::vector<std::string> Flags(const std::string& folder) {
  // A program that ends at once: the jobs do not matter here.
  return {"--data-dir=" + folder, "--trainer=/bin/true"};
}

std::string SmallTraining() {
  v1::TrainModelRequest request;
  request.mutable_spec()->set_dataset_version(kDataset);
  request.mutable_spec()->set_model("models/arm");
  return request.SerializeAsString();
}

TEST(UnknownFieldsTest, OfRequestsAreNotKept) {
  const ScratchDir folder;
  double first = 0;
  {
    ChildTactusd server(Flags(folder / "data"));
    ASSERT_NE(server.port(), 0);
    Bystander robot(server.address());
    Trainer trainer(server.address());
    trainer.CreateDataset();
    ASSERT_EQ(trainer.Upload(testing::SmallPack()), "");
    ASSERT_EQ(trainer.Train(SmallTraining()), "");
    first = server.ResidentMib();
    server.ResetPeak();
    // In the specification, which is stored.
    const std::string large = Field(1, Unknown(1'000'000)) + SmallTraining();
    const std::string nested = Field(1, Unknown(8'000)) + SmallTraining();
    for (int i = 0; i < 60; ++i) {
      EXPECT_EQ(trainer.Train(large), "MESSAGE_TOO_LARGE");
      EXPECT_EQ(trainer.Train(nested), "MALFORMED_REQUEST");
    }
    EXPECT_TRUE(server.PeakIsBelow(first + kMostMibOfUnknown));
    std::printf("60 calls: %.0f MiB, before %.0f\n", server.PeakMib(), first);
    EXPECT_EQ(trainer.Operations(), 1);
    EXPECT_TRUE(robot.IsServed());
    EXPECT_TRUE(robot.Finish().ok());
    server.Signal(SIGTERM);
    EXPECT_EQ(server.Wait(), 0);
  }
  ChildTactusd server(Flags(folder / "data"));
  EXPECT_TRUE(server.PeakIsBelow(first + kMostMibOfUnknown));
  std::printf("after a restart: %.0f MiB\n", server.PeakMib());
}

// What TrainSpec, EvaluateSpec, PromoteSpec and others hold is stored.
TEST(UnknownFieldsTest, AreRefusedWhereverTheyAre) {
  const ScratchDir folder;
  ChildTactusd server(Flags(folder / "data"));
  Trainer trainer(server.address());
  const std::string in_place = Unknown(3);
  const std::string nested = Field(1, in_place);
  const std::pair<const char*, std::string> requests[] = {
      {"TrainingService/CreateDataset", in_place},
      {"TrainingService/CreateUpload", in_place},
      {"TrainingService/WriteUpload", in_place},
      {"TrainingService/FinishUpload", in_place},
      {"TrainingService/ListTrials", in_place},
      {"TrainingService/TrainModel", nested},
      {"TrainingService/EvaluateModel", nested},
      {"TrainingService/EvaluateModel", Field(1, Field(4, in_place))},
      {"ModelService/PromoteModel", nested},
      {"ModelService/ImportModel", in_place},
      {"ModelService/UpdateAlias", Field(4, in_place)},
      {"OperationService/CancelOperation", in_place},
      {"AdminService/ListAuditLog", in_place},
      // A group, which proto3 does not have, and one that does not end.
      {"TrainingService/TrainModel", Field(1, "\x9b\x06\x9c\x06")},
      {"TrainingService/TrainModel", Field(1, "\x9b\x06")},
      // A text where a number belongs: the parser would keep it as unknown.
      {"TrainingService/TrainModel", Field(1, Field(5, "text"))},
  };
  for (const auto& [method, bytes] : requests) {
    EXPECT_EQ(ReasonOf(RawCall(trainer.channel(),
                               absl::StrCat("/tactus.v1.", method), bytes)
                           .status),
              "MALFORMED_REQUEST")
        << method;
  }
}

// Uploads of one trial of 63 MiB, nearly all of which `fill` makes: each of
// `counts` at once.
void ExpectRefusedTrial(const std::function<std::string(size_t)>& fill,
                        const std::vector<int>& counts) {
  const ScratchDir folder;
  ChildTactusd server(Flags(folder / "data"));
  ASSERT_NE(server.port(), 0);
  Bystander robot(server.address());
  Trainer trainer(server.address());
  trainer.CreateDataset();
  ASSERT_EQ(trainer.Upload(testing::SmallPack()), "");
  const std::string pack =
      testing::Packed(ToRecord(testing::SmallTrial(1)).SerializeAsString() +
                      fill(63 * 1024 * 1024));
  const double first = server.ResidentMib();
  for (const int uploads : counts) {
    server.ResetPeak();
    std::vector<std::thread> threads;
    for (int i = 0; i < uploads; ++i) {
      threads.emplace_back([&] {
        EXPECT_EQ(Trainer(server.address()).Upload(pack), "INVALID_TRIAL");
      });
    }
    for (std::thread& thread : threads) thread.join();
    std::printf("%d at once: %.0f MiB, before %.0f\n", uploads,
                server.PeakMib(), first);
    // One trial that is looked at, and the messages of all.
    EXPECT_TRUE(server.PeakIsBelow(first + 160)) << uploads << " uploads";
    EXPECT_TRUE(robot.IsServed());
  }
  EXPECT_TRUE(robot.Finish().ok());
}

TEST(UnknownFieldsTest, OfTrialsTakeNoMemory) {
  ExpectRefusedTrial(Unknown, {1, 4});
}

// Fields that are known may grow as well: each byte is a number of four bytes.
TEST(UnknownFieldsTest, ListsThatGrowInMemoryAreRefused) {
  ExpectRefusedTrial(
      [](size_t bytes) {
        return Field(10, Field(11, std::string(bytes, '\1')));
      },
      {1});
}

TEST(UnknownFieldsTest, OfBundlesAreRefused) {
  const ScratchDir folder;
  ChildTactusd server(Flags(folder / "data"));
  Trainer trainer(server.address());
  const auto stub = v1::ModelService::NewStub(trainer.channel());
  const auto import = [&](const std::string& bundle) {
    grpc::ClientContext context;
    v1::ImportModelResponse response;
    const auto writer = stub->ImportModel(&context, &response);
    v1::ImportModelRequest request;
    request.set_model("models/m");
    for (size_t at = 0; at < bundle.size(); at += limits::kMaxChunkBytes) {
      request.set_data(bundle.substr(at, limits::kMaxChunkBytes));
      if (!writer->Write(request)) break;
    }
    writer->WritesDone();
    return ReasonOf(client::FromGrpcStatus(writer->Finish()));
  };
  const std::string good = *EncodeBundle(testing::SmallModel());
  EXPECT_EQ(import(good), "");
  const std::string payload(BundleBody(good).substr(20));
  EXPECT_EQ(import(testing::SealedBundle(payload + Unknown(3))),
            "BUNDLE_CORRUPT");
  EXPECT_EQ(import(testing::SealedBundle(payload + Unknown(1'000'000))),
            "BUNDLE_CORRUPT");
}

}  // namespace
}  // namespace tactus::internal
