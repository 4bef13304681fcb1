// Folders of recordings of any skin.
#include <algorithm>
#include <cstring>

#include "absl/strings/match.h"
#include "core/base/errors.h"
#include "core/data/trial_file.h"
#include "core/import/import_skin_folder.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/data/trial_samples.h"
#include "tests/core/import/import_all.h"

namespace tactus::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

template <typename Number>
std::string Npy(const std::string& type, const std::string& shape,
                const std::vector<Number>& values) {
  const std::string dictionary =
      "{'descr': '" + type + "', 'fortran_order': False, 'shape': " + shape +
      ", }\n";
  return std::string("\x93NUMPY\1\0", 8) +
         static_cast<char>(dictionary.size()) + '\0' + dictionary +
         std::string(reinterpret_cast<const char*>(values.data()),
                     values.size() * sizeof(Number));
}

std::string Floats(const std::vector<float>& values) {
  return Npy("<f4", "(" + std::to_string(values.size() / 4) + ", 4)", values);
}

// A skin of 2 x 2 taxels and two trials of three frames.
constexpr char kSkin[] = R"({
  "name": "mine", "rows": 2, "columns": 2,
  "row_pitch_m": 0.01, "column_pitch_m": 0.005,
  "unit": "counts", "contact_threshold": 2, "onset_threshold": 3,
  "sample_rate_hz": 50)";

class ImportSkinTest : public ::testing::Test {
 protected:
  ImportSkinTest() {
    Skin("");
    Write("trials.csv",
          "frames,label,condition,group\n"
          "a.npy,cork,monday,g1\n"
          "b.npy,felt,tuesday,g2\n");
    Write("a.npy", Floats({0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}));
    Write("b.npy", Floats({0, 0, 0, 0, 0.5F, 0, 0, 0, 0, 0, 0, 9}));
  }

  void Write(const std::string& name, const std::string& bytes) {
    WriteBytes(dir_ / name, bytes);
  }
  // The skin with more fields.
  void Skin(const std::string& more) {
    Write("skin.json", kSkin + (more.empty() ? "" : ", " + more) + "}");
  }
  Trial First() {
    auto trials = ImportAll(dir_.path());
    EXPECT_TRUE(trials.ok()) << trials.status();
    return trials.ok() ? trials->front() : Trial();
  }

  const ScratchDir dir_;
};

// Times of 20 ms and a bit. All trials get one rate, because a model has one.
TEST_F(ImportSkinTest, ARateThatIsNotStatedIsThatOfTheTimes) {
  std::string skin = kSkin;
  skin.resize(skin.rfind(','));
  Write("skin.json", skin + ", \"time_column\": \"t\"}");
  Write("trials.csv", "frames,label\na.csv,x\nb.csv,y\n");
  Write("a.csv", "t,a,b,c,d\n0.000,0,0,0,9\n0.0201,0,0,0,9\n0.0401,0,0,0,9\n");
  Write("b.csv", "t,a,b,c,d\n0.000,0,0,0,9\n0.0199,0,0,0,9\n0.0399,0,0,0,9\n");
  std::vector<std::string> remarks;
  const auto trials =
      ImportAll(dir_.path(),
                {.remark = [&](const auto& text) { remarks.push_back(text); }});
  ASSERT_TRUE(trials.ok()) << trials.status();
  // 2 / 0.0401 s is 49.875 Hz.
  EXPECT_NEAR(trials->at(0).sample_rate_hz, 49.9, 1e-9);
  EXPECT_EQ(trials->at(1).sample_rate_hz, trials->at(0).sample_rate_hz);
  EXPECT_THAT(remarks, ::testing::Contains(HasSubstr(
                           "sample_rate_hz is taken from the times of a.csv: "
                           "49.9 Hz for all trials")));
  // Frames without times.
  Write("skin.json", skin + "}");
  Write("trials.csv", "frames,label\na.npy,x\nb.npy,y\n");
  EXPECT_THAT(std::string(ImportAll(dir_.path()).status().message()),
              HasSubstr("is missing, and there are no times to tell it"));
}

TEST_F(ImportSkinTest, ReadsFramesLabelsAndTheSkin) {
  const auto trials = ImportAll(dir_.path());
  ASSERT_TRUE(trials.ok()) << trials.status();
  ASSERT_EQ(trials->size(), 2u);
  const Trial& trial = trials->back();
  EXPECT_EQ(trial.id, "000001");
  EXPECT_EQ(trial.label, "felt");
  EXPECT_EQ(trial.condition, "tuesday");
  EXPECT_EQ(trial.material, "g2");
  EXPECT_THAT(trial.time, ElementsAre(0, 0.02, 0.04));
  EXPECT_EQ(trial.taxels.f32,
            (std::vector<float>{0, 0, 0, 0, 0.5F, 0, 0, 0, 0, 0, 0, 9}));
  const SkinLayout want = {.name = "mine",
                           .rows = 2,
                           .columns = 2,
                           .row_pitch_m = 0.01,
                           .column_pitch_m = 0.005,
                           .taxel_area_m2 = 0.01 * 0.005,
                           .unit = TaxelUnit::kCounts,
                           .contact_threshold = 2,
                           .onset_threshold = 3};
  EXPECT_EQ(trial.skin, want);
  EXPECT_EQ(trial.layout, "mine");
  EXPECT_EQ(trial.unit, "counts");
}

// The skin file may be named instead of its folder, and may lie elsewhere.
TEST_F(ImportSkinTest, TheSkinAndTheTableMayBeNamed) {
  EXPECT_EQ(ImportAll(dir_ / "skin.json")->size(), 2u);
  std::filesystem::create_directory(dir_ / "else");
  std::filesystem::rename(dir_ / "skin.json", dir_ / "else/other.json");
  Write("else/one.csv", "frames,label\na.npy,cork\n");
  const auto trials = ImportAll(dir_.path(), {.skin = dir_ / "else/other.json",
                                              .table = dir_ / "else/one.csv"});
  ASSERT_TRUE(trials.ok()) << trials.status();
  EXPECT_EQ(trials->size(), 1u);
}

TEST_F(ImportSkinTest, ATableWithoutLabelsMayBeGivenOne) {
  Write("trials.csv", "frames\na.npy\nb.npy\n");
  EXPECT_EQ(ReasonOf(ImportAll(dir_.path()).status()), "TRIAL_FILE_INVALID");
  auto trials = ImportAll(dir_.path(), {.label = "cork"});
  ASSERT_TRUE(trials.ok()) << trials.status();
  EXPECT_EQ((*trials)[1].label, "cork");
  // Nor need the names of files have one.
  std::filesystem::remove(dir_ / "trials.csv");
  trials =
      ImportAll(dir_.path(), {.file_names = "{object}.npy", .label = "cork"});
  ASSERT_TRUE(trials.ok()) << trials.status();
  EXPECT_EQ((*trials)[1].label, "cork");
  EXPECT_EQ((*trials)[1].object, "b");
}

TEST_F(ImportSkinTest, ColumnsAreMadeOfOthers) {
  Skin(R"("table": "index.csv", "fields": {
    "frames": "{trial}.npy", "label": "{hard}-{moved}",
    "id": "t_{trial}", "condition": "all"})");
  Write("index.csv", "trial,hard,moved,label\na,H,M,x\n");
  const Trial trial = First();
  EXPECT_EQ(trial.id, "t_a");
  EXPECT_EQ(trial.label, "H-M");
  EXPECT_EQ(trial.condition, "all");
}

// Each kind of file gives the same frames.
TEST_F(ImportSkinTest, ReadsEveryFormat) {
  Write("trials.csv", "frames,label\na.csv,x\n");
  const std::vector<float> want = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
  Write("a.csv", "0,1,2,3\n4,5,6,7\n8,9,10,11\n");
  EXPECT_EQ(First().taxels.f32, want);
  Write("a.csv", "# note\nt0,t1,t2,t3\r\n0,1,2,3\r\n4,5,6,7\r\n8,9,10,11\r\n");
  EXPECT_EQ(First().taxels.f32, want);
  Write("trials.csv", "frames,label\na.npy,x\n");
  Write("a.npy", Npy<int8_t>("|i1", "(3, 2, 2)",
                             {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}));
  EXPECT_EQ(First().taxels.f32, want);
  Write("a.npy",
        Npy<double>("<f8", "(3, 4)", {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}));
  EXPECT_EQ(First().taxels.f32, want);
  Write("a.npy",
        Npy<uint16_t>("<u2", "(3, 4)", {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}));
  Skin(R"("scale": 0.5)");
  const Trial scaled = First();
  EXPECT_EQ(scaled.taxels.u16[11], 11);
  EXPECT_EQ(scaled.taxels.scale, 0.5);
}

// The taxels of a trial file are an HDF5 dataset like any other.
TEST_F(ImportSkinTest, ReadsADatasetOfAnHdf5File) {
  const Trial trial = First();
  auto writer = TrialFileWriter::Create(dir_ / "a.h5", {});
  ASSERT_TRUE(writer->Append(trial).ok());
  ASSERT_TRUE(writer->Close().ok());
  Write("trials.csv", "frames,label\na.h5:trials/000000/taxels,x\n");
  EXPECT_EQ(First().taxels.f32, trial.taxels.f32);
  Skin(R"("dataset": "/trials/000000/taxels")");
  Write("trials.csv", "frames,label\na.h5,x\n");
  EXPECT_EQ(First().taxels.f32, trial.taxels.f32);
}

// All trials in one array of trials x frames x rows x columns.
TEST_F(ImportSkinTest, ReadsPartsOfAnArrayOfManyTrials) {
  Write("all.npy", Npy<float>("<f4", "(3, 1, 2, 2)",
                              {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}));
  Write("trials.csv", "frames,label\nall.npy#2,x\nall.npy#0,y\n");
  const auto trials = ImportAll(dir_.path());
  ASSERT_TRUE(trials.ok()) << trials.status();
  EXPECT_EQ((*trials)[0].taxels.f32, (std::vector<float>{8, 9, 10, 11}));
  EXPECT_EQ((*trials)[1].taxels.f32, (std::vector<float>{0, 1, 2, 3}));
}

TEST_F(ImportSkinTest, TimesAndPosesComeFromColumnsOrFiles) {
  Write("trials.csv", "frames,label\na.csv,x\n");
  Skin(R"("time_scale_s": 0.001)");
  Write("a.csv",
        "time,x,y,z,qx,qy,qz,qw,t0,t1,t2,t3\n"
        "100,1,2,3,0,0,0,1,0,1,2,3\n"
        "120,1,2,4,0,0,1,0,4,5,6,7\n");
  Trial trial = First();
  EXPECT_THAT(trial.time, ElementsAre(0.1, 0.12));
  ASSERT_EQ(trial.poses.size(), 2u);
  EXPECT_EQ(trial.poses[1].position.z(), 4);
  EXPECT_EQ(trial.poses[1].orientation.z(), 1);
  EXPECT_EQ(trial.poses[0].orientation.w(), 1);
  EXPECT_EQ(trial.taxels.f32, (std::vector<float>{0, 1, 2, 3, 4, 5, 6, 7}));

  Write("trials.csv", "frames,label,time,pose\na.npy,x,time.csv,pose.npy\n");
  Write("time.csv", "0,1\n20,1\n41,1\n");
  Write("pose.npy",
        Npy<double>("<f8", "(3, 7)", {1, 0, 0, 0, 0, 0, 1, 2, 0, 0, 0,
                                      0, 0, 1, 3, 0, 0, 0, 0, 0, 1}));
  trial = First();
  EXPECT_THAT(trial.time, ElementsAre(0, 0.02, 0.041));
  EXPECT_EQ(trial.poses[2].position.x(), 3);
}

TEST_F(ImportSkinTest, SignedValuesAreWhatTheSkinFileSays) {
  Write("trials.csv", "frames,label\na.npy,x\n");
  Write("a.npy", Npy<int16_t>("<i2", "(2, 4)", {-4, 3, 0, -1, 8, -8, 2, 1}));
  Skin(R"("negative_values": "zero")");
  EXPECT_EQ(First().taxels.f32, (std::vector<float>{0, 3, 0, 0, 8, 0, 2, 1}));
  Skin(R"("negative_values": "absolute", "scale": 2)");
  EXPECT_EQ(First().taxels.f32, (std::vector<float>{8, 6, 0, 2, 16, 16, 4, 2}));
  Skin(R"("baseline": 8, "pressing": "lowers")");
  EXPECT_EQ(First().taxels.f32, (std::vector<float>{12, 5, 8, 9, 0, 16, 6, 7}));
  // Each taxel's mean over the first frame.
  Skin(R"("baseline": "from idle frames", "idle_frames": 1,
          "negative_values": "zero")");
  EXPECT_EQ(First().taxels.f32, (std::vector<float>{0, 0, 0, 0, 12, 0, 2, 2}));
}

TEST_F(ImportSkinTest, EventsBecomeFrames) {
  Write("trials.csv", "frames,label\ne.csv,x\n");
  // Microseconds; frames of 20 ms.
  Write("e.csv",
        "time,taxel,value\n1000000,0,1\n1019999,0,1\n1020000,3,1\n"
        "1045000,0,-1\n1045000,3,1\n");
  Skin(R"("events": "count", "time_scale_s": 1e-6)");
  Trial trial = First();
  EXPECT_THAT(trial.time, ElementsAre(1, 1.02, 1.04));
  EXPECT_EQ(trial.taxels.f32,
            (std::vector<float>{2, 0, 0, 0, 0, 0, 0, 1, 1, 0, 0, 1}));
  Skin(R"("events": "sum", "time_scale_s": 1e-6)");
  EXPECT_EQ(First().taxels.f32,
            (std::vector<float>{2, 0, 0, 0, 2, 0, 0, 1, 1, 0, 0, 2}));
  Skin(R"("events": "hold", "time_scale_s": 1e-6, "negative_values": "zero")");
  EXPECT_EQ(First().taxels.f32,
            (std::vector<float>{1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 1}));
  // Rows and columns instead of taxels.
  Write("e.csv", "0.0,1,0,5\n0.03,0,1,7\n");
  Skin(R"("events": "hold")");
  EXPECT_EQ(First().taxels.f32, (std::vector<float>{0, 0, 5, 0, 0, 7, 5, 0}));
}

TEST_F(ImportSkinTest, TaxelPositionsMakeAGrid) {
  // A plus sign; the corners have no taxel.
  Write("places.csv", "x,y\n0.01,0\n0,0.01\n0.01,0.01\n0.02,0.01\n0.01,0.02\n");
  Write("skin.json", R"({"name": "plus", "taxel_positions": "places.csv",
    "unit": "newton", "contact_threshold": 1, "sample_rate_hz": 100,
    "masked_taxels": [4]})");
  Write("trials.csv", "frames,label\na.csv,x\n");
  Write("a.csv", "1,2,3,4,6\n");
  const Trial trial = First();
  EXPECT_EQ(trial.taxels.rows, 3);
  EXPECT_EQ(trial.taxels.columns, 3);
  EXPECT_EQ(trial.taxels.f32, (std::vector<float>{0, 1, 0, 2, 3, 4, 0, 0, 0}));
  EXPECT_EQ(trial.skin->mask,
            (std::vector<uint8_t>{0, 1, 0, 1, 1, 1, 0, 0, 0}));
  EXPECT_NEAR(trial.skin->row_pitch_m, 0.01, 1e-12);
}

// 100 idle frames of 0, 1, 2 ... and a touch of 400: the percentile is 99 and
// the median 50, so the margin is 24.5.
TEST_F(ImportSkinTest, ThresholdsComeFromIdleFrames) {
  std::string frames;
  for (int t = 0; t < 100; ++t) {
    const std::string cell = std::to_string(t);
    frames += cell + "," + cell + "," + cell + "," + cell + "\n";
  }
  Write("a.csv", frames + "400,0,0,0\n");
  Write("trials.csv", "frames,label\na.csv,x\n");
  Write("skin.json", R"({"name": "mine", "rows": 2, "columns": 2,
    "row_pitch_m": 0.01, "column_pitch_m": 0.005, "unit": "counts",
    "sample_rate_hz": 50, "thresholds": "from idle frames",
    "idle_frames": 100})");
  const Trial trial = First();
  EXPECT_DOUBLE_EQ(trial.skin->contact_threshold, 99 + 24.5);
  EXPECT_DOUBLE_EQ(trial.skin->onset_threshold, 99 + 49);
}

// The thresholds have more digits than the six that people are shown, because
// frames are of single precision.
TEST_F(ImportSkinTest, TheThresholdsThatItTellsMakeTheSameSkin) {
  const std::string skin = R"({"name": "mine", "rows": 2, "columns": 2,
    "row_pitch_m": 0.01, "column_pitch_m": 0.005, "unit": "newton",
    "sample_rate_hz": 50, )";
  Write("a.csv",
        "0,0,0,0\n0.333333333,0.333333333,0.333333333,0\n"
        "4,0,0,0\n4,0,0,0\n");
  Write("trials.csv", "frames,label\na.csv,x\n");
  Write("skin.json",
        skin + R"("thresholds": "from idle frames", "idle_frames": 2})");
  std::vector<std::string> remarks;
  const auto trials =
      ImportAll(dir_.path(),
                {.remark = [&](const auto& text) { remarks.push_back(text); }});
  ASSERT_TRUE(trials.ok()) << trials.status();
  const std::string before = "instead of thresholds: ";
  const auto told = std::find_if(
      remarks.begin(), remarks.end(),
      [&](const auto& text) { return absl::StrContains(text, before); });
  ASSERT_NE(told, remarks.end());
  Write("skin.json",
        skin + told->substr(told->find(before) + before.size()) + "}");
  EXPECT_EQ(*First().skin, *trials->front().skin);
}

TEST_F(ImportSkinTest, ATrialFileGetsAnotherSkin) {
  const Trial trial = First();
  auto writer = TrialFileWriter::Create(dir_ / "a.h5", {});
  ASSERT_TRUE(writer->Append(trial).ok());
  ASSERT_TRUE(writer->Close().ok());
  Skin(R"("wrap_columns": true)");
  EXPECT_EQ((*ImportAll(dir_ / "a.h5"))[0].skin, trial.skin);
  const auto other = ImportAll(dir_ / "a.h5", {.skin = dir_ / "skin.json"});
  ASSERT_TRUE(other.ok()) << other.status();
  EXPECT_TRUE((*other)[0].skin->wrap_columns);
}

// One mistake in a good folder: the file to write, its text, and what the error
// says of file, line and field.
struct Mistake {
  const char* file;
  std::string text;
  const char* error;
};

class MistakeTest : public ImportSkinTest,
                    public ::testing::WithParamInterface<Mistake> {};

TEST_P(MistakeTest, IsNamedWithFileLineAndField) {
  Write(GetParam().file, GetParam().text);
  const absl::Status status = ImportAll(dir_.path()).status();
  EXPECT_EQ(ReasonOf(status), "TRIAL_FILE_INVALID") << status;
  EXPECT_THAT(std::string(status.message()), HasSubstr(GetParam().error));
}

Mistake InSkin(const std::string& more, const char* error) {
  return {"skin.json", kSkin + (", " + more + "}"), error};
}
Mistake InTable(const char* text, const char* error) {
  return {"trials.csv", text, error};
}
// A table whose second trial is wrong.
Mistake InRow(const std::string& header, const std::string& row,
              const char* error) {
  return {"trials.csv",
          "frames,label" + header + "\na.npy,cork" +
              std::string(std::count(header.begin(), header.end(), ','), ',') +
              "\n" + row + "\n",
          error};
}

INSTANTIATE_TEST_SUITE_P(
    Skin, MistakeTest,
    ::testing::Values(
        Mistake{"skin.json", "{", "skin.json: line 1: is no JSON"},
        Mistake{"skin.json", "[]", "skin.json: must be one JSON object"},
        Mistake{"skin.json", "{}", "name: is missing"},
        Mistake{"skin.json", R"({"name": "mine", "unit": "counts"})",
                "rows: is missing; give rows, columns and pitches"},
        Mistake{"skin.json",
                R"({"name": "mine", "rows": 2, "columns": 2,
                    "row_pitch_m": 0.01, "unit": "counts",
                    "contact_threshold": 1})",
                "skin.json: column_pitch_m: is missing"},
        Mistake{"skin.json",
                R"({"name": "mine", "rows": 2, "columns": 2,
                    "row_pitch_m": 0.01, "column_pitch_m": 0.01,
                    "contact_threshold": 1})",
                "skin.json: unit: is missing"},
        Mistake{"skin.json",
                R"({"name": "mine", "rows": 2, "columns": 2,
                    "row_pitch_m": 0.01, "column_pitch_m": 0.01,
                    "unit": "counts"})",
                "skin.json: contact_threshold: is missing"},
        Mistake{"skin.json",
                R"({"name": "mine", "rows": 65, "columns": 2,
                    "row_pitch_m": 0.01, "column_pitch_m": 0.01,
                    "unit": "counts", "contact_threshold": 1})",
                "skin.json: rows: is 65; it must be a whole number from 1 to "
                "64"},
        Mistake{"skin.json",
                R"({"name": "mine", "rows": 2, "columns": 2,
                    "row_pitch_m": 10, "column_pitch_m": 0.01,
                    "unit": "counts", "contact_threshold": 1})",
                "skin.json: row_pitch_m: is 10"},
        Mistake{
            "skin.json",
            R"({"name": "mine", "rows": 2, "columns": 2,
                    "row_pitch_m": 0.01, "column_pitch_m": 0.01,
                    "unit": "psi", "contact_threshold": 1})",
            "skin.json: unit: is \"psi\"; it must be \"newton\" or \"counts\""},
        InSkin(R"("colour": "red")", "skin.json: colour: is not known"),
        InSkin(R"("taxel_positions": "p.csv")",
               "taxel_positions: is given with a shape"),
        // Errors quote what is in a file: none of elsewhere is read.
        InSkin(
            R"("table": "/etc/passwd")",
            "skin.json: table: is \"/etc/passwd\"; it must be a file beside"),
        InSkin(R"("table": "more/../../x.csv")",
               "skin.json: table: is \"more/../../x.csv\"; it must be"),
        Mistake{"skin.json",
                R"({"name": "mine", "unit": "counts", "contact_threshold": 1,
                    "taxel_positions": "/etc/passwd"})",
                "skin.json: taxel_positions: is \"/etc/passwd\"; it must be"},
        InSkin(R"("masked_taxels": [4])",
               "masked_taxels: is 4; it must be a taxel from 0 to 3"),
        InSkin(R"("connectivity": 6)", "connectivity: is 6"),
        InSkin(R"("light_touch": 1)", "light_touch: is 1; it must be an obj"),
        InSkin(R"("light_touch": {"rows": 0})",
               "skin.json: light_touch.rows: is 0; it must be a whole number"),
        InSkin(R"("light_touch": {"size": 3})",
               "light_touch.size: is not known"),
        InSkin(R"("light_touch": {"rows": 2})", "light_touch.window_s"),
        InSkin(R"("thresholds": "from idle frames")",
               "thresholds: is given with contact_threshold"),
        InSkin(R"("baseline": "from idle frames")", "idle_frames: is missing"),
        InSkin(R"("scale": "half")", "scale: is \"half\""),
        InSkin(R"("negative_values": "keep")",
               "negative_values: is \"keep\"; it must be \"refused\" or "
               "\"zero\" or \"absolute\""),
        InSkin(R"("fields": {"material": 3})", "fields.material: is 3"),
        InSkin(R"("fields": {"colour": "{x}"})",
               "fields.colour: is no field of a trial; use frames, id"),
        InSkin(R"("fields": {"object": "{thing}"})",
               "skin.json: fields.object: there is no column \"thing\" in")));

INSTANTIATE_TEST_SUITE_P(
    Table, MistakeTest,
    ::testing::Values(
        InTable("frames,label\n", "trials.csv: names no trial"),
        InTable("files,label\na.npy,x\n",
                "trials.csv: has no column frames "
                "but files, label"),
        InTable("frames,lable\na.npy,x\n", "trials.csv: has no column label"),
        InTable("frames,label\na.npy\n", "trials.csv: line 2: has 1 cells"),
        InRow("", "b.npy,", "trials.csv: line 3: label: is empty"),
        InRow("", ",felt", "trials.csv: line 3: frames: is \"\""),
        InRow("", "../b.npy,felt",
              "line 3: frames: is \"../b.npy\"; it must "
              "be a file in"),
        InRow("", "/b.npy,felt", "line 3: frames: is \"/b.npy\""),
        InRow("", "c.npy,felt", "line 3: frames: "),
        InRow("", "b.parquet,felt", "b.parquet: is of no known format"),
        InTable("frames,label,id\na.npy,x,1\nb.npy,y,1\n",
                "trials.csv: line 3: id: \"1\" is repeated"),
        InTable("frames,label,id\na.npy,x,1\n\nb.npy,y,1\n",
                "trials.csv: line 4: id: \"1\" is repeated"),
        InTable("frames,label,id\na.npy,x,a/b\n",
                "trials.csv: line 2: id: is \"a/b\""),
        InTable("frames,label,stiffness\na.npy,x,high\n",
                "line 2: stiffness: is \"high\"; it must be a number"),
        InTable("frames,label,velocity\na.npy,x,-1\n",
                "line 2: velocity: is -1"),
        InTable("frames,label,sample_rate_hz\na.npy,x,0\n",
                "line 2: sample_rate_hz: is missing"),
        InTable("frames,label,group,material\na.npy,x,g,m\n",
                "line 2: group: is given with material"),
        InTable("frames,label,time\na.npy,x,t.csv\n", "line 2: time: "),
        InTable("frames,label,pose\na.npy,x,a.npy\n",
                "line 2: pose: a.npy: has shape 3 x 4; poses are frames x 7"),
        InTable("frames,label\na.npy:x,x\n", "line 2: frames: "),
        InTable("frames,label\na.npy#3,x\n",
                "line 2: frames: asks for part 3 of a.npy, which has 3 parts"),
        InTable("frames,label\na.npy#0,x\n",
                "line 2: frames: a.npy#0: has shape 4; it must be frames x 4"),
        InTable("frames,label\na.npy,\xff\n",
                "trials.csv: line 2: is not "
                "UTF-8")));

INSTANTIATE_TEST_SUITE_P(
    Frames, MistakeTest,
    ::testing::Values(
        Mistake{"b.npy", Npy<float>("<f4", "(1, 3)", {1, 2, 3}),
                "trials.csv: line 3: frames: b.npy: has shape 1 x 3; it must "
                "be frames x 4"},
        Mistake{"b.npy", Npy<float>("<f4", "(4,)", {1, 2, 3, 4}),
                "line 3: frames: b.npy: has shape 4; it must be"},
        Mistake{"b.npy", Npy<float>("<f4", "(0, 4)", {}),
                "line 3: frames: the file holds no frame"},
        Mistake{"b.npy", Floats({0, 1, 2, 3, 4, -5, 6, 7}),
                "line 3: frames: b.npy: taxel 1 of frame 1 is -5; it must be "
                "0 to 1e12. If values below zero are right, say in skin.json"},
        Mistake{"b.npy", Floats({0, 1, NAN, 3}),
                "line 3: frames: b.npy: taxel 2 of frame 0 is nan"},
        Mistake{"b.npy", "PK", "line 3: frames: "},
        Mistake{"b.npy", Npy<float>("<c8", "(1, 2)", {1, 2, 3, 4}),
                "b.npy: holds '<c8'"}));

// Mistakes of CSV files of frames.
class FrameCsvMistakeTest : public ImportSkinTest,
                            public ::testing::WithParamInterface<
                                std::pair<const char*, const char*>> {};

TEST_P(FrameCsvMistakeTest, IsNamedWithItsLine) {
  Write("trials.csv", "frames,label\nf.csv,x\n");
  Write("f.csv", GetParam().first);
  const absl::Status status = ImportAll(dir_.path()).status();
  EXPECT_EQ(ReasonOf(status), "TRIAL_FILE_INVALID") << status;
  EXPECT_THAT(std::string(status.message()), HasSubstr("trials.csv: line 2: "));
  EXPECT_THAT(std::string(status.message()), HasSubstr(GetParam().second));
}

INSTANTIATE_TEST_SUITE_P(
    All, FrameCsvMistakeTest,
    ::testing::Values(
        std::pair("", "frames: "), std::pair("a,b,c,d\n", "holds no numbers"),
        std::pair("0,1,2,3\n0,1,2\n", "f.csv: line 2: has 3 cells"),
        std::pair("a,b,c,d\n0,1,x,3\n", "f.csv: line 2: c is \"x\""),
        std::pair("0,1,2,3\n0,1,,3\n", "f.csv: line 2: cell 3 is \"\""),
        std::pair("0,1,2,3,5\n", "has shape 1 x 5"),
        std::pair("0,1,2,3,4\n", "holds no numbers"),
        std::pair("time,a,b,c,d\n0,0,0,0,0\n0,0,0,0,0\n",
                  "time: that of frame 1 is 0 s"),
        std::pair("time,a,b,c,d\n0,0,0,0,0\n1,0,0,0,0\n",
                  "sample_rate_hz: is 50, but the times are those of 1 "),
        std::pair("x,y,a,b,c,d\n0,0,0,0,0,0\n", "has 2 columns of a pose"),
        std::pair("y,x,a,b,c,d\n0,0,0,0,0,0\n", "column y is out of order")));

}  // namespace
}  // namespace tactus::internal
