#include "core/files/hdf5_read.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "absl/strings/str_join.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/files/hdf5_filters.h"

namespace tactus::internal {
namespace {

// Best ratio deflate can reach; a dataset that claims more is damaged.
constexpr hsize_t kMaxCompression = 1100;
// Texts of a list, and bytes of each.
constexpr hssize_t kMaxListedTexts = 1000;
constexpr size_t kMaxListedBytes = 1024;

// True if `object` holds an attribute `name` that should be read.
absl::StatusOr<bool> HasAttribute(hid_t object, const char* name,
                                  const Hdf5Complaint& complain) {
  const htri_t has = H5Aexists(object, name);
  if (has < 0) return complain.Hdf5(name);
  return has > 0;
}

}  // namespace

absl::Status OpenScalarAttribute(hid_t object, const char* name,
                                 const Hdf5Complaint& complain, Hdf5Handle* out,
                                 Hdf5Handle* type) {
  *out = {H5Aopen(object, name, H5P_DEFAULT), H5Aclose};
  if (!out->ok()) return complain.Hdf5(name);
  *type = {H5Aget_type(out->get()), H5Tclose};
  const Hdf5Handle space(H5Aget_space(out->get()), H5Sclose);
  if (!type->ok() || !space.ok()) return complain.Hdf5(name);
  if (H5Sget_simple_extent_npoints(space.get()) != 1) {
    return complain(name, "must hold one value");
  }
  return absl::OkStatus();
}

absl::Status ReadText(hid_t object, const char* name,
                      const Hdf5Complaint& complain, std::string* value) {
  TACTUS_ASSIGN_OR_RETURN(const bool has, HasAttribute(object, name, complain));
  if (!has) return absl::OkStatus();
  Hdf5Handle attribute;
  Hdf5Handle type;
  TACTUS_RETURN_IF_ERROR(
      OpenScalarAttribute(object, name, complain, &attribute, &type));
  if (H5Tget_class(type.get()) != H5T_STRING) {
    return complain(name, "must be text");
  }
  const Hdf5Handle memory(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_cset(memory.get(), H5Tget_cset(type.get()));
  if (H5Tis_variable_str(type.get()) > 0) {
    H5Tset_size(memory.get(), H5T_VARIABLE);
    char* text = nullptr;
    if (H5Aread(attribute.get(), memory.get(), &text) < 0) {
      return complain.Hdf5(name);
    }
    *value = text == nullptr ? "" : text;
    H5free_memory(text);
  } else {
    const size_t bytes = H5Tget_size(type.get());
    if (bytes == 0 || bytes > 64 * 1024) {
      return complain(name, "has ", bytes, " bytes of text");
    }
    std::string text(bytes, '\0');
    H5Tset_size(memory.get(), bytes);
    H5Tset_strpad(memory.get(), H5Tget_strpad(type.get()));
    if (H5Aread(attribute.get(), memory.get(), text.data()) < 0) {
      return complain.Hdf5(name);
    }
    text.resize(std::min(text.find('\0'), text.size()));
    if (H5Tget_strpad(type.get()) == H5T_STR_SPACEPAD) {
      text.erase(text.find_last_not_of(' ') + 1);
    }
    *value = std::move(text);
  }
  return absl::OkStatus();
}

absl::Status ReadTextList(hid_t object, const char* name,
                          const Hdf5Complaint& complain,
                          std::vector<std::string>* values) {
  TACTUS_ASSIGN_OR_RETURN(const bool has, HasAttribute(object, name, complain));
  if (!has) return absl::OkStatus();
  const Hdf5Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  const Hdf5Handle type(H5Aget_type(attribute.get()), H5Tclose);
  const Hdf5Handle space(H5Aget_space(attribute.get()), H5Sclose);
  if (!attribute.ok() || !type.ok() || !space.ok()) return complain.Hdf5(name);
  const hssize_t count = H5Sget_simple_extent_npoints(space.get());
  if (count < 0 || count > kMaxListedTexts) {
    return complain(name, "has ", count, " texts");
  }
  // An empty list has no type of text.
  if (count == 0) return absl::OkStatus();
  if (H5Tget_class(type.get()) != H5T_STRING) {
    return complain(name, "must be text");
  }
  const size_t texts = static_cast<size_t>(count);
  const Hdf5Handle memory(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_cset(memory.get(), H5Tget_cset(type.get()));
  if (H5Tis_variable_str(type.get()) > 0) {
    H5Tset_size(memory.get(), H5T_VARIABLE);
    std::vector<char*> text(texts);
    if (H5Aread(attribute.get(), memory.get(), text.data()) < 0) {
      return complain.Hdf5(name);
    }
    for (const char* item : text) values->emplace_back(item ? item : "");
    H5Dvlen_reclaim(memory.get(), space.get(), H5P_DEFAULT, text.data());
    return absl::OkStatus();
  }
  const size_t bytes = H5Tget_size(type.get());
  if (bytes == 0 || bytes > kMaxListedBytes) {
    return complain(name, "has ", bytes, " bytes a text");
  }
  std::string text(texts * bytes, '\0');
  H5Tset_size(memory.get(), bytes);
  H5Tset_strpad(memory.get(), H5T_STR_NULLPAD);
  if (H5Aread(attribute.get(), memory.get(), text.data()) < 0) {
    return complain.Hdf5(name);
  }
  for (size_t i = 0; i < texts; ++i) {
    const std::string item = text.substr(i * bytes, bytes);
    values->push_back(item.substr(0, item.find('\0')));
  }
  return absl::OkStatus();
}

absl::StatusOr<std::vector<std::string>> ListNames(
    hid_t group, const Hdf5Complaint& complain) {
  H5G_info_t info;
  if (H5Gget_info(group, &info) < 0) return complain.Hdf5("group");
  if (info.nlinks > kMaxListedTexts) {
    return complain("group", "has ", info.nlinks, " entries");
  }
  std::vector<std::string> names;
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    char name[kMaxListedBytes];
    if (H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, name,
                           sizeof name, H5P_DEFAULT) < 0) {
      return complain.Hdf5("group");
    }
    names.emplace_back(name);
  }
  return names;
}

absl::Status ReadNumber(hid_t object, const char* name,
                        const Hdf5Complaint& complain, double* value) {
  TACTUS_ASSIGN_OR_RETURN(const bool has, HasAttribute(object, name, complain));
  if (!has) return absl::OkStatus();
  Hdf5Handle attribute;
  Hdf5Handle type;
  TACTUS_RETURN_IF_ERROR(
      OpenScalarAttribute(object, name, complain, &attribute, &type));
  const H5T_class_t kind = H5Tget_class(type.get());
  if (kind != H5T_FLOAT && kind != H5T_INTEGER) {
    return complain(name, "must be a number");
  }
  if (H5Aread(attribute.get(), H5T_NATIVE_DOUBLE, value) < 0) {
    return complain.Hdf5(name);
  }
  return absl::OkStatus();
}

absl::StatusOr<bool> HasHardLink(hid_t group, const char* name,
                                 const Hdf5Complaint& complain) {
  const htri_t exists = H5Lexists(group, name, H5P_DEFAULT);
  if (exists < 0) return complain.Hdf5(name);
  if (exists == 0) return false;
  H5L_info_t info;
  if (H5Lget_info(group, name, &info, H5P_DEFAULT) < 0) {
    return complain.Hdf5(name);
  }
  if (info.type != H5L_TYPE_HARD) {
    return complain(name, "is a link to another place");
  }
  return true;
}

absl::Status OpenDataset(hid_t group, const char* name,
                         const Hdf5Complaint& complain, Hdf5Dataset* out) {
  out->id = {H5Oopen(group, name, H5P_DEFAULT), H5Oclose};
  if (!out->id.ok()) return complain.Hdf5(name);
  if (H5Iget_type(out->id.get()) != H5I_DATASET) {
    return complain(name, "must be a dataset");
  }
  out->type = {H5Dget_type(out->id.get()), H5Tclose};
  const Hdf5Handle space(H5Dget_space(out->id.get()), H5Sclose);
  const Hdf5Handle properties(H5Dget_create_plist(out->id.get()), H5Pclose);
  if (!out->type.ok() || !space.ok() || !properties.ok()) {
    return complain.Hdf5(name);
  }
  const H5D_layout_t layout = H5Pget_layout(properties.get());
  if (layout != H5D_CONTIGUOUS && layout != H5D_CHUNKED &&
      layout != H5D_COMPACT) {
    return complain(name, "its data must lie in the file");
  }
  TACTUS_RETURN_IF_ERROR(CheckFilters(properties.get(), name, complain));
  if (H5Pget_external_count(properties.get()) != 0) {
    return complain(name, "its data must not lie in another file");
  }
  const int rank = H5Sget_simple_extent_ndims(space.get());
  if (rank < 1 || rank > 4) {
    return complain(name, "has ", std::max(rank, 0), " axes; 1 to 4 are read");
  }
  out->dims.resize(rank);
  if (H5Sget_simple_extent_dims(space.get(), out->dims.data(), nullptr) < 0) {
    return complain.Hdf5(name);
  }
  return absl::OkStatus();
}

absl::Status CheckShape(const Hdf5Dataset& dataset, const char* name,
                        const std::vector<hsize_t>& want, size_t value_bytes,
                        const Hdf5Complaint& complain) {
  const std::string shape = absl::StrJoin(dataset.dims, " x ");
  bool fits = dataset.dims.size() == want.size();
  hsize_t bytes = value_bytes;
  for (size_t i = 0; fits && i < want.size(); ++i) {
    fits = want[i] == 0 || dataset.dims[i] == want[i];
    // No product overflows: all but the first dimension are small.
    fits = fits && dataset.dims[i] >= 1 &&
           dataset.dims[i] <= (i == 0 ? limits::kMaxFramesPerTrial
                                      : hsize_t{limits::kMaxTaxels});
    bytes *= fits ? dataset.dims[i] : 1;
  }
  const bool any = std::all_of(want.begin(), want.end(),
                               [](hsize_t size) { return size == 0; });
  if (!fits && any && dataset.dims.size() == want.size()) {
    return complain(name, "has shape ", shape,
                    "; its first axis, the frames, must have 1 to ",
                    limits::kMaxFramesPerTrial,
                    " entries, and each other 1 to ", limits::kMaxTaxels);
  }
  if (!fits) {
    constexpr absl::string_view kAny[] = {"T", "rows", "columns"};
    std::vector<std::string> wanted;
    for (const hsize_t size : want) {
      wanted.push_back(
          size == 0
              ? std::string(
                    kAny[std::min<size_t>(wanted.size(), std::size(kAny) - 1)])
              : absl::StrCat(size));
    }
    return complain(name, "has shape ", shape, "; it must be ",
                    absl::StrJoin(wanted, " x "));
  }
  if (bytes > limits::kMaxTrialArrayBytes) {
    return complain(name, "has ", bytes, " bytes; the limit is ",
                    limits::kMaxTrialArrayBytes);
  }
  if (bytes / kMaxCompression > H5Dget_storage_size(dataset.id.get())) {
    return complain(name, "its data is missing");
  }
  return absl::OkStatus();
}

absl::Status ReadValues(const Hdf5Dataset& dataset, const char* name,
                        hid_t memory_type, const Hdf5Complaint& complain,
                        void* out) {
  if (H5Dread(dataset.id.get(), memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT,
              out) < 0) {
    return complain.Hdf5(name);
  }
  return absl::OkStatus();
}

absl::Status ReadDoubles(hid_t group, const char* name, hsize_t rows,
                         hsize_t columns, const Hdf5Complaint& complain,
                         std::vector<double>* out) {
  TACTUS_ASSIGN_OR_RETURN(const bool has, HasHardLink(group, name, complain));
  if (!has) return absl::OkStatus();
  Hdf5Dataset dataset;
  TACTUS_RETURN_IF_ERROR(OpenDataset(group, name, complain, &dataset));
  if (H5Tget_class(dataset.type.get()) != H5T_FLOAT) {
    return complain(name, "must be floating-point numbers");
  }
  // T x 1 instead of T is what MATLAB writes.
  if (columns == 0 && dataset.dims.size() == 2 &&
      (dataset.dims[0] == 1 || dataset.dims[1] == 1)) {
    dataset.dims = {dataset.dims[0] * dataset.dims[1]};
  }
  std::vector<hsize_t> want = {rows};
  if (columns > 0) want.push_back(columns);
  TACTUS_RETURN_IF_ERROR(
      CheckShape(dataset, name, want, sizeof(double), complain));
  out->resize(dataset.dims[0] * std::max<hsize_t>(columns, 1));
  return ReadValues(dataset, name, H5T_NATIVE_DOUBLE, complain, out->data());
}

}  // namespace tactus::internal
