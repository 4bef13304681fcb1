// SIGTERM after the reader of the log had gone ended the server by SIGPIPE,
// without a drain; SIGHUP killed it.
#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include "client/stream/status.h"
#include "core/base/errors.h"
#include "gtest/gtest.h"
#include "tests/server/support/test_server.h"
#include "tests/support/bystander.h"
#include "tests/support/child_tactusd.h"

namespace tactus::internal {
namespace {

using testing::Bystander;
using testing::ChildTactusd;

// The stream must get its notice of the drain, and the server must exit with
// code 0.
void ExpectDrain(ChildTactusd& server, int signal) {
  testing::RawStream stream(Bystander::OwnConnection(server.address()));
  ASSERT_TRUE(
      stream.Write(testing::ConfigRequest(testing::kModelWithoutPoses)));
  ASSERT_TRUE(stream.Read().has_started());
  server.Signal(signal);
  EXPECT_TRUE(stream.Read().has_notice());
  stream.HalfClose();
  EXPECT_TRUE(stream.Finish().ok());
  EXPECT_EQ(server.Wait(), 0);
}

TEST(LogReaderGoneTest, SigtermDrains) {
  int ends[2];
  ASSERT_EQ(pipe2(ends, O_CLOEXEC), 0);
  ChildTactusd server(ChildTactusd::Options{.standard_error = ends[1]});
  close(ends[0]);
  close(ends[1]);
  ASSERT_NE(server.port(), 0);
  ExpectDrain(server, SIGTERM);
}

TEST(LogReaderGoneTest, SighupDrains) {
  ChildTactusd server;
  ASSERT_NE(server.port(), 0);
  ExpectDrain(server, SIGHUP);
}

}  // namespace
}  // namespace tactus::internal
