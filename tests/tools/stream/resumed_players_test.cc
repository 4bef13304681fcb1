// The players of tactus-stream, whose server is killed and comes back.
#include <map>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include "client/drivers/sim_driver.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/stream/restarted_server.h"
#include "tools/stream/live_player.h"
#include "tools/stream/trial_player.h"

namespace tactus::internal::client {
namespace {

using std::chrono::milliseconds;
using ::testing::Contains;
using ::testing::HasSubstr;
using testing::RestartedServer;

using Result = std::tuple<std::string, std::vector<double>, std::vector<double>,
                          std::optional<int>, double>;

// Plays simulated trials; kills the server between the first two, and again
// somewhere in the trials after them.
std::vector<Result> TrialResults(bool kill, uint64_t* resumed) {
  RestartedServer server;
  std::vector<Result> results;
  std::thread killer;
  SimDriver driver({.seed = 3}, /*trials=*/6, {});
  TrialPlayer player(MakeChannel(server.address()), &driver,
                     {.resume_for = milliseconds(30'000)},
                     [&](const TrialResult& result) {
                       results.emplace_back(
                           result.id, result.probability, result.log_likelihood,
                           result.decision, result.decision_ms);
                       if (!kill || results.size() > 1) return;
                       server.Restart();
                       killer = std::thread([&server] {
                         std::this_thread::sleep_for(milliseconds(150));
                         server.Restart();
                       });
                     });
  const absl::Status status = player.Run();
  if (killer.joinable()) killer.join();
  EXPECT_TRUE(status.ok()) << status;
  EXPECT_EQ(player.totals().lost, 0u);
  *resumed = player.totals().resumed;
  return results;
}

TEST(ResumedPlayersTest, TrialsAreClassifiedAsWithoutALoss) {
  uint64_t resumed = 0;
  const auto want = TrialResults(false, &resumed);
  EXPECT_EQ(resumed, 0u);
  EXPECT_EQ(want.size(), 6u);
  EXPECT_EQ(TrialResults(true, &resumed), want);
  EXPECT_GE(resumed, 1u);
}

// Restarts a server before some of its frames.
class KillingDriver : public SkinDriver {
 public:
  KillingDriver(RestartedServer* server, std::vector<int> at)
      : server_(server), at_(std::move(at)) {}

 protected:
  absl::StatusOr<SkinInfo> OnConfigure() override { return sim_.Configure(); }
  absl::Status OnActivate() override { return sim_.Activate(); }
  absl::StatusOr<ReadResult> OnRead(SkinFrame& frame) override {
    if (std::find(at_.begin(), at_.end(), ++reads_) != at_.end()) {
      server_->Restart();
    }
    // Faster than real time, and slower than the frames that have waited.
    std::this_thread::sleep_for(milliseconds(3));
    return sim_.Read(frame);
  }
  absl::Status OnFinalise() override { return sim_.Finalise(); }

 private:
  RestartedServer* const server_;
  const std::vector<int> at_;
  SimDriver sim_{{.seed = 4}, /*trials=*/1, {}};
  int reads_ = 0;
};

using Contact = std::tuple<uint64_t, int64_t, double, int, double, double,
                           std::vector<double>, std::optional<int>, double>;

std::vector<Contact> LiveContacts(std::vector<int> kills,
                                  std::vector<std::string>* news) {
  RestartedServer server;
  KillingDriver driver(&server, std::move(kills));
  std::vector<Contact> contacts;
  LivePlayer player(
      MakeChannel(server.address()), &driver,
      {.resume_for = milliseconds(30'000)},
      [&](const LiveContact& c) {
        contacts.emplace_back(c.id, c.onset_ns, c.duration_s, c.answer,
                              c.probability, c.unknown, c.log_likelihood,
                              c.decision, c.decision_ms);
      },
      [&](const std::string& text) { news->push_back(text); });
  const absl::Status status = player.Run();
  EXPECT_TRUE(status.ok()) << status;
  return contacts;
}

TEST(ResumedPlayersTest, ALiveSkinGoesOn) {
  std::vector<std::string> news;
  const auto want = LiveContacts({}, &news);
  EXPECT_FALSE(want.empty());
  EXPECT_THAT(news, Not(Contains(HasSubstr("lost"))));
  EXPECT_EQ(LiveContacts({100, 450}, &news), want);
  EXPECT_THAT(news, Contains(HasSubstr("the stream is lost")));
}

}  // namespace
}  // namespace tactus::internal::client
