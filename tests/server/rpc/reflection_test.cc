// A tool without the protos of Tactus can list its services if the server was
// started with reflection.
#include <string>

#include "absl/status/status.h"
#include "gtest/gtest.h"
#include "tests/server/support/raw_call.h"
#include "tests/server/support/test_server.h"

namespace tactus::internal {
namespace {

testing::RawAnswer ListServices(const testing::TestServer& server) {
  // ServerReflectionRequest{list_services: ""}: field 7, empty.
  return testing::RawCall(
      server.channel(),
      "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo",
      std::string("\x3a\x00", 2));
}

TEST(ReflectionTest, IsOffByDefault) {
  const testing::TestServer server;
  EXPECT_EQ(ListServices(server).status.code(),
            absl::StatusCode::kUnimplemented);
}

TEST(ReflectionTest, ListsTheContactService) {
  const testing::TestServer server({.reflection = true});
  const std::string bytes = ListServices(server).bytes;
  EXPECT_NE(bytes.find("tactus.v1.ContactService"), std::string::npos);
  EXPECT_NE(bytes.find("grpc.health.v1.Health"), std::string::npos);
}

}  // namespace
}  // namespace tactus::internal
