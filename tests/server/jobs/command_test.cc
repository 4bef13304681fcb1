#include "server/jobs/command.h"

#include "core/base/errors.h"
#include "gtest/gtest.h"

namespace tactus::internal::server {
namespace {

constexpr std::chrono::seconds kPatience(20);

TEST(CommandTest, TakesStatusAndOutput) {
  const auto done =
      RunCommand({"sh", "-c", "echo out; echo err >&2; exit 3"}, kPatience);
  ASSERT_TRUE(done.ok()) << done.status();
  EXPECT_EQ(done->status, 3);
  EXPECT_EQ(done->output, "out\nerr\n");
  const auto killed = RunCommand({"sh", "-c", "kill -9 $$"}, kPatience);
  ASSERT_TRUE(killed.ok()) << killed.status();
  EXPECT_EQ(killed->status, -1);
}

TEST(CommandTest, BoundsOutputAndTime) {
  const auto loud = RunCommand(
      {"sh", "-c", "head -c 1000000 /dev/zero | tr '\\0' x"}, kPatience);
  ASSERT_TRUE(loud.ok()) << loud.status();
  EXPECT_EQ(loud->output, std::string(64 * 1024, 'x'));
  const auto slow =
      RunCommand({"sleep", "1000"}, std::chrono::milliseconds(50));
  ASSERT_TRUE(slow.ok()) << slow.status();
  EXPECT_TRUE(slow->late);
  EXPECT_FALSE(loud->late);
}

TEST(CommandTest, NamesAProgramThatIsNotThere) {
  const auto none = RunCommand({"no-such-program"}, kPatience);
  EXPECT_EQ(ReasonOf(none.status()), "IO");
  EXPECT_NE(none.status().message().find("no-such-program"), std::string::npos);
}

}  // namespace
}  // namespace tactus::internal::server
