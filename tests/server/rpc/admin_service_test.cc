// Administration over gRPC: the server's state, the audit log, quotas, and logs
// of jobs.
#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/version.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "server/records/audit_log.h"
#include "tests/server/support/test_server.h"
#include "tests/server/support/training_server.h"

namespace tactus::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Server = testing::TrainingServer;

v1::GetServerInfoResponse Info(Server& server) {
  grpc::ClientContext context;
  v1::GetServerInfoResponse info;
  const grpc::Status status = server.admin().GetServerInfo(&context, {}, &info);
  EXPECT_TRUE(status.ok()) << status.error_message();
  return info;
}

std::string CreateDataset(Server& server, const std::string& name) {
  v1::CreateDatasetRequest request;
  request.set_name(name);
  v1::CreateDatasetResponse response;
  grpc::ClientContext context;
  return ReasonOf(client::FromGrpcStatus(
      server.training().CreateDataset(&context, request, &response)));
}

std::string DeleteDataset(Server& server, const std::string& name) {
  v1::DeleteDatasetRequest request;
  request.set_name(name);
  v1::DeleteDatasetResponse response;
  grpc::ClientContext context;
  return ReasonOf(client::FromGrpcStatus(
      server.training().DeleteDataset(&context, request, &response)));
}

TEST(AdminServiceTest, ReportsTheStateOfTheServer) {
  Server server({.quotas = {.stored_bytes = 1 << 30, .datasets = 7}});
  const v1::GetServerInfoResponse empty = Info(server);
  EXPECT_EQ(empty.data().job_bytes(), 0);
  const std::string pack = testing::SmallPack();
  server.Upload("datasets/arm", pack);
  server.Send("datasets/arm", pack);
  server.backend().operations().Create({}, "", {"a", ""}).IgnoreError();
  v1::Operation ended;
  ended.set_state(v1::Operation::STATE_SUCCEEDED);
  server.backend().operations().Create(ended, "", {"a", ""}).IgnoreError();
  const v1::GetServerInfoResponse info = Info(server);
  EXPECT_EQ(info.version().version(), kVersion);
  EXPECT_EQ(info.version().api(), "tactus.v1");
  EXPECT_EQ(info.start_time_ms(), empty.start_time_ms());
  EXPECT_GE(info.time_ms(), info.start_time_ms());
  EXPECT_GE(info.uptime_ms(), empty.uptime_ms());
  const auto bytes = static_cast<int64_t>(pack.size());
  EXPECT_EQ(info.data().upload_bytes(), bytes);
  EXPECT_GE(info.data().blob_bytes(), empty.data().blob_bytes() + bytes - 64);
  EXPECT_GT(info.data().catalog_bytes(), 0);
  EXPECT_GT(info.data().free_bytes(), 0);
  EXPECT_EQ(info.data().folder(), server.backend().data().folder());
  ASSERT_GE(info.jobs_size(), 1);
  uint32_t jobs = 0;
  for (const v1::JobCount& count : info.jobs()) jobs += count.count();
  EXPECT_EQ(jobs, 2u);
  EXPECT_EQ(info.quotas().stored_bytes(), 1 << 30);
  EXPECT_EQ(info.quotas().datasets(), 7);
  EXPECT_THAT(info.not_served(), IsEmpty());
  EXPECT_EQ(info.streams(), 0u);
  EXPECT_EQ(info.max_streams(), static_cast<uint32_t>(limits::kMaxStreams));
  testing::RawStream stream(server.channel());
  ASSERT_TRUE(stream.Write(testing::ConfigRequest()));
  ASSERT_TRUE(stream.Read().has_started());
  EXPECT_EQ(Info(server).streams(), 1u);
}

TEST(AdminServiceTest, TheAuditLogIsListedTheNewestFirst) {
  Server server;
  CreateDataset(server, "datasets/a");
  CreateDataset(server, "datasets/b");
  DeleteDataset(server, "datasets/a");
  const auto list = [&](v1::ListAuditLogRequest request) {
    v1::ListAuditLogResponse response;
    grpc::ClientContext context;
    const grpc::Status status =
        server.admin().ListAuditLog(&context, request, &response);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return response;
  };
  v1::ListAuditLogRequest request;
  request.set_page_size(2);
  const auto first = list(request);
  ASSERT_EQ(first.entries_size(), 2);
  EXPECT_EQ(first.entries(0).verb(), "delete");
  EXPECT_EQ(first.entries(0).resource(), "datasets/a");
  EXPECT_GT(first.entries(0).time_ms(), 0);
  EXPECT_EQ(first.entries(1).resource(), "datasets/b");
  request.set_page_token(first.next_page_token());
  const auto second = list(request);
  ASSERT_EQ(second.entries_size(), 1);
  EXPECT_EQ(second.next_page_token(), "");
  request.Clear();
  request.set_resource_prefix("datasets/b");
  EXPECT_EQ(list(request).entries_size(), 1);
  request.set_caller("nobody");
  EXPECT_EQ(list(request).entries_size(), 0);
}

TEST(AdminServiceTest, DrainIsRecordedThenBegun) {
  std::atomic<int> drains = 0;
  server::TactusServer::Options serving;
  serving.drain_grace_ms = 1234;
  serving.on_drain = [&] { ++drains; };
  Server server({}, serving);
  grpc::ClientContext context;
  v1::DrainResponse response;
  ASSERT_TRUE(server.admin().Drain(&context, {}, &response).ok());
  EXPECT_EQ(response.grace_ms(), 1234);
  EXPECT_EQ(drains, 1);
  const auto page = server::ListAudit(server.backend().data().catalog(), 1, "",
                                      {.resource_prefix = "server"});
  ASSERT_EQ(page->items.size(), 1u);
  EXPECT_EQ(page->items[0].verb(), "drain");
}

TEST(QuotaRpcTest, AClientMeetsItsQuotasAndDeletionFrees) {
  const std::string pack = testing::SmallPack();
  const auto size = static_cast<int64_t>(pack.size());
  Server server({.quotas = {.stored_bytes = size + size / 2, .datasets = 2}});
  EXPECT_EQ(server.Upload("datasets/a", pack), "datasets/a/versions/1");
  EXPECT_EQ(CreateDataset(server, "datasets/b"), "");
  EXPECT_EQ(CreateDataset(server, "datasets/c"), "QUOTA_EXCEEDED");
  // The bytes of the second upload do not fit.
  const auto write = [&] {
    v1::CreateUploadRequest create;
    create.set_dataset("datasets/b");
    v1::CreateUploadResponse upload;
    grpc::ClientContext create_context;
    EXPECT_TRUE(
        server.training().CreateUpload(&create_context, create, &upload).ok());
    grpc::ClientContext context;
    v1::WriteUploadResponse response;
    const auto writer = server.training().WriteUpload(&context, &response);
    v1::WriteUploadRequest chunk;
    chunk.set_upload(upload.upload());
    chunk.set_data(pack);
    chunk.set_crc32c(ExtendCrc32c(0, pack));
    writer->Write(chunk);
    writer->WritesDone();
    return client::FromGrpcStatus(writer->Finish());
  };
  const absl::Status refused = write();
  EXPECT_EQ(ReasonOf(refused), "QUOTA_EXCEEDED");
  EXPECT_THAT(std::string(refused.message()),
              HasSubstr("the quota of stored bytes of"));
  EXPECT_EQ(DeleteDataset(server, "datasets/a"), "");
  EXPECT_TRUE(write().ok());
  EXPECT_EQ(CreateDataset(server, "datasets/c"), "");
}

TEST(QuotaRpcTest, StreamsOfAClientAreBounded) {
  server::TactusServer::Options options;
  options.max_streams_per_client = 2;
  testing::TestServer server(options);
  const auto open = [&] {
    auto stream = std::make_unique<testing::RawStream>(server.channel());
    stream->Write(testing::ConfigRequest());
    return stream;
  };
  auto first = open();
  ASSERT_TRUE(first->Read().has_started());
  const auto second = open();
  ASSERT_TRUE(second->Read().has_started());
  const auto third = open();
  third->HalfClose();
  EXPECT_EQ(ReasonOf(third->Finish()), "QUOTA_EXCEEDED");
  EXPECT_EQ(server.server().gate().live(), 2) << "a refused one is not counted";
  first->HalfClose();
  EXPECT_TRUE(first->Finish().ok());
  ASSERT_TRUE(
      testing::Eventually([&] { return server.server().gate().live() == 1; }));
  EXPECT_TRUE(open()->Read().has_started());
}

TEST(JobLogTest, IsReadableAfterTheJob) {
  Server server;
  server.Upload("datasets/arm", testing::SmallPack());
  v1::TrainModelRequest request;
  request.mutable_spec()->set_dataset_version("datasets/arm");
  request.mutable_spec()->set_model("models/arm");
  request.mutable_spec()->set_preset("paper");
  request.mutable_spec()->set_networks(0);
  grpc::ClientContext context;
  v1::TrainModelResponse response;
  ASSERT_TRUE(server.training().TrainModel(&context, request, &response).ok());
  const v1::Operation done = server.Await(response.operation().name());
  ASSERT_EQ(done.state(), v1::Operation::STATE_SUCCEEDED);
  const auto read = [&](const std::string& name, std::string* text,
                        int64_t* omitted) {
    v1::ReadOperationLogRequest ask;
    ask.set_name(name);
    grpc::ClientContext read_context;
    const auto reader =
        server.operations().ReadOperationLog(&read_context, ask);
    v1::ReadOperationLogResponse part;
    text->clear();
    *omitted = 0;
    while (reader->Read(&part)) {
      *text += part.data();
      *omitted += part.omitted_bytes();
    }
    return ReasonOf(client::FromGrpcStatus(reader->Finish()));
  };
  std::string text;
  int64_t omitted = -1;
  EXPECT_EQ(read("operations/77", &text, &omitted), "OPERATION_NOT_FOUND");
  EXPECT_EQ(read(done.name(), &text, &omitted), "");
  // A log of several messages, of which the beginning is not kept.
  v1::StoredLog log;
  log.set_data(std::string(limits::kMaxJobLogBytes - 1, 'x') + "y");
  log.set_omitted_bytes(5);
  ASSERT_TRUE(server.backend().operations().SaveLog(done.name(), log).ok());
  EXPECT_EQ(read(done.name(), &text, &omitted), "");
  EXPECT_EQ(text, log.data());
  EXPECT_EQ(omitted, 5);
}

TEST(SweepTest, AbandonedUploadsGoAtTheStartAndLater) {
  std::atomic<int64_t> now = 1'700'000'000'000;
  Server server({.now = [&] { return now.load(); }, .sweep_interval_ms = 5});
  CreateDataset(server, "datasets/arm");
  const std::string upload = server.Send("datasets/arm", testing::SmallPack());
  EXPECT_TRUE(server.backend().uploads().Get(upload).ok());
  now += limits::kAbandonedUploadMs;
  EXPECT_TRUE(testing::Eventually(
      [&] { return !server.backend().uploads().Get(upload).ok(); }));
}

}  // namespace
}  // namespace tactus::internal
