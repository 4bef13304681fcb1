#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/data/hdf5_handle.h"
#include "core/data/hdf5_probe.h"
#include "core/data/trial_file.h"

namespace tactus {
namespace {

// Best ratio deflate can reach; a dataset that claims more is damaged.
constexpr hsize_t kMaxCompression = 1100;

// Makes errors that name file, trial and part.
class Complaint {
 public:
  Complaint(absl::string_view path, absl::string_view trial)
      : path_(path), trial_(trial) {}

  template <typename... Parts>
  absl::Status operator()(absl::string_view part, const Parts&... text) const {
    return TrialFileInvalid(
        path_, absl::StrCat(trial_.empty() ? "" : "trial ", trial_,
                            trial_.empty() ? "" : ": ", part, ": ", text...));
  }
  absl::Status Hdf5(absl::string_view part) const {
    return (*this)(part, "cannot be read: ", Hdf5LastError());
  }

 private:
  absl::string_view path_;
  absl::string_view trial_;
};

// True if `object` holds an attribute `name` that should be read.
absl::StatusOr<bool> HasAttribute(hid_t object, const char* name,
                                  const Complaint& complain) {
  const htri_t has = H5Aexists(object, name);
  if (has < 0) return complain.Hdf5(name);
  return has > 0;
}

absl::Status OpenScalarAttribute(hid_t object, const char* name,
                                 const Complaint& complain, Hdf5Handle* out,
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

// Leaves `value` as it is if the attribute is absent.
absl::Status ReadText(hid_t object, const char* name, const Complaint& complain,
                      std::string* value) {
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

// Accepts integers too. Leaves `value` as it is if the attribute is absent.
absl::Status ReadNumber(hid_t object, const char* name,
                        const Complaint& complain, double* value) {
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

// A dataset that is stored in this very file and whose shape is known.
struct Dataset {
  Hdf5Handle id;
  Hdf5Handle type;
  std::vector<hsize_t> dims;
};

// Soft and external links are not followed: a trial file holds its own data.
absl::StatusOr<bool> HasHardLink(hid_t group, const char* name,
                                 const Complaint& complain) {
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
                         const Complaint& complain, Dataset* out) {
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
  if (H5Pget_external_count(properties.get()) != 0) {
    return complain(name, "its data must not lie in another file");
  }
  const int rank = H5Sget_simple_extent_ndims(space.get());
  if (rank < 1 || rank > 3) return complain(name, "has rank ", rank);
  out->dims.resize(rank);
  if (H5Sget_simple_extent_dims(space.get(), out->dims.data(), nullptr) < 0) {
    return complain.Hdf5(name);
  }
  return absl::OkStatus();
}

// Refuses a dataset whose claimed shape is not `want` (0 = any) or could not
// be in the file, so that a damaged size never leads to a huge allocation.
absl::Status CheckShape(const Dataset& dataset, const char* name,
                        const std::vector<hsize_t>& want, size_t value_bytes,
                        const Complaint& complain) {
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
  if (!fits) {
    constexpr absl::string_view kAny[] = {"T", "rows", "columns"};
    std::vector<std::string> wanted;
    for (const hsize_t size : want) {
      wanted.push_back(size == 0 ? std::string(kAny[wanted.size()])
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

absl::Status ReadValues(const Dataset& dataset, const char* name,
                        hid_t memory_type, const Complaint& complain,
                        void* out) {
  if (H5Dread(dataset.id.get(), memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT,
              out) < 0) {
    return complain.Hdf5(name);
  }
  return absl::OkStatus();
}

// Reads a [rows x columns] array of float32 or float64; `rows` 0 takes any,
// `columns` 0 means a plain vector. Absent: leaves `out` empty.
absl::Status ReadDoubles(hid_t group, const char* name, hsize_t rows,
                         hsize_t columns, const Complaint& complain,
                         std::vector<double>* out) {
  TACTUS_ASSIGN_OR_RETURN(const bool has, HasHardLink(group, name, complain));
  if (!has) return absl::OkStatus();
  Dataset dataset;
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

absl::Status ReadTaxels(hid_t group, hsize_t frames, const Complaint& complain,
                        TaxelSeries* out) {
  constexpr char kName[] = "taxels";
  TACTUS_ASSIGN_OR_RETURN(const bool has, HasHardLink(group, kName, complain));
  if (!has) return absl::OkStatus();
  Dataset dataset;
  TACTUS_RETURN_IF_ERROR(OpenDataset(group, kName, complain, &dataset));
  const hid_t type = dataset.type.get();
  const size_t bytes = H5Tget_size(type);
  const bool integer = H5Tget_class(type) == H5T_INTEGER && bytes == 2 &&
                       H5Tget_sign(type) == H5T_SGN_NONE;
  if (!integer && !(H5Tget_class(type) == H5T_FLOAT && bytes == 4)) {
    return complain(kName, "must be uint16 or float32");
  }
  if (dataset.dims.size() == 3 && (dataset.dims[1] > limits::kMaxRows ||
                                   dataset.dims[2] > limits::kMaxColumns)) {
    return complain(kName, "frames are ", dataset.dims[1], " x ",
                    dataset.dims[2], "; each side must be 1 to ",
                    limits::kMaxRows);
  }
  std::vector<hsize_t> want = {frames, 0, 0};
  TACTUS_RETURN_IF_ERROR(CheckShape(dataset, kName, want, bytes, complain));
  out->rows = static_cast<int>(dataset.dims[1]);
  out->columns = static_cast<int>(dataset.dims[2]);
  const size_t count = frames * out->rows * out->columns;
  if (!integer) {
    out->f32.resize(count);
    return ReadValues(dataset, kName, H5T_NATIVE_FLOAT, complain,
                      out->f32.data());
  }
  TACTUS_RETURN_IF_ERROR(
      ReadNumber(dataset.id.get(), "scale", complain, &out->scale));
  out->u16.resize(count);
  return ReadValues(dataset, kName, H5T_NATIVE_UINT16, complain,
                    out->u16.data());
}

absl::Status ReadArrays(hid_t group, const Complaint& complain, Trial* trial) {
  TACTUS_RETURN_IF_ERROR(
      ReadDoubles(group, "time", 0, 0, complain, &trial->time));
  const size_t frames = trial->time.size();
  if (frames == 0) return complain("time", "is missing");

  std::vector<double> values;
  TACTUS_RETURN_IF_ERROR(
      ReadDoubles(group, "signals", frames, kFeatureCount, complain, &values));
  trial->signals.resize(values.size() / kFeatureCount);
  for (size_t i = 0; i < values.size(); ++i) {
    trial->signals[i / kFeatureCount][i % kFeatureCount] = values[i];
  }

  TACTUS_RETURN_IF_ERROR(ReadTaxels(group, frames, complain, &trial->taxels));

  values.clear();
  TACTUS_RETURN_IF_ERROR(
      ReadDoubles(group, "pose", frames, 7, complain, &values));
  trial->poses.resize(values.size() / 7);
  for (size_t i = 0; i < trial->poses.size(); ++i) {
    const double* row = &values[7 * i];
    trial->poses[i].position = {row[0], row[1], row[2]};
    // Eigen's constructor takes w first.
    trial->poses[i].orientation = {row[6], row[3], row[4], row[5]};
  }
  return absl::OkStatus();
}

absl::Status ReadAttributes(hid_t group, const Complaint& complain,
                            Trial* trial) {
  const std::pair<const char*, std::string*> texts[] = {
      {"label", &trial->label},   {"condition", &trial->condition},
      {"object", &trial->object}, {"material", &trial->material},
      {"layout", &trial->layout}, {"unit", &trial->unit},
  };
  for (const auto& [name, value] : texts) {
    TACTUS_RETURN_IF_ERROR(ReadText(group, name, complain, value));
  }
  const std::pair<const char*, double*> numbers[] = {
      {"stiffness", &trial->stiffness},
      {"velocity", &trial->velocity},
      {"sample_rate_hz", &trial->sample_rate_hz},
  };
  for (const auto& [name, value] : numbers) {
    TACTUS_RETURN_IF_ERROR(ReadNumber(group, name, complain, value));
  }
  return absl::OkStatus();
}

// True if TrialFileWriter made the file: all its metadata has checksums and
// none of its text has variable length.
bool IsOwnFile(const std::string& path) {
  if (!HasChecksums(path)) return false;
  const Hdf5Quiet quiet;
  const Hdf5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT),
                        H5Fclose);
  // A damaged superblock or root: safe to report in this process.
  if (!file.ok()) return true;
  const Complaint complain(path, "");
  Hdf5Handle attribute;
  Hdf5Handle type;
  std::string creator;
  return OpenScalarAttribute(file.get(), "creator", complain, &attribute, &type)
             .ok() &&
         H5Tis_variable_str(type.get()) == 0 &&
         ReadText(file.get(), "creator", complain, &creator).ok() &&
         creator == "tactus";
}

herr_t TakeName(hid_t, const char* name, const H5L_info_t*, void* out) {
  auto& ids = *static_cast<std::vector<std::string>*>(out);
  if (ids.size() >= limits::kMaxTrialsPerFile) return -1;
  ids.emplace_back(name);
  return 0;
}

}  // namespace

struct TrialFileReader::State {
  std::string path;
  Hdf5Handle file;
  Hdf5Handle trials;
  std::vector<std::string> ids;

  ~State() {
    const Hdf5Quiet quiet;
    trials.Close();
    file.Close();
  }
};

TrialFileReader::TrialFileReader(std::unique_ptr<State> state)
    : state_(std::move(state)) {}
TrialFileReader::TrialFileReader(TrialFileReader&&) noexcept = default;
TrialFileReader& TrialFileReader::operator=(TrialFileReader&&) noexcept =
    default;
TrialFileReader::~TrialFileReader() = default;

absl::StatusOr<TrialFileReader> TrialFileReader::Open(const std::string& path) {
  if (!IsOwnFile(path)) {
    TACTUS_RETURN_IF_ERROR(ProbeInChild(path, [&path] {
      auto reader = OpenUnprobed(path);
      for (size_t i = 0; reader.ok() && i < reader->size(); ++i) {
        reader->Read(i).IgnoreError();
      }
    }));
  }
  return OpenUnprobed(path);
}

absl::StatusOr<TrialFileReader> TrialFileReader::OpenUnprobed(
    const std::string& path) {
  const Hdf5Quiet quiet;
  const Complaint complain(path, "");
  auto state = std::make_unique<State>();
  state->path = path;
  state->file = {H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose};
  if (!state->file.ok()) return complain.Hdf5("not an HDF5 file, or damaged");
  const hid_t file = state->file.get();

  std::string format;
  TACTUS_RETURN_IF_ERROR(ReadText(file, "format", complain, &format));
  if (format != "tactus-trials") {
    return complain("format", "is \"", format, "\"; it must be tactus-trials");
  }
  double version = 0;
  TACTUS_RETURN_IF_ERROR(ReadNumber(file, "version", complain, &version));
  if (version != 1) {
    return complain("version", "is ", version, "; this program reads 1");
  }
  TACTUS_ASSIGN_OR_RETURN(const bool has,
                          HasHardLink(file, "trials", complain));
  if (!has) return complain("trials", "is missing");
  state->trials = {H5Gopen2(file, "trials", H5P_DEFAULT), H5Gclose};
  if (!state->trials.ok()) return complain.Hdf5("trials");
  if (H5Literate(state->trials.get(), H5_INDEX_NAME, H5_ITER_INC, nullptr,
                 TakeName, &state->ids) < 0) {
    return complain.Hdf5("trials");
  }
  std::sort(state->ids.begin(), state->ids.end());
  return TrialFileReader(std::move(state));
}

size_t TrialFileReader::size() const { return state_->ids.size(); }

const std::string& TrialFileReader::id(size_t index) const {
  return state_->ids[index];
}

absl::StatusOr<Trial> TrialFileReader::Read(size_t index) const {
  if (index >= size()) {
    return TrialFileInvalid(
        state_->path, absl::StrCat("has ", size(), " trials; trial number ",
                                   index, " was asked for"));
  }
  const Hdf5Quiet quiet;
  Trial trial;
  trial.id = id(index);
  const Complaint complain(state_->path, trial.id);
  const hid_t trials = state_->trials.get();
  TACTUS_RETURN_IF_ERROR(
      HasHardLink(trials, trial.id.c_str(), complain).status());
  const Hdf5Handle group(H5Gopen2(trials, trial.id.c_str(), H5P_DEFAULT),
                         H5Gclose);
  if (!group.ok()) return complain.Hdf5("group");
  TACTUS_RETURN_IF_ERROR(ReadArrays(group.get(), complain, &trial));
  TACTUS_RETURN_IF_ERROR(ReadAttributes(group.get(), complain, &trial));
  TACTUS_RETURN_IF_ERROR(Validate(trial, state_->path));
  return trial;
}

absl::StatusOr<std::vector<Trial>> TrialFileReader::ReadAll() const {
  std::vector<Trial> trials;
  for (size_t i = 0; i < size(); ++i) {
    TACTUS_ASSIGN_OR_RETURN(Trial trial, Read(i));
    trials.push_back(std::move(trial));
  }
  return trials;
}

}  // namespace tactus
