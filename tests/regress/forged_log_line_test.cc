// A client that asked for a model whose name held a newline wrote lines of its
// choice into the server's log.
#include <signal.h>

#include "core/base/errors.h"
#include "gtest/gtest.h"
#include "tests/server/support/test_server.h"
#include "tests/support/bystander.h"
#include "tests/support/child_tactusd.h"

namespace tactus::internal {
namespace {

using testing::Bystander;
using testing::ChildTactusd;

TEST(ForgedLogLineTest, NamesStayWithinTheirLine) {
  ChildTactusd server({"--log-level=debug"});
  ASSERT_NE(server.port(), 0);
  Bystander robot(server.address());
  {
    testing::RawStream stream(Bystander::OwnConnection(server.address()));
    v1::ClassifyContactRequest request =
        testing::ConfigRequest(testing::kModelWithoutPoses);
    request.mutable_config()->set_model("x\nforged line");
    stream.Write(request);
    EXPECT_FALSE(stream.Finish().ok());
  }
  {
    testing::RawStream stream(Bystander::OwnConnection(server.address()));
    v1::ClassifyContactRequest request =
        testing::ConfigRequest(testing::kModelWithoutPoses);
    request.mutable_config()->set_client_id("left \"arm\"");
    stream.Write(request);
    stream.HalfClose();
    EXPECT_TRUE(stream.Finish().ok());
  }
  EXPECT_NE(ChildTactusd::Run({"--model=a\nforged line=/no/such"}), 0);
  EXPECT_TRUE(robot.IsServed());
  EXPECT_TRUE(robot.Finish().ok());
  server.Signal(SIGTERM);
  EXPECT_EQ(server.Wait(), 0);
  EXPECT_EQ(server.Log().find("\nforged line"), std::string::npos)
      << server.Log();
  // The name that a client gives itself is in the line about its stream.
  EXPECT_NE(server.Log().find("of client \"left \\\"arm\\\"\" ended"),
            std::string::npos)
      << server.Log();
}

}  // namespace
}  // namespace tactus::internal
