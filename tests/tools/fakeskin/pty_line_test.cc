#include "tools/fakeskin/pty_line.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal::client {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

int OpenEnd(const std::string& path) {
  return open(path.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
}

// All that comes until nothing does for a moment.
std::string ReadAll(int file, int moment_ms = 200) {
  std::string all;
  pollfd poll = {.fd = file, .events = POLLIN, .revents = 0};
  while (::poll(&poll, 1, moment_ms) > 0) {
    char bytes[4096];
    const ssize_t count = read(file, bytes, sizeof bytes);
    if (count <= 0) break;
    all.append(bytes, static_cast<size_t>(count));
  }
  return all;
}

TEST(PtyLineTest, AllBytesPassAsTheyAre) {
  PtyLine line("");
  ASSERT_TRUE(line.Open().ok());
  EXPECT_THAT(line.path(), HasSubstr("/dev/pts/"));
  std::string sent;
  for (int i = 0; i < 512; ++i) sent.push_back(static_cast<char>(i));
  EXPECT_FALSE(line.IsListenedTo());
  line.Write("nobody is there");
  const int end = OpenEnd(line.path());
  ASSERT_GE(end, 0);
  EXPECT_TRUE(line.IsListenedTo());
  line.Write(sent);
  EXPECT_EQ(ReadAll(end), sent);
  close(end);
  EXPECT_FALSE(line.IsListenedTo());
  EXPECT_EQ(line.overruns(), 0u);
}

TEST(PtyLineTest, WhatNobodyReadsIsLostAndCounted) {
  PtyLine line("");
  ASSERT_TRUE(line.Open().ok());
  const int end = OpenEnd(line.path());
  const std::string message(1'000, 'a');
  constexpr size_t kMessages = 1'000;
  for (size_t i = 0; i < kMessages; ++i) line.Write(message);
  EXPECT_GT(line.overruns(), 0u);
  const std::string came = ReadAll(end);
  EXPECT_GE(came.size(), 1'000 * (kMessages - line.overruns()));
  EXPECT_LT(came.size(), 1'000 * kMessages);
  // And it goes on.
  line.Write("b");
  EXPECT_EQ(ReadAll(end), "b");
  close(end);
}

TEST(PtyLineTest, ALinkStaysWhileTerminalsChange) {
  const ScratchDir folder;
  const std::string path = folder / "skin";
  PtyLine line(path);
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(line.Open().ok());
    EXPECT_EQ(line.path(), path);
    const int end = OpenEnd(path);
    ASSERT_GE(end, 0);
    line.Write("x");
    EXPECT_EQ(ReadAll(end), "x");
    line.Close();
    EXPECT_FALSE(fs::is_symlink(path));
    EXPECT_FALSE(line.IsListenedTo());
    // As an adapter that was pulled out.
    pollfd poll = {.fd = end, .events = POLLIN, .revents = 0};
    EXPECT_EQ(::poll(&poll, 1, 10'000), 1);
    EXPECT_NE(poll.revents & POLLHUP, 0);
    close(end);
  }
}

TEST(PtyLineTest, OnlyALinkThatLeadsNowhereIsReplaced) {
  const ScratchDir folder;
  const std::string path = folder / "skin";
  fs::create_symlink("/dev/pts/no-such-terminal", path);
  PtyLine line(path);
  ASSERT_TRUE(line.Open().ok());
  PtyLine other(path);
  EXPECT_EQ(ReasonOf(other.Open()), "IO");
  EXPECT_TRUE(fs::exists(path));
  other.Close();
  EXPECT_TRUE(fs::exists(path));
  line.Close();
  WriteBytes(path, "a file of somebody");
  const absl::Status status = line.Open();
  EXPECT_THAT(std::string(status.message()), HasSubstr(path + ": exists"));
  EXPECT_TRUE(fs::is_regular_file(path));
  PtyLine nowhere(folder / "no/such/folder");
  EXPECT_EQ(ReasonOf(nowhere.Open()), "IO");
}

}  // namespace
}  // namespace tactus::internal::client
