// The name of the robot, as a server and a proxy see it.
#include <mutex>

#include "client/drivers/sim_driver.h"
#include "client/stream/channel.h"
#include "gtest/gtest.h"
#include "tests/support/scripted_server.h"
#include "tools/stream/live_player.h"
#include "tools/stream/trial_player.h"

namespace tactus::internal::client {
namespace {

TEST(PlayersTest, TheRobotHasAName) {
  std::mutex mutex;
  std::vector<std::string> ids;
  testing::ScriptedServer server([&](grpc::ServerContext* context,
                                     testing::ScriptedServer::Stream* stream) {
    const auto [begin, end] =
        context->client_metadata().equal_range("x-robot-id");
    v1::ClassifyContactRequest request;
    stream->Read(&request);
    const std::lock_guard lock(mutex);
    ids.push_back(request.config().client_id());
    for (auto id = begin; id != end; ++id) {
      ids.emplace_back(id->second.data(), id->second.size());
    }
    stream->Write(testing::GoodStarted());
    return grpc::Status::OK;
  });
  const auto channel = MakeChannel(server.address());
  SimDriver skin({.seed = 5}, 1, {});
  LivePlayer live(
      channel, &skin, {.client_id = "arm 7"}, [](const LiveContact&) {},
      [](const std::string&) {});
  live.Run().IgnoreError();
  SimDriver sim({.seed = 5}, 1, {});
  TrialPlayer trials(channel, &sim, {.client_id = "arm 8"},
                     [](const TrialResult&) {});
  trials.Run().IgnoreError();
  const std::lock_guard lock(mutex);
  EXPECT_EQ(ids,
            (std::vector<std::string>{"arm 7", "arm 7", "arm 8", "arm 8"}));
}

}  // namespace
}  // namespace tactus::internal::client
