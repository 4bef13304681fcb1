// Who is at work on a catalogue, as a program sees it that is no server.
#include "core/postgres/live_replicas.h"

#include "gmock/gmock.h"
#include "tests/server/replicas/shared_catalog.h"

namespace tactus::internal::server {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

// A minute: those that live are seen long before.
constexpr std::chrono::milliseconds kLongPatience(60'000);

class LiveReplicasTest : public SharedCatalogTest {
 protected:
  std::vector<std::string> Live(std::chrono::milliseconds patience) {
    auto live = LiveReplicas(*catalog_, patience);
    EXPECT_TRUE(live.ok()) << live.status();
    return *std::move(live);
  }
};

TEST_F(LiveReplicasTest, NoneAreRegistered) {
  EXPECT_THAT(Live(kLongPatience), IsEmpty());
  // One that ended as it should leaves nothing.
  { const auto replica = Join(); }
  EXPECT_THAT(Live(kLongPatience), IsEmpty());
}

TEST_F(LiveReplicasTest, ThoseThatLiveAreNamed) {
  const auto server = Join("here:1");
  const auto worker = Join("");
  EXPECT_THAT(Live(kLongPatience),
              UnorderedElementsAre(server->name() + " (, here:1)",
                                   worker->name() + " (, a worker)"));
}

TEST_F(LiveReplicasTest, OneThatWasKilledIsNoneOfThem) {
  const auto killed = Join("here:1");
  killed->Stop();
  const auto live = Join("here:2");
  EXPECT_THAT(Live(kLongPatience), ElementsAre(live->name() + " (, here:2)"));
  live->Stop();
  EXPECT_THAT(Live(std::chrono::milliseconds(500)), IsEmpty());
}

}  // namespace
}  // namespace tactus::internal::server
