// A CSV header of 100,000 columns took minutes: each name was looked up in all
// others. Lists that long are refused by their size.
#include <string>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/files/csv.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

using ::testing::HasSubstr;

absl::Status Parse(const std::string& text) {
  return CsvTable::Parse("a.csv", text).status();
}

std::string Header(size_t columns) {
  std::string header;
  for (size_t i = 0; i < columns; ++i) absl::StrAppend(&header, "c", i, ",");
  header.back() = '\n';
  return header;
}

TEST(CsvHeaderOfManyColumnsTest, IsRefused) {
  EXPECT_TRUE(Parse(Header(limits::kMaxCsvColumns)).ok());
  for (const size_t columns : {limits::kMaxCsvColumns + 1, size_t{100'000}}) {
    const absl::Status status = Parse(Header(columns));
    EXPECT_EQ(ReasonOf(status), "TRIAL_FILE_INVALID");
    EXPECT_THAT(std::string(status.message()),
                HasSubstr(absl::StrCat("line 1: has ", columns, " columns")));
  }
}

TEST(CsvHeaderOfManyColumnsTest, ARepeatedNameIsStillFound) {
  EXPECT_THAT(std::string(Parse("a,b,a\n").message()), HasSubstr("\"a\""));
}

TEST(CsvHeaderOfManyColumnsTest, SoAreManyLinesOfMetadata) {
  std::string text;
  for (size_t i = 0; i < limits::kMaxCsvMetadata; ++i) {
    absl::StrAppend(&text, "# k", i, "=1\n");
  }
  EXPECT_TRUE(Parse(text + "time\n").ok());
  const absl::Status status = Parse(text + "# one=more\ntime\n");
  EXPECT_EQ(ReasonOf(status), "TRIAL_FILE_INVALID");
  EXPECT_THAT(std::string(status.message()), HasSubstr("line 101"));
}

TEST(CsvHeaderOfManyColumnsTest, SoAreMoreCellsThanFitInMemory) {
  std::string text = "a\n";
  for (size_t i = 0; i <= limits::kMaxCsvCells; ++i) text += "1\n";
  EXPECT_EQ(ReasonOf(Parse(text)), "TRIAL_FILE_INVALID");
}

}  // namespace
}  // namespace tactus::internal
