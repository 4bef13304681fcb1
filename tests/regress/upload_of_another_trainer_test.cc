// A trainer could write into another trainer's upload, which then failed its
// CRC32C and used up the quota of the client that had begun it.
#include <fstream>

#include "core/access/access_table.h"
#include "core/base/errors.h"
#include "gtest/gtest.h"
#include "tests/server/support/raw_call.h"
#include "tests/server/support/training_server.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal {
namespace {

constexpr char kTraining[] = "/tactus.v1.TrainingService/";

class Lab {
 public:
  Lab() {
    std::ofstream(folder_ / "tokens")
        << *TokenLine("ada", Role::kTrainer, "ada")
        << *TokenLine("bob", Role::kTrainer, "bob")
        << *TokenLine("root", Role::kAdmin, "root");
    authorizer_ = *server::Authorizer::Open(folder_ / "tokens");
    server::TactusServer::Options serving;
    serving.authorizer = authorizer_.get();
    server_ = std::make_unique<testing::TrainingServer>(
        server::TrainingBackend::Options(), serving);
  }

  // Sends one request as `caller`; returns the reason, and the answer.
  template <typename Response>
  std::string Call(const std::string& caller, const std::string& method,
                   const google::protobuf::Message& request,
                   Response* response) {
    const auto answer = testing::RawCall(server_->channel(), method,
                                         request.SerializeAsString(),
                                         {.authorization = "Bearer " + caller});
    if (answer.status.ok()) response->ParseFromString(answer.bytes);
    return ReasonOf(answer.status);
  }
  testing::TrainingServer& server() { return *server_; }

 private:
  const ScratchDir folder_;
  std::unique_ptr<server::Authorizer> authorizer_;
  std::unique_ptr<testing::TrainingServer> server_;
};

TEST(UploadOfAnotherTrainerTest, OnlyItsOwnerAndAdminsUseIt) {
  Lab lab;
  const std::string training = kTraining;
  v1::CreateDatasetRequest dataset;
  dataset.set_name("datasets/arm");
  v1::CreateDatasetResponse made;
  ASSERT_EQ(lab.Call("ada", training + "CreateDataset", dataset, &made), "");
  v1::CreateUploadRequest create;
  create.set_dataset("datasets/arm");
  v1::CreateUploadResponse upload;
  ASSERT_EQ(lab.Call("ada", training + "CreateUpload", create, &upload), "");

  const std::string pack = testing::SmallPack();
  v1::WriteUploadRequest chunk;
  chunk.set_upload(upload.upload());
  const auto write = [&](const std::string& caller, size_t begin, size_t end) {
    chunk.set_write_offset(static_cast<int64_t>(begin));
    chunk.set_data(pack.substr(begin, end - begin));
    chunk.set_crc32c(ExtendCrc32c(0, chunk.data()));
    v1::WriteUploadResponse written;
    return lab.Call(caller, training + "WriteUpload", chunk, &written);
  };
  v1::QueryWriteStatusRequest query;
  query.set_upload(upload.upload());
  v1::QueryWriteStatusResponse status;
  v1::FinishUploadRequest finish;
  finish.set_upload(upload.upload());
  finish.set_size(static_cast<int64_t>(pack.size()));
  finish.set_crc32c(ExtendCrc32c(0, pack));
  v1::FinishUploadResponse finished;

  EXPECT_EQ(write("bob", 0, pack.size()), "PERMISSION_DENIED");
  EXPECT_EQ(lab.Call("bob", training + "QueryWriteStatus", query, &status),
            "PERMISSION_DENIED");
  EXPECT_EQ(lab.Call("bob", training + "FinishUpload", finish, &finished),
            "PERMISSION_DENIED");
  ASSERT_EQ(write("ada", 0, 100), "");
  ASSERT_EQ(write("root", 100, 200), "");
  EXPECT_EQ(write("bob", 200, pack.size()), "PERMISSION_DENIED");
  ASSERT_EQ(lab.Call("ada", training + "QueryWriteStatus", query, &status), "");
  EXPECT_EQ(status.committed_size(), 200);
  ASSERT_EQ(write("ada", 200, pack.size()), "");
  ASSERT_EQ(lab.Call("ada", training + "FinishUpload", finish, &finished), "");
  EXPECT_EQ(finished.version().trials(), 16u);
  EXPECT_EQ(finished.version().requester(), "ada");
}

TEST(UploadOfAnotherTrainerTest, SoDoesAJobThatIsDeleted) {
  Lab lab;
  v1::Operation ended;
  ended.set_kind(v1::Operation::KIND_EVALUATE);
  ended.set_state(v1::Operation::STATE_SUCCEEDED);
  auto& operations = lab.server().backend().operations();
  const auto job = operations.Create(ended, "", {"ada", ""});
  ASSERT_TRUE(job.ok()) << job.status();
  v1::DeleteOperationRequest request;
  request.set_name(job->name());
  v1::DeleteOperationResponse response;
  const std::string method = "/tactus.v1.OperationService/DeleteOperation";
  EXPECT_EQ(lab.Call("bob", method, request, &response), "PERMISSION_DENIED");
  EXPECT_EQ(lab.Call("ada", method, request, &response), "");
  EXPECT_EQ(lab.Call("root", method, request, &response),
            "OPERATION_NOT_FOUND");
}

}  // namespace
}  // namespace tactus::internal
