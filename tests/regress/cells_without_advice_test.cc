// Tables that no reader can take were refused without a way out, or with advice
// that did not help, and points between thousands were taken for decimal signs.
#include <hdf5.h>

#include <algorithm>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/files/array_file.h"
#include "core/files/csv.h"
#include "core/files/hdf5_handle.h"
#include "core/files/npy_write.h"
#include "core/files/number_text.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/import/import_all.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::string TextFault(const std::string& text,
                      const NumberTextFormat& format = {}) {
  const auto table = ParseNumberText("a.csv", text, format);
  EXPECT_FALSE(table.ok()) << text;
  return std::string(table.status().message());
}

// A table of two columns whose line 3 has `cell`.
std::string FaultOfCell(const std::string& cell) {
  return TextFault(absl::StrCat("p;q\n1;2\n3;", cell, "\n"));
}

TEST(CellsWithoutAdviceTest, ACellThatIsNoNumberGetsAdviceThatFitsIt) {
  for (const char* cell : {"NaN", "nan", "-", "NA", "#N/A", "NULL", "inf"}) {
    EXPECT_THAT(FaultOfCell(cell),
                AllOf(HasSubstr("line 3: q is "), HasSubstr("leave out")));
  }
  for (const char* cell : {"1 234", "1'234", "1.234.567", "1.234,5",
                           "1\xC2\xA0"
                           "234"}) {
    EXPECT_THAT(FaultOfCell(cell),
                AllOf(HasSubstr("without signs between thousands"),
                      Not(HasSubstr("header_lines"))))
        << cell;
  }
  EXPECT_THAT(FaultOfCell("=A1"), HasSubstr("a formula"));
  for (const char* cell : {"1.5N", "20 ms", "1.500000D+02"}) {
    EXPECT_THAT(FaultOfCell(cell), HasSubstr("Write the number alone")) << cell;
  }
  EXPECT_THAT(FaultOfCell("2024-05-12T12:00:01"), HasSubstr("Dates"));
}

TEST(CellsWithoutAdviceTest, PointsBetweenThousandsAreNotGuessed) {
  const std::string text = "p;q\n1;1.068\n2;999\n3;12.345\n";
  EXPECT_THAT(TextFault(text), AllOf(HasSubstr("line 2: \"1.068\" may have"),
                                     HasSubstr("\"decimal\": \".\"")));
  // The advice works.
  const auto table = ParseNumberText("a.csv", text, {.decimal = '.'});
  ASSERT_TRUE(table.ok()) << table.status();
  EXPECT_EQ(table->numbers[1], 1.068);
  // Decimals of three places, with and without a header of numbers.
  for (const std::string header : {"", "0;1;2;3\n"}) {
    const auto decimals = ParseNumberText(
        "a.csv", header + "1;1.068;2;7.100\n2;3.400;2;9.100\n", {});
    ASSERT_TRUE(decimals.ok()) << decimals.status();
    EXPECT_THAT(decimals->found, HasSubstr("the decimal sign is a point"));
  }
}

TEST(CellsWithoutAdviceTest, ColumnsAndLinesThatDoNotFit) {
  // The last column has a name and no number.
  EXPECT_THAT(TextFault("p,q\n1,\n2,\n"), HasSubstr("line 2: q is \"\""));
  EXPECT_THAT(TextFault("p,q\n1,2\n3,4,\n"),
              AllOf(HasSubstr("line 3: has 3 cells"), Not(HasSubstr("cut"))));
  EXPECT_THAT(TextFault("p,q\n1,2\n3"), HasSubstr("cut off"));
  const std::string title = "Recording of May\np,q\n1,2\n3,4\n";
  EXPECT_THAT(TextFault(title), HasSubstr("\"header_lines\": 2"));
  EXPECT_TRUE(ParseNumberText("a.csv", title, {.header_lines = 2}).ok());
}

TEST(CellsWithoutAdviceTest, FilesThatAreNoTextAreNamed) {
  const std::pair<std::string, const char*> files[] = {
      {std::string("\x1F\x8B\x08\0abc", 7), "gunzip"},
      {std::string("PK\x03\x04\0\0", 6), "save the sheet as CSV"},
      {std::string("p\0,\0q\0\n\0", 8), "UTF-16"},
      {"\x89HDF\r\n", ".h5"}};
  for (const auto& [bytes, words] : files) {
    EXPECT_THAT(TextFault(bytes), HasSubstr(words));
    EXPECT_THAT(std::string(CsvTable::Parse("t.csv", bytes).status().message()),
                HasSubstr(words));
  }
  for (const auto& [name, words] :
       {std::pair("a.csv.gz", "unpack"), std::pair("a.xlsx", "save its sheet"),
        std::pair("a.pkl", "numpy.save")}) {
    EXPECT_THAT(std::string(ReadArrayFile(name, "", {}).status().message()),
                HasSubstr(words));
  }
}

class FolderTest : public ::testing::Test {
 protected:
  FolderTest() {
    Write("skin.json", R"({"name": "s", "rows": 1, "columns": 2,
      "row_pitch_m": 0.01, "column_pitch_m": 0.01, "unit": "counts",
      "contact_threshold": 20, "sample_rate_hz": 50})");
  }
  void Write(const std::string& name, const std::string& text) {
    WriteBytes(dir_ / name, text);
  }
  absl::StatusOr<std::vector<Trial>> Import() {
    remarks_.clear();
    ImportOptions options;
    options.remark = [&](const std::string& text) { remarks_ += text + "\n"; };
    return ImportAll(dir_.path(), options);
  }
  std::string Error() { return std::string(Import().status().message()); }

  const ScratchDir dir_;
  std::string remarks_;
};

TEST_F(FolderTest, LabelsThatAreMissingOrAlike) {
  Write("a.csv", "p,q\n1,2\n3,4\n");
  Write("b.csv", "p,q\n5,2\n3,4\n");
  Write("trials.csv", "frames,label\na.csv,nan\nb.csv,x\n");
  EXPECT_THAT(Error(), HasSubstr("line 2: label: is NaN"));
  Write("trials.csv", "frames,label\na.csv,1\nb.csv,1.0\n");
  EXPECT_TRUE(Import().ok());
  EXPECT_THAT(remarks_, HasSubstr("the labels \"1\" and \"1.0\" differ"));
}

TEST_F(FolderTest, ShapesThatDoNotFitGetTheirAdvice) {
  // Times without a name.
  Write("a.csv", "0,1,2\n0.02,3,4\n0.04,5,6\n");
  Write("trials.csv", "frames,label\na.csv,x\n");
  EXPECT_THAT(Error(), HasSubstr("\"time_column\": \"0\""));
  // Trials x frames x rows x columns.
  const std::vector<double> values(12, 30.0);
  Write("b.npy", NpyBytes({2, 3, 1, 2}, std::span<const double>(values)));
  Write("trials.csv", "frames,label\nb.npy,x\n");
  EXPECT_THAT(Error(), HasSubstr("FILE#0"));
  Write("trials.csv", "frames,label\nb.npy#0,x\nb.npy#1,x\n");
  const auto trials = Import();
  ASSERT_TRUE(trials.ok()) << trials.status();
  EXPECT_EQ((*trials)[1].time.size(), 3U);
}

TEST_F(FolderTest, CountersThatBeginAgainAreNoTaxels) {
  Write("trials.csv", "frames,label\na.csv,x\n");
  std::string counter = "p,q\n";
  std::string presses = "p,q\n";
  for (int i = 0; i < 600; ++i) {
    absl::StrAppend(&counter, (i + 250) % 256, ",", i * 7919 % 101, "\n");
    // Rises evenly, stays, and falls.
    absl::StrAppend(&presses, std::min(i % 40, 30), ",", i * 7919 % 101, "\n");
  }
  Write("a.csv", counter);
  EXPECT_THAT(Error(), HasSubstr("counters do: \"p\""));
  Write("a.csv", presses);
  EXPECT_TRUE(Import().ok()) << Error();
}

TEST_F(FolderTest, TheTimeIsNoTaxelAndAPauseIsNamed) {
  Write("trials.csv", "frames,label\na.csv,x\n");
  Write("a.csv", "time,p,q\n0,1,2\n0.02,3,4\n0.04,3,4\n4.04,5,6\n");
  EXPECT_THAT(Error(), HasSubstr("Frame 3 comes 4 s after the one before"));
  const std::string skin = ReadBytes(dir_ / "skin.json");
  Write("skin.json", absl::StrCat(skin.substr(0, skin.rfind('}')),
                                  R"(, "taxel_columns": ["time", "p"]})"));
  EXPECT_THAT(Error(), HasSubstr("name \"time\", which is the time"));
  Write("skin.json", absl::StrCat(skin.substr(0, skin.rfind('}')),
                                  R"(, "delimiter": "tab"})"));
  EXPECT_THAT(Error(), HasSubstr(R"(must be "," or ";" or "\t" or)"));
}

// What a dataset of `type` and shape gets as its error.
std::string FaultOfDataset(const std::string& path, hid_t type,
                           const std::vector<hsize_t>& shape) {
  {
    const Hdf5Handle file(
        H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT),
        H5Fclose);
    const Hdf5Handle space(
        shape.empty() ? H5Screate(H5S_SCALAR)
                      : H5Screate_simple(static_cast<int>(shape.size()),
                                         shape.data(), nullptr),
        H5Sclose);
    const Hdf5Handle dataset(H5Dcreate2(file.get(), "x", type, space.get(),
                                        H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                             H5Dclose);
    EXPECT_TRUE(dataset.ok());
  }
  const auto array = ReadArrayFile(path, "", {});
  EXPECT_FALSE(array.ok());
  return std::string(array.status().message());
}

TEST_F(FolderTest, DatasetsThatHoldNoFramesAreNamed) {
  const std::string path = dir_ / "a.h5";
  const Hdf5Handle text(H5Tcopy(H5T_C_S1), H5Tclose);
  const Hdf5Handle record(H5Tcreate(H5T_COMPOUND, 4), H5Tclose);
  H5Tinsert(record.get(), "p", 0, H5T_NATIVE_FLOAT);
  const Hdf5Handle list(H5Tvlen_create(H5T_NATIVE_FLOAT), H5Tclose);
  EXPECT_THAT(FaultOfDataset(path, text.get(), {3}), HasSubstr("holds text"));
  EXPECT_THAT(FaultOfDataset(path, record.get(), {3}),
              HasSubstr("holds records"));
  EXPECT_THAT(FaultOfDataset(path, H5T_STD_REF_OBJ, {1, 3}),
              HasSubstr("holds references, as cells"));
  EXPECT_THAT(FaultOfDataset(path, list.get(), {3}), HasSubstr("holds lists"));
  EXPECT_THAT(FaultOfDataset(path, H5T_NATIVE_FLOAT, {}),
              HasSubstr("has 0 axes; 1 to 4 are read"));
  EXPECT_THAT(FaultOfDataset(path, H5T_NATIVE_FLOAT, {0, 4}),
              HasSubstr("shape 0 x 4; its first axis, the frames, must have"));
}

TEST_F(FolderTest, RecordsOfNumPyAreNamed) {
  const std::string header =
      "{'descr': [('p', '<f4'), ('q', '<f4')], 'fortran_order': False, "
      "'shape': (1,), }\n";
  Write("a.npy", absl::StrCat(std::string("\x93NUMPY\x01\0", 8),
                              std::string(1, static_cast<char>(header.size())),
                              std::string(1, '\0'), header, "12345678"));
  Write("trials.csv", "frames,label\na.npy,x\n");
  EXPECT_THAT(Error(), HasSubstr("structured_to_unstructured"));
}

}  // namespace
}  // namespace tactus::internal
