#include "tools/console/child_program.h"

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/server/support/test_server.h"
#include "tests/support/process_ended.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal::console {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class ChildProgramTest : public ::testing::Test {
 protected:
  // What a script of the shell does.
  ChildEnd Run(const std::string& script) {
    options_.program = "/bin/sh";
    options_.arguments = {"-c", script};
    options_.folder = folder_.path();
    const auto end = RunChild(options_, cancelled_);
    EXPECT_TRUE(end.ok()) << end.status();
    return end.ok() ? *end : ChildEnd();
  }

  const ScratchDir folder_;
  ChildOptions options_;
  std::atomic<bool> cancelled_ = false;
};

TEST_F(ChildProgramTest, KeepsWhatItSays) {
  options_.input = "secret";
  const ChildEnd end = Run("cat; echo bad >&2; pwd > here; exit 3");
  EXPECT_EQ(end.status, 3);
  EXPECT_EQ(end.signal, 0);
  EXPECT_EQ(end.out, "secret");
  EXPECT_EQ(end.err, "bad\n");
  EXPECT_EQ(ReadBytes(folder_ / "here"), folder_.path() + "\n");
}

TEST_F(ChildProgramTest, TheInputMayBeReadByName) {
  options_.input = "secret";
  EXPECT_EQ(Run("cat /proc/self/fd/0 /proc/self/fd/0").out, "secretsecret");
}

TEST_F(ChildProgramTest, KeepsNoMoreThanItMay) {
  options_.text_bytes = 100'000;
  const ChildEnd end = Run("head -c 5000000 /dev/zero; echo done >&2");
  EXPECT_EQ(end.out.size(), options_.text_bytes);
  EXPECT_EQ(end.err, "done\n");
}

TEST_F(ChildProgramTest, FlagsOfThisProgramAreNotThoseOfTheOther) {
  setenv("TACTUS_TOKEN_FILE", "/etc/admin.token", 1);
  setenv("OTHER_VARIABLE", "stays", 1);
  const std::string variables = Run("env").out;
  unsetenv("TACTUS_TOKEN_FILE");
  EXPECT_THAT(variables, Not(HasSubstr("TACTUS")));
  EXPECT_THAT(variables, HasSubstr("OTHER_VARIABLE=stays"));
}

TEST_F(ChildProgramTest, HasNoFileOfThisProcess) {
  WriteBytes(folder_ / "own", "x");
  const std::ifstream open(folder_ / "own");
  EXPECT_THAT(Run("ls -l /proc/self/fd").out, Not(HasSubstr("own")));
}

TEST_F(ChildProgramTest, ASignalIsTold) {
  const ChildEnd end = Run("kill -SEGV $$");
  EXPECT_EQ(end.status, -1);
  EXPECT_EQ(end.signal, SIGSEGV);
}

TEST_F(ChildProgramTest, WritesNoLargerFile) {
  options_.file_bytes = 10'000;
  const ChildEnd end = Run("exec head -c 20000 /dev/zero > large");
  EXPECT_EQ(end.signal, SIGXFSZ);
  EXPECT_EQ(std::filesystem::file_size(folder_ / "large"), 10'000u);
}

TEST_F(ChildProgramTest, HasNoMoreMemory) {
  options_.memory_bytes = 200L * 1024 * 1024;
  EXPECT_EQ(Run("ulimit -v").out, "204800\n");
  // It keeps all that it reads.
  const ChildEnd end =
      Run("head -c 400000000 /dev/zero | tail -c 300000000 | wc -c");
  EXPECT_EQ(end.out, "0\n");
  EXPECT_THAT(end.err, HasSubstr("memory"));
}

TEST_F(ChildProgramTest, EndsWithItsProcessesAfterItsPatience) {
  options_.patience = std::chrono::milliseconds(100);
  const ChildEnd end = Run("sleep 1000 & echo $! > other; sleep 1000");
  EXPECT_TRUE(end.took_too_long);
  EXPECT_FALSE(end.was_cancelled);
  const pid_t other = std::stoi(ReadBytes(folder_ / "other"));
  EXPECT_TRUE(testing::Eventually([&] { return ProcessEnded(other); }));
}

TEST_F(ChildProgramTest, EndsAlsoWhatItLeavesBehind) {
  const ChildEnd end = Run("sleep 1000 & echo $!");
  EXPECT_EQ(end.status, 0);
  const pid_t other = std::stoi(end.out);
  EXPECT_TRUE(testing::Eventually([&] { return ProcessEnded(other); }));
}

TEST_F(ChildProgramTest, CanBeCancelled) {
  std::thread other([&] {
    testing::Eventually(
        [&] { return std::filesystem::exists(folder_ / "begun"); });
    cancelled_ = true;
  });
  const ChildEnd end = Run("touch begun; sleep 1000");
  other.join();
  EXPECT_TRUE(end.was_cancelled);
  EXPECT_EQ(end.signal, SIGKILL);
}

TEST_F(ChildProgramTest, AProgramThatIsNotThereIsAnError) {
  options_.program = folder_ / "nothing";
  EXPECT_EQ(ReasonOf(RunChild(options_, cancelled_).status()), "IO");
}

}  // namespace
}  // namespace tactus::internal::console
