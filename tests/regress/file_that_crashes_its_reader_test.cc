// The HDF5 library opened a foreign trial file in this process before the child
// process that should read it first, and the child had no limit on its memory.
#include <dlfcn.h>
#include <hdf5.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

#include "absl/base/config.h"
#include "absl/strings/match.h"
#include "core/base/errors.h"
#include "core/data/trial_file.h"
#include "core/files/hdf5_probe.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/data/trial_samples.h"

#if defined(ABSL_HAVE_ADDRESS_SANITIZER) || defined(ABSL_HAVE_THREAD_SANITIZER)
// A sanitizer reserves more address space than any RLIMIT_AS would allow.
constexpr bool kMemoryIsLimited = false;
#else
constexpr bool kMemoryIsLimited = true;
#endif

namespace {

int opened_here = 0;
const pid_t this_process = getpid();
constexpr size_t kTooMuch = 16UL * 1024 * 1024 * 1024;

}  // namespace

// Takes the place of the library's function in this program: it crashes or
// allocates too much memory on files of certain names.
extern "C" hid_t H5Fopen(const char* path, unsigned flags, hid_t access) {
  using Function = hid_t (*)(const char*, unsigned, hid_t);
  static const auto library =
      reinterpret_cast<Function>(dlsym(RTLD_NEXT, "H5Fopen"));
  if (getpid() == this_process) ++opened_here;
  if (absl::EndsWith(path, "crash.h5")) std::abort();
  if (absl::EndsWith(path, "huge.h5")) {
    void* memory = std::malloc(kTooMuch);
    // Keeps the compiler from leaving both calls out.
    asm volatile("" : : "g"(memory) : "memory");
    std::free(memory);
    if (memory == nullptr) return H5I_INVALID_HID;
  }
  return library(path, flags, access);
}

namespace tactus::internal {
namespace {

using ::testing::HasSubstr;

class FileThatCrashesItsReaderTest : public ::testing::Test {
 protected:
  // A good file of the given name.
  std::string File(const std::string& name) {
    auto writer = TrialFileWriter::Create(dir_ / name, {});
    EXPECT_TRUE(writer.ok());
    EXPECT_TRUE(writer->Append(FullTrial(1, 20)).ok());
    EXPECT_TRUE(writer->Close().ok());
    opened_here = 0;
    return dir_ / name;
  }

  const ScratchDir dir_;
};

TEST_F(FileThatCrashesItsReaderTest, IsRefusedAndNeverOpenedHere) {
  const absl::Status status = TrialFileReader::Open(File("crash.h5")).status();
  EXPECT_EQ(ReasonOf(status), "TRIAL_FILE_INVALID");
  EXPECT_THAT(std::string(status.message()), HasSubstr("crash.h5: is damaged"));
  EXPECT_EQ(opened_here, 0);
}

TEST_F(FileThatCrashesItsReaderTest, SoIsOneThatAllocatesAllMemory) {
  if (!kMemoryIsLimited)
    GTEST_SKIP() << "a limit of the address space stops sanitizers themselves";
  const std::string path = File("huge.h5");
  EXPECT_EQ(ReasonOf(TrialFileReader::Open(path).status()),
            "TRIAL_FILE_INVALID");
  EXPECT_EQ(opened_here, 0);
  const absl::Status status = ProbeInChild(path, [] {
    auto* memory = new char[kTooMuch];
    asm volatile("" : : "g"(memory) : "memory");
    delete[] memory;
    return absl::OkStatus();
  });
  EXPECT_EQ(ReasonOf(status), "TRIAL_FILE_INVALID");
  EXPECT_THAT(std::string(status.message()), HasSubstr("out of memory"));
}

TEST_F(FileThatCrashesItsReaderTest, WhatTheChildFindsIsReported) {
  const std::string path = File("good.h5");
  EXPECT_TRUE(ProbeInChild(path, [] { return absl::OkStatus(); }).ok());
  const absl::Status status = ProbeInChild(
      path, [&] { return TrialFileInvalid(path, std::string(9000, 'x')); });
  EXPECT_EQ(ReasonOf(status), "TRIAL_FILE_INVALID");
  EXPECT_THAT(std::string(status.message()), HasSubstr("good.h5: xxx"));
  EXPECT_LT(status.message().size(), 5000u);
}

TEST_F(FileThatCrashesItsReaderTest, PipesAndFoldersAreNotRead) {
  ASSERT_EQ(mkfifo((dir_ / "fifo.h5").c_str(), 0600), 0);
  for (const std::string& path : {dir_ / "fifo.h5", dir_.path()}) {
    EXPECT_EQ(ReasonOf(TrialFileReader::Open(path).status()),
              "TRIAL_FILE_INVALID")
        << path;
  }
  EXPECT_EQ(ReasonOf(TrialFileReader::Open(dir_ / "absent.h5").status()), "IO");
  EXPECT_EQ(opened_here, 0);
}

TEST_F(FileThatCrashesItsReaderTest, AGoodFileIsReadAsBefore) {
  const auto reader = TrialFileReader::Open(File("good.h5"));
  ASSERT_TRUE(reader.ok()) << reader.status();
  EXPECT_EQ(opened_here, 1);
  EXPECT_EQ(reader->size(), 1u);
  EXPECT_TRUE(reader->Read(0).ok());
}

}  // namespace
}  // namespace tactus::internal
