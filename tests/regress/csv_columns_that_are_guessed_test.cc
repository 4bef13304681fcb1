// A column of times became a taxel, a first line 0,1,2,... became a frame, a
// first line of NaN disappeared, and other delimiters than commas were read as
// names.
#include <string>

#include "absl/strings/str_cat.h"
#include "core/files/number_text.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/data/trial_samples.h"
#include "tests/core/import/import_all.h"

namespace tactus::internal {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

NumberText Read(const std::string& text, const NumberTextFormat& format = {}) {
  auto table = ParseNumberText("a.csv", text, format);
  EXPECT_TRUE(table.ok()) << table.status() << " for\n" << text;
  return table.ok() ? *std::move(table) : NumberText();
}

std::string Fault(const std::string& text,
                  const NumberTextFormat& format = {}) {
  const auto table = ParseNumberText("a.csv", text, format);
  EXPECT_FALSE(table.ok()) << text;
  return std::string(table.status().message());
}

// The same four numbers, as programs of many kinds write them.
TEST(CsvColumnsThatAreGuessedTest, EveryWayToWriteATableIsRead) {
  for (const std::string text : {
           "5,2\n3,4.5\n",
           "5;2\n3;4.5\n",
           "5;2\n3;4,5\n",
           "5\t2\n3\t4.5\n",
           "5\t2\r\n3\t4,5\r\n",
           "5 2\n3 4.5\n",
           "  5   2\n  3   4.5  \n",
           "5|2\n3|4.5\n",
           "5, 2\n3, 4.5\n",
           "\xEF\xBB\xBF"
           "5,2\n3,4.5",
           "5,2\r3,4.5\r",
           "5,2\r\r\n3,4.5\r\r\n",
           "5,2\n\n3,4.5\n\n\n",
           "\"5\",\"2\"\n\"3\",\"4.5\"\n",
           "\"5\",\"2\"\n\"3\",\"4,5\"\n",
           "5,2,\n3,4.5,\n",
           "5;2;\n3;4,5;\n",
           "# a note\n5,2\n% one more\n3,4.5\n// end\n",
           "sep=;\n5;2\n3;4.5\n",
           "5.000e+00 2.000e+00\n3.000e+00 4.500e+00\n",
           "a,b\n5,2\n3,4.5\n",
           "a,b,\n5,2,\n3,4.5,\n",
           "a,b\n5,2,\n3,4.5,\n",
           ",a,b\n0,5,2\n1,3,4.5\n",
           ",0,1\n0,5,2\n1,3,4.5\n",
           "Unnamed: 0,a,b\n7,5,2\n8,3,4.5\n",
           "\"a\" \"b\"\n\"1\" 5 2\n\"2\" 3 4.5\n",
           "# a b\n5 2\n3 4.5\n",
       }) {
    const NumberText table = Read(text);
    EXPECT_THAT(table.numbers, ElementsAre(5, 2, 3, 4.5)) << text;
    EXPECT_EQ(table.columns, 2u) << text;
    EXPECT_NE(table.found, "") << text;
  }
}

TEST(CsvColumnsThatAreGuessedTest, NumbersInOrderAreAHeader) {
  for (const std::string header :
       {"0,1,2,3", "1,2,3,4", "\"0\",\"1\",\"2\",\"3\"", "0.0,1.0,2.0,3.0"}) {
    const NumberText table = Read(header + "\n5,5,5,5\n");
    EXPECT_THAT(table.numbers, ElementsAre(5, 5, 5, 5)) << header;
    EXPECT_THAT(table.found, HasSubstr("numbers in order, is a header"));
  }
  EXPECT_THAT(Read("time,0,1,2\n5,5,5,5\n").header,
              ElementsAre("time", "0", "1", "2"));
  // Frames are no headers, and what may be either is asked for.
  EXPECT_EQ(Read("2,3,4,5\n5,5,5,5\n").numbers.size(), 8u);
  EXPECT_EQ(Read("0,1,1,2\n5,5,5,5\n").numbers.size(), 8u);
  EXPECT_THAT(Fault("0,1\n5,5\n"), HasSubstr("\"header_lines\": 1 or 0"));
  EXPECT_EQ(Read("0,1\n5,5\n", {.header_lines = 0}).numbers.size(), 4u);
  EXPECT_EQ(Read("0,1,2,3\n5,5,5,5\n", {.header_lines = 0}).numbers.size(), 8u);
}

TEST(CsvColumnsThatAreGuessedTest, NoNumberIsAnErrorInEveryLine) {
  for (const std::string cell : {"NaN", "nan", "", "inf", "#VALUE!", "NA"}) {
    EXPECT_THAT(Fault(absl::StrCat("1,", cell, ",3\n1,2,3\n")),
                AllOf(HasSubstr("a.csv: line 1: cell 2 is "),
                      HasSubstr("must be a finite number")))
        << cell;
    EXPECT_THAT(Fault(absl::StrCat("a,b,c\n1,2,3\n1,", cell, ",3\n")),
                HasSubstr("a.csv: line 3: b is "))
        << cell;
  }
  EXPECT_THAT(Fault("NaN,NaN\n1,2\n"), HasSubstr("line 1: cell 1 is \"NaN\""));
}

TEST(CsvColumnsThatAreGuessedTest, WhatCannotBeKnownIsNamed) {
  EXPECT_THAT(Fault("1,234;5,678\n"), HasSubstr("\"decimal\": \",\""));
  EXPECT_THAT(Read("1,234;5,678\n", {.decimal = ','}).numbers,
              ElementsAre(1.234, 5.678));
  EXPECT_THAT(
      Fault("a,b\ns,N\n1,2\n"),
      AllOf(HasSubstr("line 2: a is \"s\""), HasSubstr("\"header_lines\": 2")));
  EXPECT_THAT(Read("a,b\ns,N\n1,2\n", {.header_lines = 2}).header,
              ElementsAre("a", "b"));
  EXPECT_THAT(Fault("a,b\n1,2\na,b\n3,4\n"),
              HasSubstr("line 3: repeats the header"));
  EXPECT_THAT(Fault("1,2\n3,4\n5"), HasSubstr("the file may be cut off"));
  EXPECT_THAT(Fault("a,b\n2024-01-02 10:00:00,2\n"),
              HasSubstr("Dates are not read"));
  EXPECT_THAT(Fault("1,x,4\n1,2,3\n"),
              HasSubstr("line 1: is neither a line of names nor"));
  EXPECT_THAT(Fault("a,,c\n1,2,3\n"), HasSubstr("column 2 has no name"));
  EXPECT_THAT(Fault(",a\n5,1\n3,2\n"), HasSubstr("column 1 has no name"));
  EXPECT_THAT(Fault("force\n1,5\n"), HasSubstr("line 2: has 2 cells"));
  EXPECT_THAT(Fault("\xFF\xFE"
                    "1\0"),
              HasSubstr("UTF-16"));
  EXPECT_THAT(Fault("1,\"2\n"), HasSubstr("quote"));
}

class GuessedColumnsTest : public ::testing::Test {
 protected:
  void Write(const std::string& name, const std::string& text) {
    WriteBytes(dir_ / name, text);
  }
  // A skin of three taxels, and two recordings.
  void Skin(const std::string& more) {
    Write("skin.json", absl::StrCat(R"({"name": "s", "rows": 1, "columns": 3,
      "row_pitch_m": 0.01, "column_pitch_m": 0.01, "unit": "counts",
      "contact_threshold": 20, "sample_rate_hz": 50, "time_scale_s": 0.001)",
                                    more, "}"));
  }
  // A header, and `rows` rows of which the first cell rises.
  static std::string Rows(const std::string& header, int rows, int step) {
    std::string text = header;
    for (int i = 0; i < rows; ++i) {
      absl::StrAppend(&text, 7'000'000 + i * step, ",", i % 3, ",", i % 2,
                      "\n");
    }
    return text;
  }
  std::string Error(const ImportOptions& options = {}) {
    return std::string(ImportAll(dir_.path(), options).status().message());
  }

  const ScratchDir dir_;
};

TEST_F(GuessedColumnsTest, AColumnOfTimesIsNoTaxel) {
  Skin("");
  Write("trials.csv", "frames,label\na.csv,x\nb.csv,y\n");
  for (const std::string header : {"timestamp, p, q\n", ""}) {
    Write("a.csv", Rows(header, 20, 20));
    Write("b.csv", Rows(header, 30, 20));
    EXPECT_THAT(Error(), AllOf(HasSubstr("\"time_column\""),
                               HasSubstr("\"taxel_columns\"")));
  }
  Write("a.csv", Rows("timestamp, p, q\n", 2, 20));
  EXPECT_THAT(Error(), HasSubstr("\"timestamp\" is named as times are"));
}

TEST_F(GuessedColumnsTest, ColumnsAreThoseThatTheSkinNames) {
  Write("trials.csv", "frames,label\na.csv,x\n");
  Write("a.csv", "stamp,p,q,r,s\n0,1,2,3,4\n20,5,6,7,8\n");
  for (const std::string names :
       {R"("time_column": "stamp", "taxel_columns": ["q", "r", "p"])",
        R"("time_column": 0, "taxel_columns": ["2..3", 1])",
        R"("time_column": "stamp", "taxel_columns": ["q..r", "p"])"}) {
    Skin(", " + names);
    const auto trials = ImportAll(dir_.path());
    ASSERT_TRUE(trials.ok()) << trials.status();
    EXPECT_THAT((*trials)[0].taxels.f32, ElementsAre(2, 3, 1, 6, 7, 5));
    EXPECT_THAT((*trials)[0].time, ElementsAre(0, 0.02));
  }
  Skin(R"(, "taxel_columns": ["q", "r", "z"])");
  EXPECT_THAT(Error(), HasSubstr("there is no column \"z\" but stamp, p"));
  Skin(R"(, "taxel_columns": ["q", "q", "r"])");
  EXPECT_THAT(Error(), HasSubstr("twice"));
}

// A file of a spreadsheet in a country with decimal commas.
TEST_F(GuessedColumnsTest, WhatWasFoundIsSaidOnceForAKindOfFile) {
  Skin("");
  Write("trials.csv", "frames,label\na.csv,x\nb.csv,y\n");
  Write("a.csv", "Time;p;q;r\n0;1,5;2;3\n20;4;5;6\n");
  Write("b.csv", "Time;p;q;r\n0;1,5;2;3\n20;4;5;6\n");
  std::vector<std::string> remarks;
  ImportOptions options;
  options.remark = [&](const std::string& text) { remarks.push_back(text); };
  ASSERT_TRUE(ImportAll(dir_.path(), options).ok());
  EXPECT_THAT(
      remarks,
      ElementsAre(
          AllOf(HasSubstr("a.csv and 1 like it"), HasSubstr("by semicolons"),
                HasSubstr("sign is a comma"), HasSubstr("the time is \"Time\""),
                HasSubstr("3 taxels are \"p\" to \"r\""))));
}

TEST_F(GuessedColumnsTest, ARisingTaxelIsRemarkedUpon) {
  Skin("");
  Write("trials.csv", "frames,label\na.csv,x\n");
  std::string rows = "p,q,r\n";
  for (int i = 0; i < 20; ++i) absl::StrAppend(&rows, i * i, ",1,2\n");
  Write("a.csv", rows);
  std::vector<std::string> remarks;
  ImportOptions options;
  options.remark = [&](const std::string& text) { remarks.push_back(text); };
  ASSERT_TRUE(ImportAll(dir_.path(), options).ok());
  EXPECT_THAT(remarks, Contains(AllOf(HasSubstr("rise from each frame"),
                                      HasSubstr("\"p\""))));
}

}  // namespace
}  // namespace tactus::internal
