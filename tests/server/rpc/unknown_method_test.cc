// A call of a method that no service has ends with gRPC's UNIMPLEMENTED.
#include "gtest/gtest.h"
#include "tests/server/support/raw_call.h"
#include "tests/server/support/test_server.h"

namespace tactus::internal {
namespace {

TEST(UnknownMethodTest, IsUnimplementedAndOthersAreServed) {
  testing::TestServer server;
  for (const char* method :
       {"/some.Service/Method", "/tactus.v1.ContactService/ClassifyEverything",
        "/tactus.v1.TrainingService/TrainEverything"}) {
    EXPECT_EQ(testing::RawCall(server.channel(), method, "x").status.code(),
              absl::StatusCode::kUnimplemented)
        << method;
  }
  testing::ExpectGoodStream(server.channel());
}

}  // namespace
}  // namespace tactus::internal
