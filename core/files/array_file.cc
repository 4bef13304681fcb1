#include "core/files/array_file.h"

#include <algorithm>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/files/csv.h"
#include "core/files/file_bytes.h"
#include "core/files/hdf5_probe.h"
#include "core/files/hdf5_read.h"
#include "core/files/npz.h"

namespace tactus {
namespace {

// An array of NumPy may also be a single value or text.
absl::StatusOr<ArrayFile> NumbersOf(const std::string& path,
                                    absl::StatusOr<NpyArray> array) {
  if (!array.ok()) return array.status();
  if (array->shape.empty() || !array->text.empty()) {
    return TrialFileInvalid(
        path, "holds one value or text; it must hold an array of numbers");
  }
  return ArrayFile{*std::move(array), {}};
}

// The lines of a CSV file of numbers.
absl::StatusOr<ArrayFile> ReadNumbersCsv(const std::string& path) {
  TACTUS_ASSIGN_OR_RETURN(const std::string text,
                          ReadFileBytes(path, limits::kMaxCsvBytes));
  ArrayFile file;
  size_t columns = 0;
  size_t number = 0;
  absl::string_view rest = text;
  absl::ConsumePrefix(&rest, "\xEF\xBB\xBF");
  while (!rest.empty()) {
    ++number;
    const size_t end = std::min(rest.find('\n'), rest.size());
    absl::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    absl::ConsumeSuffix(&line, "\r");
    if (absl::StartsWith(line, "#")) continue;
    const auto complain = [&](const auto&... parts) {
      return TrialFileInvalid(path,
                              absl::StrCat("line ", number, ": ", parts...));
    };
    const std::vector<absl::string_view> cells = absl::StrSplit(line, ',');
    double value = 0;
    if (columns == 0) {
      columns = cells.size();
      if (columns > limits::kMaxTaxels + size_t{16}) {
        return complain("has ", columns, " columns");
      }
      const bool header = std::none_of(
          cells.begin(), cells.end(),
          [&](absl::string_view cell) { return ParseNumber(cell, &value); });
      if (header) {
        for (const absl::string_view cell : cells) {
          file.header.push_back(Printable(cell));
        }
        continue;
      }
    }
    if (cells.size() != columns) {
      return complain("has ", cells.size(), " cells; the first line has ",
                      columns);
    }
    for (size_t i = 0; i < columns; ++i) {
      if (!ParseNumber(cells[i], &value)) {
        return complain(
            file.header.empty() ? absl::StrCat("cell ", i + 1) : file.header[i],
            " is ", Quoted(cells[i]), "; it must be a finite number");
      }
      if (file.array.f64.size() >= limits::kMaxCsvCells) {
        return complain("is beyond the ", limits::kMaxCsvCells,
                        " cells that are read of a file");
      }
      file.array.f64.push_back(value);
    }
  }
  if (file.array.f64.empty()) {
    return TrialFileInvalid(path, "holds no numbers");
  }
  file.array.shape = {file.array.f64.size() / columns, columns};
  return file;
}

herr_t TakeName(hid_t, const char* name, const H5L_info_t*, void* out) {
  constexpr size_t kNamed = 20;
  auto& names = *static_cast<std::vector<std::string>*>(out);
  if (names.size() >= kNamed) return 1;
  names.push_back(Printable(name));
  return 0;
}

// Follows groups by hard links only, one part of the name after another.
absl::Status OpenByName(hid_t file, const std::string& name,
                        const Hdf5Complaint& complain, Hdf5Dataset* dataset) {
  std::vector<std::string> names;
  static_cast<void>(
      H5Literate(file, H5_INDEX_NAME, H5_ITER_INC, nullptr, TakeName, &names));
  const std::string wanted =
      name.empty() && names.size() == 1 ? names.front() : name;
  const std::vector<std::string> parts =
      absl::StrSplit(wanted, '/', absl::SkipEmpty());
  if (parts.empty()) {
    return complain("dataset", "is not named; the file holds ",
                    absl::StrJoin(names, ", "));
  }
  Hdf5Handle group;
  hid_t at = file;
  for (size_t i = 0; i < parts.size(); ++i) {
    TACTUS_ASSIGN_OR_RETURN(const bool has,
                            HasHardLink(at, parts[i].c_str(), complain));
    if (!has) {
      return complain(wanted, "is not in the file, which holds ",
                      absl::StrJoin(names, ", "));
    }
    if (i + 1 == parts.size()) break;
    Hdf5Handle next(H5Gopen2(at, parts[i].c_str(), H5P_DEFAULT), H5Gclose);
    if (!next.ok()) return complain(wanted, parts[i], " is no group");
    group = std::move(next);
    at = group.get();
  }
  return OpenDataset(at, parts.back().c_str(), complain, dataset);
}

absl::StatusOr<ArrayFile> ReadHdf5(const std::string& path,
                                   const std::string& name) {
  const Hdf5Quiet quiet;
  const Hdf5Complaint complain(path, "");
  const Hdf5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT),
                        H5Fclose);
  if (!file.ok()) return complain.Hdf5("not an HDF5 file, or damaged");
  Hdf5Dataset dataset;
  TACTUS_RETURN_IF_ERROR(OpenByName(file.get(), name, complain, &dataset));
  const char* what = name.empty() ? "dataset" : name.c_str();
  const hid_t type = dataset.type.get();
  const H5T_class_t kind = H5Tget_class(type);
  if (kind != H5T_INTEGER && kind != H5T_FLOAT) {
    return complain(what, "must hold numbers");
  }
  const std::vector<hsize_t> any(dataset.dims.size(), 0);
  TACTUS_RETURN_IF_ERROR(
      CheckShape(dataset, what, any, sizeof(double), complain));
  ArrayFile result;
  result.array.shape.assign(dataset.dims.begin(), dataset.dims.end());
  size_t count = 1;
  for (const hsize_t size : dataset.dims) count *= size;
  const bool u16 = kind == H5T_INTEGER && H5Tget_size(type) == 2 &&
                   H5Tget_sign(type) == H5T_SGN_NONE;
  if (u16) {
    result.array.u16.resize(count);
    TACTUS_RETURN_IF_ERROR(ReadValues(dataset, what, H5T_NATIVE_UINT16,
                                      complain, result.array.u16.data()));
  } else {
    result.array.f64.resize(count);
    TACTUS_RETURN_IF_ERROR(ReadValues(dataset, what, H5T_NATIVE_DOUBLE,
                                      complain, result.array.f64.data()));
  }
  return result;
}

}  // namespace

double ArrayFile::Number(size_t index) const {
  if (!array.u16.empty()) return array.u16[index];
  if (!array.i64.empty()) return static_cast<double>(array.i64[index]);
  if (!array.f32.empty()) return array.f32[index];
  return array.f64[index];
}

size_t ArrayFile::size() const {
  return array.u16.size() + array.i64.size() + array.f32.size() +
         array.f64.size();
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
  cut(array.i64, slice.array.i64);
  cut(array.f32, slice.array.f32);
  cut(array.f64, slice.array.f64);
  return slice;
}

absl::StatusOr<ArrayFile> ReadArrayFile(const std::string& path,
                                        const std::string& dataset) {
  if (absl::EndsWith(path, ".npy")) {
    return NumbersOf(path, ReadNpy(path));
  }
  if (absl::EndsWith(path, ".npz")) {
    return NumbersOf(path, ReadNpz(path, dataset));
  }
  if (absl::EndsWith(path, ".csv")) return ReadNumbersCsv(path);
  if (absl::EndsWith(path, ".h5") || absl::EndsWith(path, ".hdf5")) {
    TACTUS_RETURN_IF_ERROR(
        ProbeInChild(path, [&] { return ReadHdf5(path, dataset).status(); }));
    return ReadHdf5(path, dataset);
  }
  return TrialFileInvalid(
      path, "is of no known format; use .npy, .npz, .csv, .h5 or .hdf5");
}

}  // namespace tactus
