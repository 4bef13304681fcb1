#include "core/files/array_file.h"

#include <algorithm>

#include "absl/strings/match.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/files/file_bytes.h"
#include "core/files/npz.h"

namespace tactus::internal {
namespace {

// An array of NumPy may also be a single value or text.
absl::StatusOr<ArrayFile> NumbersOf(const std::string& path,
                                    absl::StatusOr<NpyArray> array) {
  if (!array.ok()) return array.status();
  if (array->shape.empty() || !array->text.empty()) {
    return TrialFileInvalid(
        path, "holds one value or text; it must hold an array of numbers");
  }
  return ArrayFile{*std::move(array), {}, {}};
}

absl::StatusOr<ArrayFile> ReadNumbersText(const std::string& path,
                                          const NumberTextFormat& format) {
  TACTUS_ASSIGN_OR_RETURN(const std::string text,
                          ReadFileBytes(path, limits::kMaxCsvBytes));
  TACTUS_ASSIGN_OR_RETURN(NumberText table,
                          ParseNumberText(path, text, format));
  ArrayFile file;
  file.header = std::move(table.header);
  file.found = std::move(table.found);
  file.array.shape = {table.numbers.size() / table.columns, table.columns};
  file.array.f64 = std::move(table.numbers);
  return file;
}

// True if `path` has one of the endings, in letters of any case.
bool EndsWithAny(absl::string_view path,
                 std::initializer_list<absl::string_view> endings) {
  return std::any_of(endings.begin(), endings.end(), [&](const auto& ending) {
    return absl::EndsWithIgnoreCase(path, ending);
  });
}

}  // namespace

double ArrayFile::Number(size_t index) const {
  if (!array.u16.empty()) return array.u16[index];
  if (!array.i16.empty()) return array.i16[index];
  if (!array.i64.empty()) return static_cast<double>(array.i64[index]);
  if (!array.f32.empty()) return array.f32[index];
  return array.f64[index];
}

size_t ArrayFile::size() const {
  return array.u16.size() + array.i16.size() + array.i64.size() +
         array.f32.size() + array.f64.size();
}

ArrayFile ArrayFile::Slice(size_t index) const {
  ArrayFile slice;
  slice.array.shape.assign(array.shape.begin() + 1, array.shape.end());
  const size_t count = size() / array.shape.front();
  const auto cut = [&](const auto& from, auto& to) {
    if (from.empty()) return;
    const auto begin = from.begin() + static_cast<ptrdiff_t>(index * count);
    to.assign(begin, begin + static_cast<ptrdiff_t>(count));
  };
  cut(array.u16, slice.array.u16);
  cut(array.i16, slice.array.i16);
  cut(array.i64, slice.array.i64);
  cut(array.f32, slice.array.f32);
  cut(array.f64, slice.array.f64);
  return slice;
}

absl::StatusOr<ArrayFile> ReadArrayFile(const std::string& path,
                                        const std::string& dataset,
                                        const ArrayFormat& format) {
  if (EndsWithAny(path, {".npy"})) return NumbersOf(path, ReadNpy(path));
  if (EndsWithAny(path, {".npz"})) {
    return NumbersOf(path, ReadNpz(path, dataset));
  }
  if (EndsWithAny(path, {".csv", ".tsv", ".txt", ".dat"})) {
    return ReadNumbersText(path, format.text);
  }
  if (EndsWithAny(path, {".h5", ".hdf5", ".mat"})) {
    return NumbersOf(path, ReadHdf5Array(path, dataset, format.order));
  }
  if (EndsWithAny(path, {".gz", ".bz2", ".xz", ".zip", ".zst"})) {
    return TrialFileInvalid(
        path, "is packed; unpack it, and name the unpacked file in the table");
  }
  if (EndsWithAny(path, {".xlsx", ".xls", ".ods"})) {
    return TrialFileInvalid(path, "is a workbook; save its sheet as CSV");
  }
  if (EndsWithAny(path, {".pkl", ".pickle"})) {
    return TrialFileInvalid(
        path,
        "is a pickle, which can run any program when it is read; pickles are "
        "never read. Save the array with numpy.save");
  }
  return TrialFileInvalid(
      path,
      "is of no known format; use .npy, .npz, .csv, .tsv, .txt, .dat, .h5, "
      ".hdf5 or .mat");
}

}  // namespace tactus::internal
