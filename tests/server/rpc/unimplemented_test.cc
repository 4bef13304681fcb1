// Every method whose turn has not come says so, with our reason.
#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "gtest/gtest.h"
#include "tactus/v1/admin.pb.h"
#include "tactus/v1/models.pb.h"
#include "tactus/v1/operations.pb.h"
#include "tactus/v1/training.pb.h"
#include "tests/server/support/raw_call.h"
#include "tests/server/support/test_server.h"

namespace tactus {
namespace {

TEST(UnimplementedTest, EveryMethodButClassifyContact) {
  testing::TestServer server;
  int methods = 0;
  for (const auto* file : {v1::ClassifyContactRequest::descriptor()->file(),
                           v1::GetServerInfoRequest::descriptor()->file(),
                           v1::ListModelsRequest::descriptor()->file(),
                           v1::ListOperationsRequest::descriptor()->file(),
                           v1::TrainModelRequest::descriptor()->file()}) {
    ASSERT_EQ(file->service_count(), 1) << file->name();
    const auto* service = file->service(0);
    for (int i = 0; i < service->method_count(); ++i) {
      const std::string& name = service->method(i)->name();
      if (name == "ClassifyContact") continue;
      const std::string method =
          absl::StrCat("/", service->full_name(), "/", name);
      const absl::Status status =
          testing::RawCall(server.channel(), method, "").status;
      EXPECT_EQ(status.code(), absl::StatusCode::kUnimplemented) << method;
      EXPECT_EQ(ReasonOf(status), "UNIMPLEMENTED") << method;
      EXPECT_EQ(InfoOf(status).metadata().at("rpc"), method);
      ++methods;
    }
  }
  EXPECT_GT(methods, 20);
}

TEST(UnimplementedTest, MethodsNobodyEverHeardOf) {
  testing::TestServer server;
  const absl::Status status =
      testing::RawCall(server.channel(), "/some.Service/Method", "x").status;
  EXPECT_EQ(ReasonOf(status), "UNIMPLEMENTED") << status;
}

}  // namespace
}  // namespace tactus
