#include <algorithm>

#include "core/base/errors.h"
#include "core/data/trial_file.h"
#include "gtest/gtest.h"
#include "tests/core/data/trial_samples.h"

// The HDF5 library does not free everything after it refused a damaged file;
// where LeakSanitizer runs, only our own leaks count.
extern "C" const char* __lsan_default_suppressions() { return "leak:libhdf5"; }

namespace tactus::internal {
namespace {

constexpr int kFlips = 4000;

enum class Outcome { kSame, kError, kDifferent };

// What reading `bytes` gives, next to the trials that were written.
Outcome ReadBack(const std::string& path, const std::string& bytes,
                 const std::vector<Trial>& want) {
  WriteBytes(path, bytes);
  auto reader = TrialFileReader::Open(path);
  absl::Status status = reader.status();
  std::vector<Trial> got;
  if (status.ok()) {
    auto trials = reader->ReadAll();
    status = trials.status();
    if (status.ok()) got = *std::move(trials);
  }
  if (!status.ok()) {
    EXPECT_EQ(ReasonOf(status), "TRIAL_FILE_INVALID") << status;
    return Outcome::kError;
  }
  const bool same =
      std::equal(got.begin(), got.end(), want.begin(), want.end(), SameBits);
  return same ? Outcome::kSame : Outcome::kDifferent;
}

class TrialFileDamageTest : public testing::Test {
 protected:
  void SetUp() override {
    auto writer = TrialFileWriter::Create(dir_ / "good.h5", {});
    ASSERT_TRUE(writer.ok());
    for (int i = 0; i < 3; ++i) {
      trials_.push_back(FullTrial(i, 20, i == 1));
      trials_.back().id = "00000" + std::to_string(i);
      ASSERT_TRUE(writer->Append(trials_.back()).ok());
    }
    ASSERT_TRUE(writer->Close().ok());
    bytes_ = ReadBytes(dir_ / "good.h5");
  }

  const ScratchDir dir_;
  std::vector<Trial> trials_;
  std::string bytes_;
};

TEST_F(TrialFileDamageTest, NoFlippedBitIsReadAsSomethingElse) {
  Random random(20);
  int errors = 0;
  for (int i = 0; i < kFlips; ++i) {
    std::string damaged = bytes_;
    const size_t at = random.Index(damaged.size());
    damaged[at] ^= static_cast<char>(1 << random.Index(8));
    const Outcome outcome = ReadBack(dir_ / "bad.h5", damaged, trials_);
    ASSERT_NE(outcome, Outcome::kDifferent) << "byte " << at;
    errors += outcome == Outcome::kError ? 1 : 0;
  }
  // The rest are bytes that belong to nothing.
  EXPECT_GT(errors, kFlips / 2);
}

TEST_F(TrialFileDamageTest, EveryTruncationIsRefused) {
  for (size_t size = 0; size < bytes_.size(); size += 97) {
    ASSERT_EQ(ReadBack(dir_ / "bad.h5", bytes_.substr(0, size), trials_),
              Outcome::kError)
        << size;
  }
}

TEST_F(TrialFileDamageTest, OverwrittenRangesAreRefusedOrHarmless) {
  Random random(21);
  for (int i = 0; i < kFlips / 8; ++i) {
    std::string damaged = bytes_;
    const size_t at = random.Index(damaged.size());
    const size_t end = std::min(damaged.size(), at + 1 + random.Index(512));
    for (size_t j = at; j < end; ++j) {
      damaged[j] = static_cast<char>(i % 2 == 0 ? 0 : random.Index(256));
    }
    ASSERT_NE(ReadBack(dir_ / "bad.h5", damaged, trials_), Outcome::kDifferent)
        << at;
  }
}

}  // namespace
}  // namespace tactus::internal
