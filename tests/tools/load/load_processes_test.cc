// A load test by several processes of the real program, against an in-process
// server.
#include "tools/load/load_processes.h"

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gtest/gtest.h"
#include "nlohmann/json.hpp"
#include "tests/server/support/test_server.h"

namespace tactus::internal::client {
namespace {

using testing::TestServer;

class LoadProcessesTest : public ::testing::Test {
 protected:
  LoadProcessesTest()
      : server_({.listen = {"127.0.0.1:0"}, .max_streams = 30}) {}

  std::vector<std::string> Flags() {
    return {absl::StrCat("--server=127.0.0.1:", server_.server().ports()[0]),
            "--seconds=0.3", "--warm-up=0", "--cadence=events",
            "--processes=2"};
  }

  TestServer server_;
};

TEST_F(LoadProcessesTest, AddWhatTheirRobotsCounted) {
  const auto processes = LoadProcesses::Start(TACTUS_LOAD, Flags(), 2);
  ASSERT_TRUE(processes.ok()) << processes.status();
  uint64_t frames = 0;
  // One process has a robot more; then one has none.
  for (const int robots : {5, 1}) {
    const auto report = (*processes)->Run(robots);
    ASSERT_TRUE(report.ok()) << report.status();
    EXPECT_EQ(report->robots, robots);
    EXPECT_EQ(report->streams, robots);
    EXPECT_EQ(report->lost(), 0u);
    EXPECT_EQ(report->failed, 0) << report->first_error;
    // 30 messages, less up to a tenth.
    EXPECT_GE(report->sent, robots * 27u);
    EXPECT_LE(report->sent, robots * 30u);
    frames += report->sent;
  }
  EXPECT_TRUE(testing::Eventually(
      [this] { return server_.server().gate().live() == 0; }));
  EXPECT_EQ(server_.server().gate().frames(), frames);
}

TEST_F(LoadProcessesTest, ThatEndAreAnError) {
  const auto gone = LoadProcesses::Start("/bin/false", {}, 2);
  ASSERT_TRUE(gone.ok()) << gone.status();
  EXPECT_FALSE((*gone)->Run(2).ok());
  const auto echo = LoadProcesses::Start("/bin/echo", {}, 1);
  ASSERT_TRUE(echo.ok()) << echo.status();
  EXPECT_FALSE((*echo)->Run(2).ok());
  EXPECT_FALSE(LoadProcesses::Start("/no/such/program", {}, 1).ok());
}

TEST_F(LoadProcessesTest, TheSearchPrintsWhatItFound) {
  std::string command = TACTUS_LOAD;
  for (const std::string& flag : Flags()) absl::StrAppend(&command, " ", flag);
  absl::StrAppend(&command,
                  " --find-max --json --p99-limit-ms=1000000 2>/dev/null");
  const std::unique_ptr<FILE, int (*)(FILE*)> output(
      popen(command.c_str(), "r"), pclose);
  ASSERT_NE(output, nullptr);
  std::string text;
  char bytes[4096];
  while (const size_t size = fread(bytes, 1, sizeof(bytes), output.get())) {
    text.append(bytes, size);
  }
  const auto json = nlohmann::json::parse(text, nullptr, false);
  ASSERT_TRUE(json.is_object()) << text;
  // It begins with 25; the server admits 30.
  EXPECT_GE(json["max_robots"], 25);
  EXPECT_LE(json["max_robots"], 30);
  EXPECT_EQ(json["robots"], json["max_robots"]);
  EXPECT_EQ(json["lost"], 0);
}

}  // namespace
}  // namespace tactus::internal::client
