#include "core/files/hdf5_array.h"

#include <algorithm>
#include <functional>
#include <numeric>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/files/array_order.h"
#include "core/files/hdf5_probe.h"
#include "core/files/hdf5_read.h"

namespace tactus::internal {
namespace {

// Datasets that an error lists.
constexpr size_t kListed = 20;
// Objects that are looked at for it.
constexpr size_t kVisited = 10'000;
// What marks an array of MATLAB.
constexpr char kMatlabClass[] = "MATLAB_class";

// The datasets of a file.
struct Datasets {
  // As they are given to ReadHdf5Array().
  std::vector<std::string> names;
  // With their shapes, at most kListed.
  std::vector<std::string> texts;
  size_t visited = 0;
};

herr_t TakeDataset(hid_t file, const char* name, const H5O_info_t* info,
                   void* out) {
  auto& datasets = *static_cast<Datasets*>(out);
  if (++datasets.visited > kVisited) return 1;
  // "#refs#" holds the parts of MATLAB's cells and structures.
  if (info->type != H5O_TYPE_DATASET || absl::StartsWith(name, "#")) return 0;
  datasets.names.emplace_back(name);
  if (datasets.texts.size() == kListed) return 0;
  const Hdf5Handle dataset(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose);
  const Hdf5Handle space(
      dataset.ok() ? H5Dget_space(dataset.get()) : H5I_INVALID_HID, H5Sclose);
  const int rank = space.ok() ? H5Sget_simple_extent_ndims(space.get()) : -1;
  std::vector<hsize_t> dims(static_cast<size_t>(std::max(rank, 0)));
  if (rank > 0) {
    H5Sget_simple_extent_dims(space.get(), dims.data(), nullptr);
  }
  datasets.texts.push_back(
      absl::StrCat(Printable(name), " (", absl::StrJoin(dims, " x "), ")"));
  return 0;
}

Datasets ListDatasets(hid_t file) {
  Datasets datasets;
  H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_INC, TakeDataset, &datasets,
            H5O_INFO_BASIC);
  return datasets;
}

// "the file holds run1/taxels (605 x 384), time (605)".
std::string Held(const Datasets& datasets) {
  if (datasets.texts.empty()) return "the file holds no dataset";
  std::string text =
      absl::StrCat("the file holds ", absl::StrJoin(datasets.texts, ", "));
  if (datasets.names.size() > datasets.texts.size()) {
    absl::StrAppend(&text, " and ",
                    datasets.names.size() - datasets.texts.size(), " more");
  }
  return text;
}

// What elements that are no numbers are, and what to write instead.
std::string ElementsText(hid_t type) {
  switch (H5Tget_class(type)) {
    case H5T_STRING:
      return "text";
    case H5T_COMPOUND:
      return "records with named fields, or complex numbers";
    case H5T_REFERENCE:
      return "references, as cells and structures of MATLAB do";
    case H5T_VLEN:
      return "lists of different lengths";
    case H5T_ARRAY:
      return "small arrays as elements";
    default:
      return "no numbers";
  }
}

// Follows groups by hard links only, one part of the name after another.
absl::Status OpenByName(hid_t file, const std::string& name,
                        const Hdf5Complaint& complain, Hdf5Dataset* dataset) {
  std::string wanted = name;
  if (name.empty()) {
    const Datasets datasets = ListDatasets(file);
    if (datasets.names.empty()) {
      return complain("dataset",
                      "is not there: the file holds none, and those of other "
                      "files to which it links are not read");
    }
    if (datasets.names.size() != 1) {
      return complain("dataset", "is not named; ", Held(datasets),
                      ". Name one: \"dataset\" in skin.json, or FILE:DATASET "
                      "in the table");
    }
    wanted = datasets.names.front();
  }
  const std::vector<std::string> parts =
      absl::StrSplit(wanted, '/', absl::SkipEmpty());
  const auto absent = [&] {
    return complain(wanted, "is no dataset of the file; ",
                    Held(ListDatasets(file)));
  };
  if (parts.empty()) return absent();
  Hdf5Handle group;
  hid_t at = file;
  for (size_t i = 0; i < parts.size(); ++i) {
    TACTUS_ASSIGN_OR_RETURN(const bool has,
                            HasHardLink(at, parts[i].c_str(), complain));
    if (!has) return absent();
    Hdf5Handle next(H5Oopen(at, parts[i].c_str(), H5P_DEFAULT), H5Oclose);
    const bool last = i + 1 == parts.size();
    const H5I_type_t type = next.ok() ? H5Iget_type(next.get()) : H5I_BADID;
    if (last && type == H5I_DATASET) break;
    if (last || type != H5I_GROUP) return absent();
    group = std::move(next);
    at = group.get();
  }
  return OpenDataset(at, parts.back().c_str(), complain, dataset);
}

bool AxesReversed(const Hdf5Dataset& dataset, Hdf5Order order) {
  if (order != Hdf5Order::kAsTheFileSays) {
    return order == Hdf5Order::kColumnsFirst;
  }
  return H5Aexists(dataset.id.get(), kMatlabClass) > 0;
}

template <typename Value>
absl::Status ReadOrdered(const Hdf5Dataset& dataset, const char* name,
                         hid_t type, const std::vector<size_t>& shape,
                         bool reversed, const Hdf5Complaint& complain,
                         std::vector<Value>* out) {
  out->resize(std::accumulate(shape.begin(), shape.end(), size_t{1},
                              std::multiplies<>()));
  TACTUS_RETURN_IF_ERROR(
      ReadValues(dataset, name, type, complain, out->data()));
  if (reversed) *out = FromColumnsFirst(shape, *out);
  return absl::OkStatus();
}

absl::StatusOr<NpyArray> Read(const std::string& path, const std::string& name,
                              Hdf5Order order) {
  const Hdf5Quiet quiet;
  const Hdf5Complaint complain(path, "");
  const Hdf5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT),
                        H5Fclose);
  if (!file.ok()) {
    if (absl::EndsWithIgnoreCase(path, ".mat")) {
      return TrialFileInvalid(path,
                              "is no MATLAB file of version 7.3, or damaged; "
                              "save it with save(..., '-v7.3')");
    }
    return complain.Hdf5("not an HDF5 file, or damaged");
  }
  Hdf5Dataset dataset;
  TACTUS_RETURN_IF_ERROR(OpenByName(file.get(), name, complain, &dataset));
  const char* what = name.empty() ? "dataset" : name.c_str();
  const hid_t type = dataset.type.get();
  const H5T_class_t kind = H5Tget_class(type);
  // What h5py writes for booleans.
  const bool booleans = kind == H5T_ENUM && H5Tget_size(type) == 1;
  if (kind != H5T_INTEGER && kind != H5T_FLOAT && !booleans) {
    return complain(what, "holds ", ElementsText(type),
                    "; it must hold numbers. Write those of the frames as one "
                    "array of numbers, or name another dataset: ",
                    Held(ListDatasets(file.get())));
  }
  const bool reversed = AxesReversed(dataset, order);
  if (reversed) std::reverse(dataset.dims.begin(), dataset.dims.end());
  const std::vector<hsize_t> any(dataset.dims.size(), 0);
  TACTUS_RETURN_IF_ERROR(
      CheckShape(dataset, what, any, sizeof(double), complain));
  NpyArray array;
  array.shape.assign(dataset.dims.begin(), dataset.dims.end());
  if (booleans) {
    std::vector<uint8_t> values;
    TACTUS_RETURN_IF_ERROR(ReadOrdered(dataset, what, type, array.shape,
                                       reversed, complain, &values));
    array.f64.assign(values.begin(), values.end());
    return array;
  }
  const bool u16 = kind == H5T_INTEGER && H5Tget_size(type) == 2 &&
                   H5Tget_sign(type) == H5T_SGN_NONE;
  TACTUS_RETURN_IF_ERROR(
      u16 ? ReadOrdered(dataset, what, H5T_NATIVE_UINT16, array.shape, reversed,
                        complain, &array.u16)
          : ReadOrdered(dataset, what, H5T_NATIVE_DOUBLE, array.shape, reversed,
                        complain, &array.f64));
  return array;
}

}  // namespace

absl::StatusOr<NpyArray> ReadHdf5Array(const std::string& path,
                                       const std::string& name,
                                       Hdf5Order order) {
  TACTUS_RETURN_IF_ERROR(
      ProbeInChild(path, [&] { return Read(path, name, order).status(); }));
  return Read(path, name, order);
}

}  // namespace tactus::internal
