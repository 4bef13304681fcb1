// What JSON of pages becomes, and what of servers becomes JSON.
#include "tools/console/page_json.h"

#include "absl/strings/str_cat.h"
#include "client/stream/status.h"
#include "core/base/errors.h"
#include "core/base/limits_console.h"
#include "gmock/gmock.h"
#include "google/protobuf/descriptor.h"
#include "gtest/gtest.h"
#include "tactus/v1/operations.pb.h"
#include "tactus/v1/training.pb.h"

namespace tactus::internal::console {
namespace {

using ::testing::HasSubstr;

const PageMethod& MethodNamed(absl::string_view path) {
  return *FindPageMethod(absl::StrCat("/api/servers/0/", path))->method;
}

grpc::ByteBuffer BytesOf(const google::protobuf::Message& message) {
  const grpc::Slice slice(message.SerializeAsString());
  return grpc::ByteBuffer(&slice, 1);
}

std::string TextOf(const grpc::ByteBuffer& buffer) {
  grpc::Slice slice;
  EXPECT_TRUE(buffer.DumpToSingleSlice(&slice).ok());
  return std::string(reinterpret_cast<const char*>(slice.begin()),
                     slice.size());
}

TEST(PageMethodsTest, AllOfThemExist) {
  for (const PageMethod& method : PageMethods()) {
    const auto* found =
        google::protobuf::DescriptorPool::generated_pool()->FindMethodByName(
            method.FullName());
    ASSERT_NE(found, nullptr) << method.FullName();
    EXPECT_FALSE(found->client_streaming()) << method.FullName();
    EXPECT_EQ(found->server_streaming(), method.answer != PageAnswer::kOne)
        << method.FullName();
  }
}

TEST(PageMethodsTest, OnlyWhatIsListedIsFound) {
  const auto found = FindPageMethod("/api/servers/12/ModelService/ListAliases");
  ASSERT_TRUE(found);
  EXPECT_EQ(found->server, 12u);
  EXPECT_EQ(found->method->Path(), "/tactus.v1.ModelService/ListAliases");
  const auto health = FindPageMethod("/api/servers/0/Health/Check");
  ASSERT_TRUE(health);
  EXPECT_EQ(health->method->Path(), "/grpc.health.v1.Health/Check");
  for (const char* path :
       {"/api/servers/0/ModelService/ImportModel",
        "/api/servers/0/Health/Watch",
        "/api/servers/0/ContactService/ClassifyContact",
        "/api/servers/0/ModelService/ListAliases/",
        "/api/servers/0/ModelService/", "/api/servers/0/ModelService",
        "/api/servers//ModelService/ListAliases",
        "/api/servers/-1/ModelService/ListAliases",
        "/api/servers/+1/ModelService/ListAliases",
        "/api/servers/ 1/ModelService/ListAliases",
        "/api/servers/999/ModelService/ListAliases",
        "/api/servers/0/modelservice/ListAliases",
        "/api/servers/0/ModelService/ListAliases?x",
        "/api/servers/0/../ModelService/ListAliases"}) {
    EXPECT_FALSE(FindPageMethod(path)) << path;
  }
}

TEST(PageJsonTest, ARequestBecomesItsMessage) {
  const auto request = RequestFromJson(
      MethodNamed("TrainingService/RelabelTrials"),
      R"({"dataset": "datasets/arm", "trials": ["a", "b"], "label": "hérz"})");
  ASSERT_TRUE(request.ok()) << request.status();
  v1::RelabelTrialsRequest message;
  ASSERT_TRUE(message.ParseFromString(TextOf(*request)));
  EXPECT_EQ(message.trials_size(), 2);
  EXPECT_EQ(message.label(), "hérz");
}

TEST(PageJsonTest, ARequestThatIsNoneIsRefused) {
  const std::string deep =
      absl::StrCat("{\"trials\":", std::string(100'000, '['),
                   std::string(100'000, ']'), "}");
  for (const std::string& json : {
           std::string(),
           std::string("no JSON"),
           std::string("[]"),
           std::string("{"),
           std::string("{}{}"),
           std::string(R"({"reason": 3, "reason2": 4})"),
           std::string(R"({"unknown": ""})"),
           std::string("{'reason': 'one quote'}"),
           std::string(R"({"reason": "a comma",})"),
           std::string(R"({"dataset": ["a"]})"),
           std::string(R"({"trials": {}})"),
           std::string("{\"reason\": \"\xff\"}"),
           std::string("{\"reason\": \"\xc0\x80\"}"),
           std::string("{\"reason\": \"\xed\xa0\x80\"}"),
           std::string(100'000, '['),
           deep,
       }) {
    const auto request =
        RequestFromJson(MethodNamed("TrainingService/RelabelTrials"), json);
    EXPECT_EQ(ReasonOf(request.status()), "INVALID_CONFIG")
        << json.substr(0, 60);
    EXPECT_LT(request.status().message().size(), 2'000u);
  }
}

TEST(PageJsonTest, BracketsInTextAreNoLevels) {
  EXPECT_TRUE(RequestFromJson(MethodNamed("TrainingService/RelabelTrials"),
                              absl::StrCat(R"({"reason": "a \" )",
                                           std::string(100, '['), "\"}"))
                  .ok());
}

// Half a character is text that no message may hold.
TEST(PageJsonTest, HalfACharacterNeverReachesAServer) {
  const auto request = RequestFromJson(
      MethodNamed("TrainingService/RelabelTrials"), R"({"reason": "\ud800"})");
  if (!request.ok()) return;
  v1::RelabelTrialsRequest message;
  EXPECT_TRUE(message.ParseFromString(TextOf(*request)));
}

TEST(PageJsonTest, ErrorsOfJobsKeepTheirReason) {
  v1::GetOperationResponse response;
  v1::Operation& operation = *response.mutable_operation();
  operation.set_name("operations/7");
  operation.set_create_time_ms(1'234'567'890'123);
  const absl::Status error = InvalidTrial("it has no label");
  operation.mutable_error()->set_code(static_cast<int>(error.code()));
  operation.mutable_error()->set_message(std::string(error.message()));
  error.ForEachPayload([&](absl::string_view url, const absl::Cord& bytes) {
    auto* detail = operation.mutable_error()->add_details();
    detail->set_type_url(std::string(url));
    detail->set_value(std::string(bytes));
  });
  // A detail of a type that nobody knows.
  operation.mutable_error()->add_details()->set_type_url("a.b/strange.Type");
  const auto json = JsonOfReply(MethodNamed("OperationService/GetOperation"),
                                {BytesOf(response)});
  ASSERT_TRUE(json.ok()) << json.status();
  EXPECT_THAT(*json, HasSubstr("\"reason\":\"INVALID_TRIAL\""));
  EXPECT_THAT(*json, HasSubstr("\"create_time_ms\":\"1234567890123\""));
}

TEST(PageJsonTest, AReplyThatIsNoneIsAnError) {
  const PageMethod& one = MethodNamed("OperationService/GetOperation");
  const grpc::Slice slice("\xff\xff no message");
  EXPECT_EQ(ReasonOf(JsonOfReply(one, {grpc::ByteBuffer(&slice, 1)}).status()),
            "INVALID_RESPONSE");
  EXPECT_EQ(ReasonOf(JsonOfReply(one, {}).status()), "INVALID_RESPONSE");
  const PageMethod& all = MethodNamed("OperationService/ReadOperationLog");
  EXPECT_EQ(*JsonOfReply(all, {}), "{\"messages\":[]}");
}

}  // namespace
}  // namespace tactus::internal::console
