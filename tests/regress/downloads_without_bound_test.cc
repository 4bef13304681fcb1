// A download kept all that is known of a version's trials for as long as its
// client took to read them: up to a gigabyte for each call of a trainer.
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/regress/dataset_server.h"

namespace tactus::internal {
namespace {

using ::testing::HasSubstr;

TEST(DownloadsWithoutBoundTest, ShareMemoryAndSayWhenItIsUsedUp) {
  testing::DatasetServer server;
  ASSERT_EQ(server.Run({"datasets", "create", "arm"}).exit, 0);
  ASSERT_EQ(server
                .Run({"datasets", "upload", "arm",
                      "--data=" + server.Write("a.h5", 0, 6)})
                .exit,
            0);
  server::MemoryBudget& downloads = server.server().backend().downloads();
  int64_t taken = 0;
  for (int64_t part = limits::kMaxDownloadBytes; part > 0; part /= 2) {
    while (downloads.TryTake(part)) taken += part;
  }
  const auto refused = server.Run(
      {"datasets", "download", "arm", "--out=" + server.Path("b.h5")});
  EXPECT_NE(refused.exit, 0);
  EXPECT_THAT(refused.err, HasSubstr("wait until one has ended"));

  downloads.Return(taken);
  EXPECT_EQ(
      server
          .Run({"datasets", "download", "arm", "--out=" + server.Path("c.h5")})
          .exit,
      0);
  EXPECT_EQ(server.Read("c.h5").size(), 6u);
  // Nothing is left of the download that has ended.
  EXPECT_TRUE(downloads.TryTake(taken));
  downloads.Return(taken);
}

}  // namespace
}  // namespace tactus::internal
