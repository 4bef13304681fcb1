#include "core/data/trial_file.h"

#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>

#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/data/trial_samples.h"

namespace tactus::internal {
namespace {

using testing::HasSubstr;

absl::Status WriteFile(const std::string& path,
                       const std::vector<Trial>& trials) {
  auto writer = TrialFileWriter::Create(path, {});
  if (!writer.ok()) return writer.status();
  for (const Trial& trial : trials) {
    if (auto status = writer->Append(trial); !status.ok()) return status;
  }
  return writer->Close();
}

TEST(TrialFileTest, EveryFieldComesBackBitForBit) {
  const ScratchDir dir;
  std::vector<Trial> trials = {FullTrial(1, 500), FullTrial(2, 3, true),
                               FullTrial(3, 1), FullTrial(4, 40'000),
                               TrialOfTouches(5, 40)};
  trials[1].poses.clear();
  trials[1].object_motion.clear();
  trials[2].signals.clear();
  trials[2].label.clear();
  trials[3].taxels = TaxelSeries();
  trials[3].skin.reset();
  ASSERT_TRUE(WriteFile(dir / "a.h5", trials).ok());
  auto reader = TrialFileReader::Open(dir / "a.h5");
  ASSERT_TRUE(reader.ok()) << reader.status();
  ASSERT_EQ(reader->size(), trials.size());
  for (size_t i = 0; i < trials.size(); ++i) {
    auto trial = reader->Read(i);
    ASSERT_TRUE(trial.ok()) << trial.status();
    EXPECT_EQ(trial->id, "00000" + std::to_string(i));
    trials[i].id = trial->id;
    EXPECT_TRUE(SameBits(trials[i], *trial)) << i;
  }
}

// 64 touches have names that sort as they are numbered.
TEST(TrialFileTest, TouchesKeepTheirOrder) {
  const ScratchDir dir;
  Trial trial = TrialOfTouches(1, 200);
  const Touch touch = trial.touches[1];
  trial.touches.assign(64, touch);
  for (int i = 0; i < 64; ++i) {
    Touch& each = trial.touches[i];
    each.begin_s = each.end_s = trial.time[2 * i];
    each.label = i == 0 ? trial.label : "class " + std::to_string(i);
  }
  ASSERT_TRUE(WriteFile(dir / "a.h5", {trial}).ok());
  const auto back = TrialFileReader::Open(dir / "a.h5")->Read(0);
  ASSERT_TRUE(back.ok()) << back.status();
  EXPECT_TRUE(SameTouches(back->touches, trial.touches));
}

TEST(TrialFileTest, AFileWithoutTrialsIsValid) {
  const ScratchDir dir;
  ASSERT_TRUE(WriteFile(dir / "a.h5", {}).ok());
  auto reader = TrialFileReader::Open(dir / "a.h5");
  ASSERT_TRUE(reader.ok()) << reader.status();
  EXPECT_EQ(reader->size(), 0u);
  EXPECT_EQ(ReasonOf(reader->Read(0).status()), "TRIAL_FILE_INVALID");
}

TEST(TrialFileTest, IdsAreKeptAndMustDiffer) {
  const ScratchDir dir;
  auto writer = TrialFileWriter::Create(dir / "a.h5", {});
  ASSERT_TRUE(writer.ok());
  Trial trial = FullTrial(1, 2);
  trial.id = "000001";
  EXPECT_TRUE(writer->Append(trial).ok());
  EXPECT_EQ(ReasonOf(writer->Append(trial)), "TRIAL_FILE_INVALID");
  trial.id = "a/b";
  EXPECT_EQ(ReasonOf(writer->Append(trial)), "TRIAL_FILE_INVALID");
  trial.id = "..";
  EXPECT_EQ(ReasonOf(writer->Append(trial)), "TRIAL_FILE_INVALID");
  // The next free number, past the one that is taken.
  trial.id.clear();
  EXPECT_TRUE(writer->Append(trial).ok());
  ASSERT_TRUE(writer->Close().ok());
  auto reader = TrialFileReader::Open(dir / "a.h5");
  ASSERT_TRUE(reader.ok());
  ASSERT_EQ(reader->size(), 2u);
  EXPECT_EQ(reader->id(0), "000001");
  EXPECT_EQ(reader->id(1), "000002");
}

TEST(TrialFileTest, NothingIsSeenBeforeClose) {
  const ScratchDir dir;
  {
    auto writer = TrialFileWriter::Create(dir / "a.h5", {});
    ASSERT_TRUE(writer.ok());
    ASSERT_TRUE(writer->Append(FullTrial(1, 2)).ok());
    EXPECT_FALSE(std::filesystem::exists(dir / "a.h5"));
  }
  EXPECT_EQ(dir.files(), 0u) << "the temporary file must go";
}

TEST(TrialFileTest, AnExistingFileIsSafe) {
  const ScratchDir dir;
  ASSERT_TRUE(WriteFile(dir / "a.h5", {FullTrial(1, 2)}).ok());
  EXPECT_EQ(ReasonOf(WriteFile(dir / "a.h5", {})), "IO");
  // One that appears while we write is not overwritten either.
  auto late = TrialFileWriter::Create(dir / "b.h5", {});
  ASSERT_TRUE(late.ok());
  WriteBytes(dir / "b.h5", "mine");
  EXPECT_EQ(ReasonOf(late->Close()), "IO");
  EXPECT_EQ(ReadBytes(dir / "b.h5"), "mine");
  // With `overwrite`, the old file stays until the new one is complete.
  auto writer = TrialFileWriter::Create(dir / "a.h5", {.overwrite = true});
  ASSERT_TRUE(writer.ok());
  EXPECT_EQ(TrialFileReader::Open(dir / "a.h5")->size(), 1u);
  ASSERT_TRUE(writer->Close().ok());
  EXPECT_EQ(TrialFileReader::Open(dir / "a.h5")->size(), 0u);
  EXPECT_EQ(dir.files(), 2u);
}

TEST(TrialFileTest, ClosedWritersRefuse) {
  const ScratchDir dir;
  auto writer = TrialFileWriter::Create(dir / "a.h5", {});
  ASSERT_TRUE(writer.ok());
  ASSERT_TRUE(writer->Close().ok());
  EXPECT_EQ(ReasonOf(writer->Close()), "IO");
  EXPECT_EQ(ReasonOf(writer->Append(FullTrial(1, 2))), "IO");
}

TEST(TrialFileTest, ABadTrialDoesNotSpoilTheFile) {
  const ScratchDir dir;
  auto writer = TrialFileWriter::Create(dir / "a.h5", {});
  ASSERT_TRUE(writer.ok());
  Trial bad = FullTrial(1, 5);
  bad.time[2] = bad.time[1];
  EXPECT_EQ(ReasonOf(writer->Append(bad)), "TRIAL_FILE_INVALID");
  ASSERT_TRUE(writer->Append(FullTrial(1, 5)).ok());
  ASSERT_TRUE(writer->Close().ok());
  EXPECT_EQ(TrialFileReader::Open(dir / "a.h5")->size(), 1u);
}

TEST(TrialFileTest, UnwritableAndUnreadablePlacesAreErrors) {
  const ScratchDir dir;
  EXPECT_EQ(
      ReasonOf(TrialFileWriter::Create(dir / "no/such/dir.h5", {}).status()),
      "IO");
  const absl::Status absent = TrialFileReader::Open(dir / "absent.h5").status();
  EXPECT_EQ(ReasonOf(absent), "IO");
  EXPECT_NE(absent.message().find("No such file"), std::string::npos);
  EXPECT_EQ(ReasonOf(TrialFileReader::Open(dir.path()).status()),
            "TRIAL_FILE_INVALID");
}

// A child process with a small limit on file size stands in for a full disk.
TEST(TrialFileTest, AFullDiskIsAnErrorAndLeavesNothing) {
  const ScratchDir dir;
  const auto fill = [&] {
    signal(SIGXFSZ, SIG_IGN);
    const rlimit limit = {300'000, 300'000};
    setrlimit(RLIMIT_FSIZE, &limit);
    const absl::Status status =
        WriteFile(dir / "a.h5", std::vector<Trial>(20, FullTrial(1, 500)));
    const bool as_wished = ReasonOf(status) == "IO" && dir.files() == 0;
    std::_Exit(as_wished ? 0 : 1);
  };
  EXPECT_EXIT(fill(), testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace tactus::internal
