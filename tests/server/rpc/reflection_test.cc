// A tool that knows nothing of Tactus can ask what there is.
#include <string>

#include "gtest/gtest.h"
#include "tests/server/support/raw_call.h"
#include "tests/server/support/test_server.h"

namespace tactus {
namespace {

TEST(ReflectionTest, ListsTheContactService) {
  testing::TestServer server;
  // ServerReflectionRequest{list_services: ""}: field 7, empty.
  const std::string bytes =
      testing::RawCall(
          server.channel(),
          "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo",
          std::string("\x3a\x00", 2))
          .bytes;
  EXPECT_NE(bytes.find("tactus.v1.ContactService"), std::string::npos);
  EXPECT_NE(bytes.find("grpc.health.v1.Health"), std::string::npos);
}

}  // namespace
}  // namespace tactus
