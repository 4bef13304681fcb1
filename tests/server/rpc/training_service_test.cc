// Datasets, jobs and models over gRPC: the whole way from an upload to a stream
// on the trained model, and requests that are refused.
#include <functional>
#include <string>
#include <vector>

#include "absl/strings/str_format.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_proto.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/server/support/raw_call.h"
#include "tests/server/support/test_server.h"
#include "tests/server/support/training_server.h"

namespace tactus::internal {
namespace {

using testing::RawCall;
using testing::SmallPack;
using testing::SmallTraining;
using testing::TrainingServer;
using v1::Operation;

constexpr char kTraining[] = "/tactus.v1.TrainingService/";
constexpr char kOperations[] = "/tactus.v1.OperationService/";
constexpr char kModels[] = "/tactus.v1.ModelService/";

Operation Train(TrainingServer& server, const v1::TrainModelRequest& request) {
  grpc::ClientContext context;
  v1::TrainModelResponse response;
  const grpc::Status status =
      server.training().TrainModel(&context, request, &response);
  EXPECT_TRUE(status.ok()) << status.error_message();
  return response.operation();
}

std::string ServedVersion(TrainingServer& server) {
  testing::RawStream stream(server.channel());
  // Models of ideal signals know the arm's motion.
  v1::ClassifyContactRequest config = testing::ConfigRequest();
  config.mutable_config()->set_with_poses(true);
  EXPECT_TRUE(stream.Write(config));
  const std::string version = stream.Read().started().model_version();
  stream.HalfClose();
  EXPECT_TRUE(stream.Finish().ok());
  return version;
}

TEST(TrainingServiceTest, TrainsPromotesServesAndRollsBack) {
  TrainingServer server;
  ASSERT_EQ(server.Upload("datasets/arm", SmallPack()),
            "datasets/arm/versions/1");
  const Operation job = Train(server, SmallTraining());
  EXPECT_EQ(job.train().dataset_version(), "datasets/arm/versions/1");
  const Operation done = server.Await(job.name());
  ASSERT_EQ(done.state(), Operation::STATE_SUCCEEDED)
      << done.ShortDebugString();
  EXPECT_EQ(done.result().model_version(), "models/arm/versions/1");
  // A candidate is not served before it is promoted.
  EXPECT_EQ(ServedVersion(server), "models/default/versions/1");

  // A stream that is open keeps its version and gets a notice.
  testing::RawStream open(server.channel());
  ASSERT_TRUE(open.Write(testing::ConfigRequest()));
  ASSERT_TRUE(open.Read().has_started());
  v1::PromoteModelRequest promote;
  promote.mutable_spec()->set_alias("aliases/default");
  promote.mutable_spec()->set_model_version("models/arm/versions/1");
  v1::PromoteModelResponse promoted;
  grpc::ClientContext promote_context;
  ASSERT_TRUE(
      server.models().PromoteModel(&promote_context, promote, &promoted).ok());
  EXPECT_EQ(promoted.operation().state(), Operation::STATE_SUCCEEDED);
  ASSERT_TRUE(open.Write(testing::DenseU16(1, {testing::Untouched()})));
  bool noticed = false;
  for (int i = 0; i < 2 && !noticed; ++i) {
    noticed =
        open.Read().notice().kind() == v1::StreamNotice::KIND_MODEL_SUPERSEDED;
  }
  EXPECT_TRUE(noticed);
  EXPECT_EQ(ServedVersion(server), "models/arm/versions/1");

  v1::RollbackAliasRequest back;
  back.set_name("aliases/default");
  v1::RollbackAliasResponse alias;
  grpc::ClientContext back_context;
  ASSERT_TRUE(server.models().RollbackAlias(&back_context, back, &alias).ok());
  EXPECT_EQ(alias.alias().model_version(), "models/default/versions/1");
  EXPECT_EQ(ServedVersion(server), "models/default/versions/1");
}

TEST(TrainingServiceTest, ALateWatcherSeesTheWholeCurve) {
  TrainingServer server;
  server.Upload("datasets/arm", SmallPack());
  const Operation done = server.Await(Train(server, SmallTraining()).name());
  ASSERT_EQ(done.state(), Operation::STATE_SUCCEEDED);
  v1::WatchOperationRequest request;
  request.set_name(done.name());
  grpc::ClientContext context;
  const auto watch = server.operations().WatchOperation(&context, request);
  v1::WatchOperationResponse update;
  std::vector<v1::LearningPoint> points;
  while (watch->Read(&update)) {
    points.insert(points.end(), update.points().begin(), update.points().end());
  }
  EXPECT_TRUE(watch->Finish().ok());
  EXPECT_EQ(update.operation().state(), Operation::STATE_SUCCEEDED);
  const auto of_hmms = std::count_if(
      points.begin(), points.end(), [](const v1::LearningPoint& point) {
        return point.phase() == "fit HMMs" && point.part() == "hmm/HU/0";
      });
  EXPECT_GE(of_hmms, 2);
}

TEST(TrainingServiceTest, TheSameRequestIdIsTheSameJob) {
  TrainingServer server;
  server.Upload("datasets/arm", SmallPack());
  v1::TrainModelRequest request = SmallTraining();
  request.set_request_id("once");
  const std::string first = Train(server, request).name();
  EXPECT_EQ(Train(server, request).name(), first);
  request.set_request_id("twice");
  EXPECT_NE(Train(server, request).name(), first);
  request.set_validate_only(true);
  request.set_request_id("");
  EXPECT_EQ(Train(server, request).name(), "");
}

TEST(TrainingServiceTest, ARepeatedPromotionMovesNothing) {
  TrainingServer server;
  const auto add = [&] {
    const auto version = server.backend().models().AddVersion(
        "models/arm", *EncodeBundle(testing::SmallModel()), {}, {"test", ""});
    EXPECT_TRUE(version.ok()) << version.status();
    return version->name();
  };
  const auto promote = [&](const std::string& version, const char* id) {
    v1::PromoteModelRequest request;
    request.mutable_spec()->set_alias("aliases/default");
    request.mutable_spec()->set_model_version(version);
    request.set_request_id(id);
    v1::PromoteModelResponse response;
    grpc::ClientContext context;
    const grpc::Status status =
        server.models().PromoteModel(&context, request, &response);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return response.operation().name();
  };
  const std::string one = add(), two = add();
  const std::string first = promote(one, "a");
  EXPECT_NE(promote(two, "b"), first);
  EXPECT_EQ(promote(one, "a"), first);
  EXPECT_EQ(
      server.backend().models().GetAlias("aliases/default")->model_version(),
      two);
  EXPECT_EQ(server.backend().models().History("aliases/default")->size(), 2u);
}

TEST(TrainingServiceTest, AGateHoldsBackAWorseModel) {
  TrainingServer server;
  server.Upload("datasets/arm", SmallPack());
  server.Await(Train(server, SmallTraining()).name());
  const auto promote = [&](const std::string& version, bool force) {
    v1::PromoteModelRequest request;
    request.mutable_spec()->set_alias("aliases/default");
    request.mutable_spec()->set_model_version(version);
    request.mutable_spec()->set_force(force);
    v1::PromoteModelResponse response;
    grpc::ClientContext context;
    EXPECT_TRUE(
        server.models().PromoteModel(&context, request, &response).ok());
    return server.Await(response.operation().name());
  };
  ASSERT_EQ(promote("models/arm/versions/1", false).state(),
            Operation::STATE_SUCCEEDED);
  v1::UpdateAliasRequest update;
  update.set_name("aliases/default");
  update.mutable_gate()->set_dataset_version("datasets/arm/versions/1");
  v1::UpdateAliasResponse updated;
  grpc::ClientContext context;
  ASSERT_TRUE(server.models().UpdateAlias(&context, update, &updated).ok());

  // The built-in test model knows nothing of these trials.
  const Operation refused = promote("models/default/versions/1", false);
  ASSERT_EQ(refused.state(), Operation::STATE_FAILED)
      << refused.ShortDebugString();
  EXPECT_EQ(ReasonOf(FromStatusProto(refused.error())), "GATE_NOT_PASSED");
  const v1::Comparison& comparison = refused.result().comparison();
  EXPECT_FALSE(comparison.passed());
  EXPECT_EQ(comparison.current().accuracy().correct(), 16u);
  EXPECT_EQ(comparison.candidate().accuracy().contacts(), 16u);
  EXPECT_EQ(ServedVersion(server), "models/arm/versions/1");
  EXPECT_EQ(promote("models/default/versions/1", true).state(),
            Operation::STATE_SUCCEEDED);
  EXPECT_EQ(ServedVersion(server), "models/default/versions/1");
}

TEST(TrainingServiceTest, WithoutADataDirectoryEveryCallSaysSo) {
  testing::TestServer server;
  for (const char* file : {"training", "operations", "models"}) {
    const auto* descriptor =
        google::protobuf::DescriptorPool::generated_pool()->FindFileByName(
            absl::StrCat("tactus/v1/", file, ".proto"));
    ASSERT_NE(descriptor, nullptr);
    for (int s = 0; s < descriptor->service_count(); ++s) {
      const auto* service = descriptor->service(s);
      for (int m = 0; m < service->method_count(); ++m) {
        const std::string method = absl::StrFormat(
            "/%s/%s", service->full_name(), service->method(m)->name());
        EXPECT_EQ(ReasonOf(RawCall(server.channel(), method, "").status),
                  "NO_DATA_DIRECTORY")
            << method;
      }
    }
  }
  testing::ExpectGoodStream(server.channel());
}

struct BadRequest {
  std::string method;
  std::string bytes;
  std::string reason;
};

template <typename Request>
std::string Bytes(std::function<void(Request&)> fill) {
  Request request;
  fill(request);
  return request.SerializeAsString();
}

template <typename Request>
std::string Named(const std::string& name) {
  return Bytes<Request>([&](Request& r) { r.set_name(name); });
}

std::string Training(std::function<void(v1::TrainSpec&)> change) {
  v1::TrainModelRequest request = SmallTraining();
  change(*request.mutable_spec());
  return request.SerializeAsString();
}

std::string Chunk(const std::string& upload, int64_t offset,
                  const std::string& data, uint32_t crc32c) {
  return Bytes<v1::WriteUploadRequest>([&](v1::WriteUploadRequest& r) {
    r.set_upload(upload);
    r.set_write_offset(offset);
    r.set_data(data);
    r.set_crc32c(crc32c);
  });
}

std::vector<BadRequest> BadRequests() {
  std::vector<BadRequest> bad;
  const auto add = [&](const std::string& method, const std::string& bytes,
                       const std::string& reason) {
    bad.push_back({method, bytes, reason});
  };
  const std::string train = std::string(kTraining);
  const std::string ops = std::string(kOperations);
  const std::string models = std::string(kModels);
  // Names that become keys and parts of paths.
  const std::vector<std::string> names = {"",
                                          "arm",
                                          "datasets/",
                                          "datasets/..",
                                          "datasets/a/../b",
                                          "datasets/A",
                                          "datasets/a b",
                                          "datasets/a\n",
                                          "/datasets/a",
                                          "datasets/\xff\xfe",
                                          "datasets/" + std::string(65, 'a'),
                                          "datasets/a/versions/1"};
  for (const std::string& name : names) {
    if (name.find('\xff') != std::string::npos) continue;  // no proto3 string
    add(train + "CreateDataset", Named<v1::CreateDatasetRequest>(name),
        "INVALID_NAME");
    add(train + "DeleteDataset", Named<v1::DeleteDatasetRequest>(name),
        "INVALID_NAME");
  }
  // A string field that is not UTF-8 is no proto3 message.
  add(train + "CreateDataset", "\x0a\x02\xff\xfe", "MALFORMED_REQUEST");
  add(train + "CreateDataset", "\xff", "MALFORMED_REQUEST");
  add(train + "CreateDataset", Named<v1::CreateDatasetRequest>("datasets/arm"),
      "DATASET_EXISTS");
  add(train + "CreateDataset", Bytes<v1::CreateDatasetRequest>([](auto& r) {
        r.set_name("datasets/other");
        r.set_description(std::string(1025, 'x'));
      }),
      "INVALID_CONFIG");
  for (const char* method : {"GetDataset", "GetDatasetVersion"}) {
    add(train + method, Named<v1::GetDatasetRequest>("datasets/none"),
        "DATASET_NOT_FOUND");
  }
  for (const char* version : {"0", "00", "01", "-1", "2", "x", "1/", ""}) {
    add(train + "GetDatasetVersion",
        Named<v1::GetDatasetVersionRequest>(
            absl::StrCat("datasets/arm/versions/", version)),
        std::string(version) == "2" ? "DATASET_NOT_FOUND" : "INVALID_NAME");
  }
  add(train + "ListDatasets",
      Bytes<v1::ListDatasetsRequest>([](auto& r) { r.set_page_size(-1); }),
      "INVALID_CONFIG");
  add(train + "ListTrials", Bytes<v1::ListTrialsRequest>([](auto& r) {
        r.set_dataset_version("datasets/arm");
        r.set_page_token("none");
      }),
      "INVALID_CONFIG");
  add(train + "DownloadTrials", Bytes<v1::DownloadTrialsRequest>([](auto& r) {
        r.set_dataset_version("datasets/none");
      }),
      "DATASET_NOT_FOUND");
  // Uploads.
  add(train + "CreateUpload", Bytes<v1::CreateUploadRequest>([](auto& r) {
        r.set_dataset("datasets/none");
      }),
      "DATASET_NOT_FOUND");
  add(train + "CreateUpload", Bytes<v1::CreateUploadRequest>([](auto& r) {
        r.set_dataset("datasets/arm");
        r.set_request_id(std::string(129, 'x'));
      }),
      "INVALID_CONFIG");
  add(train + "QueryWriteStatus",
      Bytes<v1::QueryWriteStatusRequest>(
          [](auto& r) { r.set_upload("uploads/9"); }),
      "UPLOAD_NOT_FOUND");
  add(train + "QueryWriteStatus",
      Bytes<v1::QueryWriteStatusRequest>(
          [](auto& r) { r.set_upload("uploads/../1"); }),
      "INVALID_NAME");
  add(train + "WriteUpload", Chunk("uploads/9", 0, "x", 0), "UPLOAD_NOT_FOUND");
  add(train + "WriteUpload", Chunk("uploads/2", 5, "x", 0), "OFFSET_MISMATCH");
  add(train + "WriteUpload", Chunk("uploads/2", 0, "x", 1),
      "CHECKSUM_MISMATCH");
  add(train + "WriteUpload", Chunk("uploads/2", 0, "", 0), "INVALID_CONFIG");
  const auto finish = [](const std::string& name, int64_t size, uint32_t crc) {
    return Bytes<v1::FinishUploadRequest>([&](auto& r) {
      r.set_upload(name);
      r.set_size(size);
      r.set_crc32c(crc);
    });
  };
  add(train + "FinishUpload", finish("uploads/9", 0, 0), "UPLOAD_NOT_FOUND");
  add(train + "FinishUpload", finish("uploads/2", 1, 0), "OFFSET_MISMATCH");
  add(train + "FinishUpload", finish("uploads/2", 0, 0), "INVALID_TRIAL");
  // Training.
  add(train + "TrainModel", "", "INVALID_NAME");
  add(train + "TrainModel",
      Training([](auto& s) { s.set_model("models/arm/versions/1"); }),
      "INVALID_NAME");
  add(train + "TrainModel", Training([](auto& s) { s.set_preset("magic"); }),
      "INVALID_CONFIG");
  add(train + "TrainModel", Training([](auto& s) { s.add_features("smell"); }),
      "INVALID_CONFIG");
  add(train + "TrainModel", Training([](auto& s) { s.set_networks(1000); }),
      "INVALID_CONFIG");
  add(train + "TrainModel", Training([](auto& s) { s.add_with_cues("smell"); }),
      "INVALID_CONFIG");
  add(train + "TrainModel", Training([](auto& s) { s.set_epochs(0); }),
      "INVALID_CONFIG");
  add(train + "TrainModel", Training([](auto& s) { s.set_hmms_per_class(0); }),
      "INVALID_CONFIG");
  add(train + "TrainModel",
      Training([](auto& s) { s.set_note(std::string(1025, 'x')); }),
      "INVALID_CONFIG");
  add(train + "TrainModel",
      Training([](auto& s) { s.set_dataset_version("datasets/none"); }),
      "DATASET_NOT_FOUND");
  const auto evaluate = [](const std::string& dataset, const std::string& model,
                           const std::string& protocol) {
    return Bytes<v1::EvaluateModelRequest>([&](auto& r) {
      r.mutable_spec()->set_dataset_version(dataset);
      r.mutable_spec()->set_model_version(model);
      r.mutable_spec()->set_protocol(protocol);
    });
  };
  add(train + "EvaluateModel", evaluate("datasets/none", "", "loco"),
      "DATASET_NOT_FOUND");
  add(train + "EvaluateModel", evaluate("datasets/arm", "", "guess"),
      "INVALID_CONFIG");
  add(train + "EvaluateModel", evaluate("datasets/arm", "models/none", ""),
      "MODEL_NOT_FOUND");
  add(train + "EvaluateModel", evaluate("datasets/arm", "aliases/none", ""),
      "ALIAS_NOT_FOUND");
  // Operations.
  for (const char* method :
       {"GetOperation", "WaitOperation", "WatchOperation", "CancelOperation"}) {
    add(ops + method, Named<v1::GetOperationRequest>("operations/9"),
        "OPERATION_NOT_FOUND");
    add(ops + method, Named<v1::GetOperationRequest>("operations/x"),
        "INVALID_NAME");
  }
  add(ops + "WaitOperation", Bytes<v1::WaitOperationRequest>([](auto& r) {
        r.set_name("operations/9");
        r.set_timeout_ms(-1);
      }),
      "INVALID_CONFIG");
  add(ops + "ListOperations",
      Bytes<v1::ListOperationsRequest>([](auto& r) { r.set_page_size(-1); }),
      "INVALID_CONFIG");
  // Models and aliases.
  for (const char* method : {"GetModelVersion", "ExportModel"}) {
    add(models + method, Named<v1::GetModelVersionRequest>("models/none"),
        "MODEL_NOT_FOUND");
    add(models + method, Named<v1::GetModelVersionRequest>("models/.."),
        "INVALID_NAME");
  }
  add(models + "ImportModel", Bytes<v1::ImportModelRequest>([](auto& r) {
        r.set_model("models/new");
        r.set_data("no bundle");
      }),
      "BUNDLE_CORRUPT");
  add(models + "ImportModel", Bytes<v1::ImportModelRequest>([](auto& r) {
        r.set_model("models/default");
        r.set_data("no bundle");
      }),
      "INVALID_NAME");
  add(models + "DeleteModelVersion",
      Named<v1::DeleteModelVersionRequest>("models/default/versions/1"),
      "MODEL_NOT_FOUND");
  const auto promote = [](const std::string& alias,
                          const std::string& version) {
    return Bytes<v1::PromoteModelRequest>([&](auto& r) {
      r.mutable_spec()->set_alias(alias);
      r.mutable_spec()->set_model_version(version);
    });
  };
  add(models + "PromoteModel", promote("default", "models/default/versions/1"),
      "INVALID_NAME");
  add(models + "PromoteModel", promote("aliases/x", "models/default"),
      "INVALID_NAME");
  add(models + "PromoteModel", promote("aliases/x", "models/none/versions/1"),
      "MODEL_NOT_FOUND");
  add(models + "RollbackAlias", Named<v1::RollbackAliasRequest>("aliases/none"),
      "ALIAS_NOT_FOUND");
  add(models + "ListAliasHistory",
      Named<v1::ListAliasHistoryRequest>("aliases/none"), "ALIAS_NOT_FOUND");
  add(models + "UpdateAlias", Bytes<v1::UpdateAliasRequest>([](auto& r) {
        r.set_name("aliases/x");
        r.mutable_canary()->set_model_version("models/default/versions/1");
        r.mutable_canary()->set_per_mille(1001);
      }),
      "INVALID_CONFIG");
  add(models + "UpdateAlias", Bytes<v1::UpdateAliasRequest>([](auto& r) {
        r.set_name("aliases/x");
        r.mutable_gate()->set_dataset_version("datasets/none");
      }),
      "DATASET_NOT_FOUND");
  return bad;
}

TEST(TrainingServiceTest, BadRequestsAreRefusedAndTheServerServesOn) {
  TrainingServer server;
  ASSERT_EQ(server.Upload("datasets/arm", SmallPack()),
            "datasets/arm/versions/1");
  grpc::ClientContext context;
  v1::CreateUploadRequest upload;
  upload.set_dataset("datasets/arm");
  v1::CreateUploadResponse made;
  ASSERT_TRUE(server.training().CreateUpload(&context, upload, &made).ok());
  ASSERT_EQ(made.upload(), "uploads/2");
  const std::vector<BadRequest> bad = BadRequests();
  EXPECT_GE(bad.size(), 60u);
  for (const BadRequest& request : bad) {
    const absl::Status status =
        RawCall(server.channel(), request.method, request.bytes).status;
    EXPECT_EQ(ReasonOf(status), request.reason)
        << request.method << ": " << status;
  }
  testing::ExpectGoodStream(server.channel());
  EXPECT_EQ(server.Upload("datasets/arm", SmallPack()),
            "datasets/arm/versions/2");
}

// Callers that open calls and send nothing leave room for streams, and their
// places come back.
TEST(TrainingServiceTest, SilentCallsAreBounded) {
  TrainingServer server;
  server.Upload("datasets/arm", SmallPack());
  struct SilentCall {
    grpc::ClientContext context;
    v1::WriteUploadResponse response;
    std::unique_ptr<grpc::ClientWriter<v1::WriteUploadRequest>> writer;
  };
  std::vector<std::unique_ptr<SilentCall>> calls;
  for (int i = 0; i < limits::kMaxControlCallsPerPeer; ++i) {
    calls.push_back(std::make_unique<SilentCall>());
    calls.back()->writer = server.training().WriteUpload(
        &calls.back()->context, &calls.back()->response);
  }
  const auto list = [&] {
    return ReasonOf(
        RawCall(server.channel(), std::string(kTraining) + "ListDatasets", "")
            .status);
  };
  EXPECT_TRUE(testing::Eventually([&] { return list() == "STREAM_LIMIT"; }));
  testing::ExpectGoodStream(server.channel());
  for (const auto& call : calls) {
    call->context.TryCancel();
    call->writer->Finish();
  }
  EXPECT_TRUE(testing::Eventually([&] { return list().empty(); }));
}

// The server reads ahead while it works on a chunk. A refused chunk ends the
// call all the same, although the client has more to send.
TEST(TrainingServiceTest, ARefusedChunkEndsAnOpenCall) {
  TrainingServer server;
  server.Upload("datasets/arm", SmallPack());
  v1::CreateUploadRequest create;
  create.set_dataset("datasets/arm");
  v1::CreateUploadResponse upload;
  grpc::ClientContext create_context;
  ASSERT_TRUE(
      server.training().CreateUpload(&create_context, create, &upload).ok());
  // More calls than may be open at once.
  for (int i = 0; i < 2 * limits::kMaxControlCallsPerPeer; ++i) {
    grpc::ClientContext context;
    v1::WriteUploadResponse response;
    const auto writer = server.training().WriteUpload(&context, &response);
    v1::WriteUploadRequest chunk;
    chunk.set_upload(upload.upload());
    chunk.set_write_offset(3);
    chunk.set_data("x");
    ASSERT_TRUE(writer->Write(chunk));
    EXPECT_EQ(ReasonOf(client::FromGrpcStatus(writer->Finish())),
              "OFFSET_MISMATCH");
  }
}

// An error names the trial and the field; the dataset stays as it was.
TEST(TrainingServiceTest, ATrialThatIsNotValidIsNamed) {
  TrainingServer server;
  Trial trial = testing::SmallTrial(17);
  trial.signals[2][1] = std::nan("");
  const std::string error =
      server.Upload("datasets/arm", SmallPack() + testing::Packed(trial));
  EXPECT_THAT(error, ::testing::HasSubstr("trial-17"));
  EXPECT_THAT(error, ::testing::HasSubstr("signals"));
  grpc::ClientContext context;
  v1::GetDatasetRequest get;
  get.set_name("datasets/arm");
  v1::GetDatasetResponse dataset;
  ASSERT_TRUE(server.training().GetDataset(&context, get, &dataset).ok());
  EXPECT_EQ(dataset.versions_size(), 0);
}

}  // namespace
}  // namespace tactus::internal
