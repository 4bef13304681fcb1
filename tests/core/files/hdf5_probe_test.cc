#include "core/files/hdf5_probe.h"

#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <thread>

#include "gtest/gtest.h"
#include "tests/support/process_ended.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal {
namespace {

// Waits for `condition`, for as long as a loaded machine may need.
template <typename Condition>
bool ComesTrue(Condition condition) {
  for (int i = 0; i < 5000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return false;
}

TEST(Hdf5ProbeTest, EndsWithTheProcessThatWaitsForIt) {
  const ScratchDir folder;
  WriteBytes(folder / "file", "x");
  const pid_t waiting = fork();
  if (waiting == 0) {
    const auto status = ProbeInChild(folder / "file", [&] {
      std::ofstream(folder / "draft") << getpid();
      std::filesystem::rename(folder / "draft", folder / "reader");
      while (true) pause();
      return absl::OkStatus();
    });
    _exit(status.ok() ? 0 : 1);
  }
  ASSERT_TRUE(
      ComesTrue([&] { return std::filesystem::exists(folder / "reader"); }));
  const pid_t reader = std::stoi(ReadBytes(folder / "reader"));
  EXPECT_NE(reader, waiting);
  EXPECT_FALSE(ProcessEnded(reader));
  kill(waiting, SIGKILL);
  waitpid(waiting, nullptr, 0);
  EXPECT_TRUE(ComesTrue([&] { return ProcessEnded(reader); }));
}

}  // namespace
}  // namespace tactus::internal
