// trainctl jobs show, against a server that has the jobs.
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/training/fake_training_server.h"
#include "tests/support/scratch_dir.h"
#include "tests/tools/trainctl/remote/trainctl_program.h"

namespace tactus::internal::client {
namespace {

using testing::FakeTrainingServer;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::Trainctl;

TEST(JobsShowTest, NamesTheIdOfTheRequest) {
  const ScratchDir folder;
  const std::string address = "unix:" + (folder / "s");
  FakeTrainingServer server(address);
  v1::Operation job;
  job.set_name("operations/1");
  server.SetOperation(job);
  job.set_name("operations/2");
  job.set_request_id("nightly-17\x1b[2J");
  server.SetOperation(job);
  const auto show = [&](const std::string& name) {
    return Trainctl({"jobs", "show", name, "--server=" + address}).out;
  };
  EXPECT_THAT(show("1"), Not(HasSubstr("request id")));
  // Nothing that a terminal could take as a command.
  EXPECT_THAT(
      show("2"),
      HasSubstr("request id, as in the server's log: nightly-17?[2J\n"));
}

}  // namespace
}  // namespace tactus::internal::client
