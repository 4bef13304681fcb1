#include "core/import/import.h"

#include <algorithm>
#include <clocale>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>

#include "core/base/errors.h"
#include "core/data/trial_file.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/data/trial_samples.h"
#include "tests/core/import/import_all.h"
#include "tests/support/shared_data.h"

namespace tactus::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Where recordings are, or empty. They are not part of the project.
std::string Recordings(const std::string& name) {
  const std::string folder = SharedDataPath(name);
  if (std::filesystem::exists(folder + "/index.csv")) return folder;
  std::printf("%s is absent: not imported\n", name.c_str());
  return "";
}

constexpr char kCsv[] =
    "# label=HU\n"
    "# stiffness = 1e5\n"
    "time,force,area,motion\n"
    "0,0.5,1e-4,0\n"
    "0.02,0.75,2e-4,-0.001\n"
    "0.04,1,3e-4,0.002\n";

TEST(ImportCsvTest, ReadsOneTrial) {
  const ScratchDir dir;
  WriteBytes(dir / "a.csv", kCsv);
  auto trials = ImportAll(dir / "a.csv");
  ASSERT_TRUE(trials.ok()) << trials.status();
  ASSERT_EQ(trials->size(), 1u);
  const Trial& trial = trials->front();
  EXPECT_EQ(trial.id, "000000");
  EXPECT_THAT(trial.time, ElementsAre(0, 0.02, 0.04));
  EXPECT_EQ(trial.signals[1], (FeatureVector{0.75, 2e-4, -0.001}));
  EXPECT_EQ(trial.label, "HU");
  EXPECT_EQ(trial.stiffness, 1e5);
  EXPECT_DOUBLE_EQ(trial.sample_rate_hz, 50);
}

TEST(ImportCsvTest, AFolderComesInTheOrderOfNames) {
  const ScratchDir dir;
  WriteBytes(dir / "b.csv", kCsv);
  WriteBytes(dir / "a.csv",
             "\xEF\xBB\xBF# label=SM\r\ntime,force,area,motion\r\n0,1,2,3\r\n");
  WriteBytes(dir / "readme.txt", "not a trial");
  auto trials = ImportAll(dir.path());
  ASSERT_TRUE(trials.ok()) << trials.status();
  ASSERT_EQ(trials->size(), 2u);
  EXPECT_EQ((*trials)[0].label, "SM");
  EXPECT_EQ((*trials)[1].label, "HU");
  EXPECT_EQ((*trials)[1].id, "000001");
}

TEST(ImportCsvTest, TheLocaleDoesNotMatter) {
  // Where the decimal sign is a comma, if this machine has such a locale.
  std::setlocale(LC_ALL, "de_DE.UTF-8");
  const ScratchDir dir;
  WriteBytes(dir / "a.csv", kCsv);
  auto trials = ImportAll(dir / "a.csv");
  std::setlocale(LC_ALL, "C");
  ASSERT_TRUE(trials.ok()) << trials.status();
  EXPECT_EQ(trials->front().time[1], 0.02);
}

TEST(ImportCsvTest, TrialsWithoutNamesGetThoseOfTheOptions) {
  const ScratchDir dir;
  WriteBytes(dir / "a.csv", kCsv);
  WriteBytes(dir / "b.csv", "time,force,area,motion\n0,1,2,3\n");
  const auto trials =
      ImportAll(dir.path(), {.label = "SM", .condition = "day 1"});
  ASSERT_TRUE(trials.ok()) << trials.status();
  EXPECT_EQ((*trials)[0].label, "HU");
  EXPECT_EQ((*trials)[1].label, "SM");
  EXPECT_EQ((*trials)[0].condition, "day 1");
  const auto bad = ImportAll(dir.path(), {.label = "two\nlines"});
  EXPECT_EQ(ReasonOf(bad.status()), "INVALID_CONFIG");
}

TEST(ImportCsvTest, TheSinksErrorStopsTheImport) {
  const ScratchDir dir;
  WriteBytes(dir / "a.csv", kCsv);
  WriteBytes(dir / "b.csv", kCsv);
  int calls = 0;
  auto count = ImportTrials(dir.path(), [&](const Trial&) {
    ++calls;
    return IoError("out.h5", "disk full");
  });
  EXPECT_EQ(ReasonOf(count.status()), "IO");
  EXPECT_EQ(calls, 1);
}

struct BadCsv {
  const char* text;
  const char* content;
};

class BadCsvTest : public ::testing::TestWithParam<BadCsv> {};

TEST_P(BadCsvTest, IsRefusedWithItsLine) {
  const ScratchDir dir;
  WriteBytes(dir / "a.csv", GetParam().content);
  auto trials = ImportAll(dir / "a.csv");
  EXPECT_EQ(ReasonOf(trials.status()), "TRIAL_FILE_INVALID");
  EXPECT_THAT(std::string(trials.status().message()), HasSubstr("a.csv: "));
  EXPECT_THAT(std::string(trials.status().message()),
              HasSubstr(GetParam().text));
}

INSTANTIATE_TEST_SUITE_P(
    All, BadCsvTest,
    ::testing::Values(
        BadCsv{"no header line", ""}, BadCsv{"no header line", "# a=b\n"},
        BadCsv{"line 1: # is followed by", "# hello\n"},
        BadCsv{"line 2: key \"label\" repeated", "# label=a\n# label=b\n"},
        BadCsv{"line 1: column name \"\" is empty", "time,,area,motion\n"},
        BadCsv{"line 1: column name \"time\"", "time,time\n"},
        BadCsv{"header \"time,area,force,motion\"",
               "time,area,force,motion\n0,1,2,3\n"},
        BadCsv{"header \"time,force\"", "time,force\n0,1\n"},
        BadCsv{"time: has 0 entries", "time,force,area,motion\n"},
        BadCsv{"line 3: has 3 cells",
               "time,force,area,motion\n0,1,2,3\n1,2,3\n"},
        BadCsv{"line 4: has 1 cells", "time,force,area,motion\n0,1,2,3\n\n1\n"},
        BadCsv{"line 2: has 5 cells", "time,force,area,motion\n0,1,2,3,4\n"},
        BadCsv{"line 2: force is \"1.5x\"",
               "time,force,area,motion\n0,1.5x,2,3\n"},
        BadCsv{"line 2: area is \"\"", "time,force,area,motion\n0,1,,3\n"},
        BadCsv{"line 2: force is \"nan\"",
               "time,force,area,motion\n0,nan,2,3\n"},
        BadCsv{"line 2: force is \"1e999\"",
               "time,force,area,motion\n0,1e999,2,3\n"},
        BadCsv{"line 2: has a quote that is not closed",
               "time,force,area,motion\n0,\"1,2,3\n"},
        BadCsv{"line 4: time must be above",
               "# label=a\ntime,force,area,motion\n0,1,2,3\n0,1,2,3\n"},
        BadCsv{"# colour is not known",
               "# colour=red\ntime,force,area,motion\n0,1,2,3\n"},
        BadCsv{"# stiffness is \"high\"",
               "# stiffness=high\ntime,force,area,motion\n0,1,2,3\n"},
        BadCsv{"unit: is \"psi\"",
               "# unit=psi\ntime,force,area,motion\n0,1,2,3\n"}));

TEST(ImportFolderTest, MissingPlacesAreErrors) {
  const ScratchDir dir;
  EXPECT_EQ(ReasonOf(ImportAll(dir / "absent").status()), "IO");
  EXPECT_EQ(ReasonOf(ImportAll(dir.path()).status()), "TRIAL_FILE_INVALID");
}

// Runs the recipe of examples/recordings for `folder`. False, with a word, if
// there is no Python with NumPy (python3-numpy).
bool RunRecipe(const std::string& name, const std::string& folder,
               const std::string& out) {
  const char* source = std::getenv("TACTUS_SOURCE_DIR");
  const std::string script = std::string(source != nullptr ? source : ".") +
                             "/examples/recordings/" + name + ".py";
  const std::string python = "/usr/bin/python3 ";
  if (std::system((python + "-c 'import numpy' 2>/dev/null").c_str()) != 0) {
    std::puts("numpy is absent (python3-numpy): not imported");
    return false;
  }
  return std::system((python + script + " " + folder + " " + out).c_str()) == 0;
}

TEST(RecordingsTest, VitacHasItsTrials) {
  const std::string folder = Recordings("vitac384");
  if (folder.empty()) return;
  const ScratchDir made;
  if (!RunRecipe("vitac384", folder, made.path())) return;
  auto trials = ImportAll(folder, {.skin = made / "skin.json"});
  ASSERT_TRUE(trials.ok()) << trials.status();
  EXPECT_EQ(trials->size(), 43u);
  std::map<std::string, int> labels;
  for (const Trial& trial : *trials) {
    ++labels[trial.label];
    EXPECT_EQ(trial.taxels.rows, 12);
    EXPECT_EQ(trial.taxels.columns, 32);
    EXPECT_EQ(trial.condition, "2026-02-16");
    EXPECT_LE(
        *std::max_element(trial.taxels.u16.begin(), trial.taxels.u16.end()),
        400);
  }
  // As counted in the recordings' index.
  const std::map<std::string, int> want = {
      {"HM", 14}, {"HU", 14}, {"SM", 8}, {"SU", 7}};
  EXPECT_EQ(labels, want);

  // And through a trial file.
  const ScratchDir dir;
  auto writer = TrialFileWriter::Create(dir / "vitac.h5", {});
  ASSERT_TRUE(writer.ok());
  for (const Trial& trial : *trials) ASSERT_TRUE(writer->Append(trial).ok());
  ASSERT_TRUE(writer->Close().ok());
  auto reader = TrialFileReader::Open(dir / "vitac.h5");
  ASSERT_TRUE(reader.ok());
  ASSERT_EQ(reader->size(), trials->size());
  for (size_t i = 0; i < trials->size(); ++i) {
    EXPECT_TRUE(SameBits(*reader->Read(i), (*trials)[i])) << i;
  }
}

TEST(RecordingsTest, IcubHasItsTrials) {
  const std::string folder = Recordings("icub_slide20");
  if (folder.empty()) return;
  const ScratchDir made;
  if (!RunRecipe("icub_slide20", folder, made.path())) return;
  auto trials = ImportAll(made.path());
  ASSERT_TRUE(trials.ok()) << trials.status();
  EXPECT_EQ(trials->size(), 680u);
  std::map<std::string, int> labels;
  for (const Trial& trial : *trials) {
    ++labels[trial.label];
    EXPECT_EQ(trial.time.size(), 75u);
    ASSERT_EQ(trial.taxels.rows, 6);
    ASSERT_EQ(trial.taxels.columns, 10);
    EXPECT_EQ(trial.layout, "icub-6x10");
    // A skin read 50 times a second changes little from frame to frame.
    double step = 0;
    const auto& values = trial.taxels.f32;
    for (size_t i = 60; i < values.size(); ++i) {
      step += std::abs(values[i] - values[i - 60]);
    }
    EXPECT_LT(step / values.size(), 1.5) << trial.id;
  }
  EXPECT_EQ(labels.size(), 20u);
  for (const auto& [label, count] : labels) EXPECT_EQ(count, 34) << label;
}

}  // namespace
}  // namespace tactus::internal
