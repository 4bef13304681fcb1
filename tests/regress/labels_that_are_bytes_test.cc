// "soft", "Soft" and "soft " were three classes without a word, and tables with
// semicolons or quotes were refused.
#include <string>

#include "absl/strings/str_cat.h"
#include "core/data/similar_names.h"
#include "core/import/file_names.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/data/trial_samples.h"
#include "tests/core/import/import_all.h"

namespace tactus::internal {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;

constexpr char kNoBreakSpace[] = "\xC2\xA0";
constexpr char kZeroWidth[] = "\xE2\x80\x8B";

TEST(SimilarNamesTest, BlanksAtTheEndsAreTakenAway) {
  for (const std::string& name :
       {std::string("soft"), std::string(" soft\t"),
        absl::StrCat(kNoBreakSpace, "soft", kZeroWidth),
        std::string("\xEF\xBB\xBFsoft")}) {
    EXPECT_EQ(TrimmedName(name), "soft");
  }
  EXPECT_EQ(TrimmedName(" a b "), "a b");
  EXPECT_EQ(TrimmedName(kNoBreakSpace), "");
}

TEST(SimilarNamesTest, NamesThatPeopleReadAlikeAreRemarkedUpon) {
  const std::vector<std::pair<std::string, std::string>> alike = {
      {"soft", "Soft"},
      {"a b", "a  b"},
      {"a b", absl::StrCat("a", kNoBreakSpace, "b")},
      {"soft", absl::StrCat("so", kZeroWidth, "ft")},
      // U+00E9, and an e with the accent U+0301.
      {"caf\xC3\xA9", "cafe\xCC\x81"},
      {"\xC3\x84ste", "\xC3\xA4ste"},
  };
  for (const auto& [one, other] : alike) {
    SimilarNames names("label");
    names.Add(one);
    names.Add(other);
    EXPECT_THAT(names.Remarks(), ElementsAre(HasSubstr("the labels ")))
        << one << " " << other;
  }
  SimilarNames names("label");
  for (const char* name : {"soft", "hard", "soft1", "soft-1", ""}) {
    names.Add(name);
    names.Add(name);
  }
  EXPECT_THAT(names.Remarks(), IsEmpty());
}

class LabelsTest : public ::testing::Test {
 protected:
  LabelsTest() {
    Write("skin.json", R"({"name": "s", "rows": 1, "columns": 2,
      "row_pitch_m": 0.01, "column_pitch_m": 0.01, "unit": "counts",
      "contact_threshold": 20, "sample_rate_hz": 50})");
    for (const char* name : {"a.csv", "cup_anna.csv", "jar_ben_2.csv"}) {
      Write(name, "5,1\n6,0\n");
    }
  }
  void Write(const std::string& name, const std::string& text) {
    WriteBytes(dir_ / name, text);
  }
  absl::StatusOr<std::vector<Trial>> Import(ImportOptions options = {}) {
    remarks_.clear();
    options.remark = [&](const std::string& text) { remarks_ += text + "\n"; };
    return ImportAll(dir_.path(), options);
  }

  const ScratchDir dir_;
  std::string remarks_;
};

TEST_F(LabelsTest, AreTrimmedAndComparedAtImport) {
  Write("trials.csv", "frames,label\na.csv,soft\na.csv, soft \na.csv,Soft\n");
  const auto trials = Import();
  ASSERT_TRUE(trials.ok()) << trials.status();
  EXPECT_EQ((*trials)[1].label, "soft");
  EXPECT_THAT(remarks_, HasSubstr("the labels \"Soft\" and \"soft\" differ"));
}

TEST_F(LabelsTest, TablesOfSpreadsheetsAreRead) {
  for (const std::string table :
       {"frames;label\na.csv;\"very; soft\"\n",
        "frames\tlabel\r\na.csv\tvery; soft\r\n\r\n",
        "\"frames\",\"label\",\n\"a.csv\",\"very; soft\",\n,,\n",
        ",frames,label\n0,a.csv,very; soft\n"}) {
    Write("trials.csv", table);
    const auto trials = Import();
    ASSERT_TRUE(trials.ok()) << trials.status() << table;
    EXPECT_EQ((*trials)[0].label, "very; soft") << table;
  }
}

TEST_F(LabelsTest, ComeFromTheNamesOfFiles) {
  ImportOptions options;
  options.file_names = "{label}_{group}.csv";
  Write("trials.csv", "frames\ncup_anna.csv\n");
  auto trials = Import(options);
  ASSERT_TRUE(trials.ok()) << trials.status();
  EXPECT_EQ((*trials)[0].label, "cup");
  EXPECT_EQ((*trials)[0].material, "anna");
  // Without a table, every file that fits; one fits in two ways.
  std::filesystem::remove(dir_ / "trials.csv");
  EXPECT_THAT(std::string(Import(options).status().message()),
              AllOf(HasSubstr("jar_ben_2.csv"), HasSubstr("several ways"),
                    HasSubstr("\"ben_2\" or \"2\"")));
  options.file_names = "(?<label>[a-z]+)_(?P<group>[a-z]+)(_\\d)?[.]csv";
  trials = Import(options);
  ASSERT_TRUE(trials.ok()) << trials.status();
  ASSERT_EQ(trials->size(), 2u);
  EXPECT_EQ((*trials)[1].label, "jar");
  EXPECT_EQ((*trials)[1].material, "ben");
  EXPECT_THAT(remarks_,
              AllOf(HasSubstr("1 files are left out"), HasSubstr("a.csv")));
}

TEST(FileNamePatternTest, NamesWhatIsWrong) {
  for (const char* text :
       {"", "{lable}.csv", "{label}_{label}.csv", "{label.csv", "(?<label>[a-z",
        "a.csv", "{}.csv", "(?<what>.*)"}) {
    EXPECT_FALSE(FileNamePattern::Parse(text).ok()) << text;
  }
  const auto pattern = FileNamePattern::Parse("{label}/{}_{condition}.npy");
  ASSERT_TRUE(pattern.ok()) << pattern.status();
  EXPECT_THAT(*pattern->Match("cup/7_slow.npy"),
              ElementsAre(Pair("condition", "slow"), Pair("label", "cup")));
  EXPECT_FALSE(pattern->Match("cup.npy").ok());
}

}  // namespace
}  // namespace tactus::internal
