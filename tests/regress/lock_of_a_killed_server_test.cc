// A job's process shares all descriptors of tactusd until it reaches its own
// program. If tactusd was killed just then, the lock on the data directory
// lived on in that process, and the next tactusd was told that another process
// used the directory.
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "core/store/directory_lock.h"
#include "gtest/gtest.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal {
namespace {

TEST(RegressTest, AForkedChildDoesNotHoldTheLockOfItsParent) {
  const ScratchDir folder;
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t server = fork();
  if (server == 0) {
    const auto lock = DirectoryLock::Take(folder.path());
    if (!lock.ok()) _exit(1);
    const pid_t job = fork();
    if (job != 0 && write(ready[1], &job, sizeof job) != sizeof job) _exit(1);
    while (true) pause();
  }
  close(ready[1]);
  pid_t job = 0;
  ASSERT_EQ(read(ready[0], &job, sizeof job), sizeof job);
  EXPECT_FALSE(DirectoryLock::Take(folder.path()).ok());
  kill(server, SIGKILL);
  waitpid(server, nullptr, 0);
  const auto lock = DirectoryLock::Take(folder.path());
  EXPECT_TRUE(lock.ok()) << lock.status();
  kill(job, SIGKILL);
  close(ready[0]);
}

}  // namespace
}  // namespace tactus::internal
