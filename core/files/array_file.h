// File: array_file.h
//
// One array of numbers from a file of any format that recordings come in: .npy,
// .npz, text (.csv, .tsv, .txt, .dat), HDF5 (.h5, .hdf5, .mat).
//
//   TACTUS_ASSIGN_OR_RETURN(const ArrayFile file,
//                           ReadArrayFile("trial.h5", "run1/taxels"));
//   file.array.shape;  // {605, 384}
//
// Not thread-safe, like HDF5 itself.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/files/hdf5_array.h"
#include "core/files/npy.h"
#include "core/files/number_text.h"

namespace tactus::internal {

// What a file does not say of itself.
struct ArrayFormat {
  NumberTextFormat text;
  // The order in which the numbers of an HDF5 dataset lie.
  Hdf5Order order = Hdf5Order::kAsTheFileSays;
};

struct ArrayFile {
  NpyArray array;
  // The names of the columns of a text file; empty if it has none.
  std::vector<std::string> header;
  // Says how a text file was read, for people; empty if nothing was detected.
  std::string found;

  // Number `index` of the array, whatever its type.
  double Number(size_t index) const;
  size_t size() const;

  // Part `index` along the first axis: [5 x 75 x 60] gives [75 x 60]. `index`
  // is below shape[0], and there are two axes or more.
  ArrayFile Slice(size_t index) const;
};

// Reads the array `dataset` of the file; empty: the only one that there is. A
// text file has no name for its array (number_text.h). IO or
// TRIAL_FILE_INVALID, with the line of a text file.
absl::StatusOr<ArrayFile> ReadArrayFile(const std::string& path,
                                        const std::string& dataset,
                                        const ArrayFormat& format = {});

}  // namespace tactus::internal
