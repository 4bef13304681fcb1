// Arrays of MATLAB came in transposed, because only the shape was looked at;
// Fortran order, big-endian numbers and float16 were refused; a filter that is
// not read was called a missing folder of plugins.
#include <hdf5.h>

#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/files/array_file.h"
#include "core/files/hdf5_handle.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/data/trial_samples.h"

namespace tactus::internal {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

std::vector<double> Numbers(const absl::StatusOr<ArrayFile>& file) {
  std::vector<double> numbers;
  EXPECT_TRUE(file.ok()) << file.status();
  for (size_t i = 0; file.ok() && i < file->size(); ++i) {
    numbers.push_back(file->Number(i));
  }
  return numbers;
}

class ArrayOrderTest : public ::testing::Test {
 protected:
  // Bytes of an array of shape 2 x 3 by numpy.lib.format.
  absl::StatusOr<ArrayFile> Npy(const std::string& type, const char* fortran,
                                const std::string& bytes) {
    const std::string header =
        absl::StrCat("{'descr': '", type, "', 'fortran_order': ", fortran,
                     ", 'shape': (2, 3), }\n");
    WriteBytes(dir_ / "a.npy", std::string("\x93NUMPY\1\0", 8) +
                                   static_cast<char>(header.size()) + '\0' +
                                   header + bytes);
    return ReadArrayFile(dir_ / "a.npy", "");
  }

  // A dataset of 2 x 2 numbers 0 to 3 as they lie in the file.
  void Dataset(const std::string& path, const char* name, bool matlab,
               H5Z_filter_t filter = 0) {
    const Hdf5Quiet quiet;
    const bool exists = std::filesystem::exists(path);
    const Hdf5Handle file(
        exists
            ? H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT)
            : H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT),
        H5Fclose);
    const hsize_t dims[] = {2, 2};
    const Hdf5Handle space(H5Screate_simple(2, dims, nullptr), H5Sclose);
    const Hdf5Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    const Hdf5Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
    H5Pset_create_intermediate_group(links.get(), 1);
    if (filter != 0) {
      H5Pset_chunk(properties.get(), 2, dims);
      H5Pset_filter(properties.get(), filter, H5Z_FLAG_OPTIONAL, 0, nullptr);
    }
    const Hdf5Handle dataset(
        H5Dcreate2(file.get(), name, H5T_NATIVE_DOUBLE, space.get(),
                   links.get(), properties.get(), H5P_DEFAULT),
        H5Dclose);
    ASSERT_TRUE(dataset.ok()) << Hdf5LastError();
    const double values[] = {0, 1, 2, 3};
    H5Dwrite(dataset.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT,
             values);
    if (!matlab) return;
    const Hdf5Handle text(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(text.get(), 6);
    const Hdf5Handle scalar(H5Screate(H5S_SCALAR), H5Sclose);
    const Hdf5Handle mark(H5Acreate2(dataset.get(), "MATLAB_class", text.get(),
                                     scalar.get(), H5P_DEFAULT, H5P_DEFAULT),
                          H5Aclose);
    H5Awrite(mark.get(), text.get(), "double");
  }

  std::string Error(const std::string& path, const std::string& dataset) {
    return std::string(ReadArrayFile(path, dataset).status().message());
  }

  const ScratchDir dir_;
};

TEST_F(ArrayOrderTest, NumpysOrdersAndTypesAreRead) {
  EXPECT_THAT(Numbers(Npy("|u1", "False", std::string("\1\2\3\4\5\6", 6))),
              ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_THAT(Numbers(Npy("|u1", "True", std::string("\1\4\2\5\3\6", 6))),
              ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_THAT(
      Numbers(Npy(">u2", "True", std::string("\0\1\1\0\0\2\2\0\0\3\3\0", 12))),
      ElementsAre(1, 2, 3, 256, 512, 768));
  // 1, -2, 65504, 2^-24, 0.5, 1024 of IEEE 754 binary16.
  EXPECT_THAT(Numbers(Npy("<f2", "False",
                          std::string("\x00\x3C\x00\xC0\xFF\x7B\x01\x00"
                                      "\x00\x38\x00\x64",
                                      12))),
              ElementsAre(1, -2, 65504, 1.0 / 16777216, 0.5, 1024));
}

TEST_F(ArrayOrderTest, AnArrayOfMatlabHasItsOwnOrder) {
  Dataset(dir_ / "a.mat", "frames", true);
  EXPECT_THAT(Numbers(ReadArrayFile(dir_ / "a.mat", "")),
              ElementsAre(0, 2, 1, 3));
  Dataset(dir_ / "a.h5", "frames", false);
  EXPECT_THAT(Numbers(ReadArrayFile(dir_ / "a.h5", "frames")),
              ElementsAre(0, 1, 2, 3));
  const ArrayFormat reversed = {.text = {}, .order = Hdf5Order::kColumnsFirst};
  EXPECT_THAT(Numbers(ReadArrayFile(dir_ / "a.h5", "frames", reversed)),
              ElementsAre(0, 2, 1, 3));
  WriteBytes(dir_ / "old.mat", "MATLAB 5.0 MAT-file");
  EXPECT_THAT(Error(dir_ / "old.mat", ""), HasSubstr("'-v7.3'"));
}

TEST_F(ArrayOrderTest, AFilterThatIsNotReadIsNamed) {
  for (const auto& [filter, name] :
       {std::pair(32000, "lzf"), std::pair(32001, "blosc"),
        std::pair(32015, "zstd")}) {
    const std::string path = dir_ / absl::StrCat(name, ".h5");
    Dataset(path, "frames", false, filter);
    EXPECT_THAT(Error(path, ""),
                AllOf(HasSubstr(absl::StrCat(name, " (", filter, ")")),
                      HasSubstr("gzip, szip, shuffle and Fletcher-32"),
                      HasSubstr("compression="), Not(HasSubstr("plugins"))));
  }
}

TEST_F(ArrayOrderTest, AWrongNameGetsTheListOfDatasets) {
  const std::string path = dir_ / "a.h5";
  Dataset(path, "run1/taxels", false);
  EXPECT_EQ(Numbers(ReadArrayFile(path, "")).size(), 4u);
  Dataset(path, "run2/taxels", false);
  for (const char* name : {"", "taxels", "run1", "run1/taxels/x", "/"}) {
    EXPECT_THAT(Error(path, name), AllOf(HasSubstr("run1/taxels (2 x 2)"),
                                         HasSubstr("run2/taxels (2 x 2)")))
        << name;
  }
}

}  // namespace
}  // namespace tactus::internal
