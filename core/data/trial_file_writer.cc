#include <unistd.h>

#include <algorithm>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/data/trial_file.h"
#include "core/data/trial_id.h"
#include "core/files/draft_file.h"
#include "core/files/hdf5_handle.h"
#include "core/skin/layout_json.h"
#include "core/skin/taxel_values.h"

namespace tactus::internal {
namespace {

constexpr hsize_t kChunkBytes = 1024 * 1024;

// One array to write. Owns nothing.
struct Array {
  const char* name;
  hid_t memory_type;
  hid_t file_type;
  std::vector<hsize_t> dims;
  hsize_t row_bytes;
  const void* data;
  bool compress;
};

Hdf5Handle ScalarSpace() { return {H5Screate(H5S_SCALAR), H5Sclose}; }

bool WriteAttribute(hid_t object, const char* name, hid_t memory_type,
                    hid_t file_type, const void* value) {
  const Hdf5Handle space = ScalarSpace();
  Hdf5Handle attribute(H5Acreate2(object, name, file_type, space.get(),
                                  H5P_DEFAULT, H5P_DEFAULT),
                       H5Aclose);
  return attribute.ok() && H5Awrite(attribute.get(), memory_type, value) >= 0 &&
         attribute.Close();
}

bool WriteNumber(hid_t object, const char* name, double value) {
  return WriteAttribute(object, name, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE,
                        &value);
}

// Fixed length, zero-padded UTF-8: unlike text of variable length it lies in
// the object header, which has a checksum.
bool WriteText(hid_t object, const char* name, const std::string& value) {
  const Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  // HDF5 has no empty type; std::string ends in a zero byte.
  const size_t bytes = std::max<size_t>(value.size(), 1);
  return H5Tset_size(type.get(), bytes) >= 0 &&
         H5Tset_strpad(type.get(), H5T_STR_NULLPAD) >= 0 &&
         H5Tset_cset(type.get(), H5T_CSET_UTF8) >= 0 &&
         WriteAttribute(object, name, type.get(), type.get(), value.c_str());
}

// Returns the dataset, so that attributes may be added; not ok() on failure.
Hdf5Handle WriteArray(hid_t group, const Array& array) {
  const int rank = static_cast<int>(array.dims.size());
  std::vector<hsize_t> chunk = array.dims;
  chunk[0] = std::clamp<hsize_t>(kChunkBytes / array.row_bytes, 1, chunk[0]);
  const Hdf5Handle space(H5Screate_simple(rank, array.dims.data(), nullptr),
                         H5Sclose);
  const Hdf5Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  // Fletcher32 comes last, so that a damaged chunk is refused before it is
  // inflated.
  bool ok = H5Pset_chunk(properties.get(), rank, chunk.data()) >= 0;
  if (array.compress) {
    ok = ok && H5Pset_shuffle(properties.get()) >= 0 &&
         H5Pset_deflate(properties.get(), 1) >= 0;
  }
  ok = ok && H5Pset_fletcher32(properties.get()) >= 0;
  if (!ok) return {};
  Hdf5Handle dataset(H5Dcreate2(group, array.name, array.file_type, space.get(),
                                H5P_DEFAULT, properties.get(), H5P_DEFAULT),
                     H5Dclose);
  if (!dataset.ok() || H5Dwrite(dataset.get(), array.memory_type, H5S_ALL,
                                H5S_ALL, H5P_DEFAULT, array.data) < 0) {
    return {};
  }
  return dataset;
}

bool WriteDoubles(hid_t group, const char* name, hsize_t rows, hsize_t columns,
                  const double* data) {
  std::vector<hsize_t> dims = {rows};
  if (columns > 1) dims.push_back(columns);
  return WriteArray(group,
                    {name, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE, std::move(dims),
                     columns * sizeof(double), data, false})
      .ok();
}

bool WriteTaxels(hid_t group, const TaxelSeries& taxels) {
  const std::vector<size_t> shape = taxels.shape();
  Array array = {.name = "taxels",
                 .memory_type = H5T_NATIVE_FLOAT,
                 .file_type = H5T_IEEE_F32LE,
                 .dims = {shape.begin(), shape.end()},
                 .row_bytes = taxels.frame_size() * TaxelBytes(taxels.type()),
                 .data = taxels.f32.data(),
                 .compress = true};
  if (!taxels.f32.empty()) return WriteArray(group, array).ok();
  if (!taxels.u16.empty()) {
    array.memory_type = H5T_NATIVE_UINT16;
    array.file_type = H5T_STD_U16LE;
    array.data = taxels.u16.data();
  } else {
    array.memory_type = H5T_NATIVE_INT16;
    array.file_type = H5T_STD_I16LE;
    array.data = taxels.i16.data();
  }
  const Hdf5Handle dataset = WriteArray(group, array);
  return dataset.ok() && WriteNumber(dataset.get(), "scale", taxels.scale);
}

bool WritePoses(hid_t group, const std::vector<Pose>& poses) {
  std::vector<double> values;
  values.reserve(poses.size() * 7);
  for (const Pose& pose : poses) {
    const Eigen::Quaterniond& q = pose.orientation;
    values.insert(values.end(),
                  {pose.position.x(), pose.position.y(), pose.position.z(),
                   q.x(), q.y(), q.z(), q.w()});
  }
  return WriteDoubles(group, "pose", poses.size(), 7, values.data());
}

// Compressed, as most objects rest for long; and a chunk that was overwritten
// with zeros, to which Fletcher-32 is blind, does not inflate.
bool WriteObjectMotion(hid_t group, const std::vector<double>& motion) {
  return WriteArray(group, {"object_motion",
                            H5T_NATIVE_DOUBLE,
                            H5T_IEEE_F64LE,
                            {motion.size()},
                            sizeof(double),
                            motion.data(),
                            true})
      .ok();
}

// Keeps all attributes in the group's header: smaller and faster.
Hdf5Handle CreateGroup(hid_t parent, const char* name) {
  const Hdf5Handle properties(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
  H5Pset_attr_phase_change(properties.get(), 32, 31);
  return {H5Gcreate2(parent, name, H5P_DEFAULT, properties.get(), H5P_DEFAULT),
          H5Gclose};
}

bool WriteTouch(hid_t group, const Touch& touch) {
  return WriteNumber(group, "begin_s", touch.begin_s) &&
         WriteNumber(group, "end_s", touch.end_s) &&
         WriteText(group, "label", touch.label) &&
         (!touch.centre ||
          (WriteNumber(group, "row", touch.centre->row) &&
           WriteNumber(group, "column", touch.centre->column))) &&
         WriteText(group, "object", touch.object) &&
         WriteText(group, "material", touch.material) &&
         WriteNumber(group, "stiffness", touch.stiffness) &&
         (touch.object_motion.empty() ||
          WriteObjectMotion(group, touch.object_motion));
}

bool WriteTouches(hid_t trial, const std::vector<Touch>& touches) {
  if (touches.empty()) return true;
  Hdf5Handle all = CreateGroup(trial, "touches");
  if (!all.ok()) return false;
  for (size_t i = 0; i < touches.size(); ++i) {
    Hdf5Handle group = CreateGroup(all.get(), TouchName(i).c_str());
    if (!group.ok() || !WriteTouch(group.get(), touches[i]) || !group.Close()) {
      return false;
    }
  }
  return all.Close();
}

bool WriteTrial(hid_t group, const Trial& trial) {
  const hsize_t frames = trial.time.size();
  static_assert(sizeof(FeatureVector) == kFeatureCount * sizeof(double));
  return WriteDoubles(group, "time", frames, 1, trial.time.data()) &&
         (trial.signals.empty() ||
          WriteDoubles(group, "signals", frames, kFeatureCount,
                       trial.signals[0].data())) &&
         (trial.taxels.empty() || WriteTaxels(group, trial.taxels)) &&
         (trial.poses.empty() || WritePoses(group, trial.poses)) &&
         (trial.object_motion.empty() ||
          WriteObjectMotion(group, trial.object_motion)) &&
         WriteTouches(group, trial.touches) &&
         (trial.source.empty() || WriteText(group, "source", trial.source)) &&
         WriteText(group, "label", trial.label) &&
         WriteText(group, "condition", trial.condition) &&
         WriteText(group, "object", trial.object) &&
         WriteText(group, "material", trial.material) &&
         WriteText(group, "layout", trial.layout) &&
         WriteText(group, "unit", trial.unit) &&
         (!trial.skin || WriteText(group, "skin", LayoutToJson(*trial.skin))) &&
         WriteNumber(group, "stiffness", trial.stiffness) &&
         WriteNumber(group, "velocity", trial.velocity) &&
         WriteNumber(group, "sample_rate_hz", trial.sample_rate_hz);
}

absl::Status RefuseExisting(const std::string& path) {
  if (access(path.c_str(), F_OK) == 0) {
    return IoError(path, "exists already; remove it or allow overwriting");
  }
  return absl::OkStatus();
}

}  // namespace

struct TrialFileWriter::State {
  std::string path;
  DraftFile draft;
  bool overwrite = false;
  bool broken = false;
  std::set<std::string> ids;
  Hdf5Handle file;
  Hdf5Handle trials;

  explicit State(DraftFile new_draft) : draft(std::move(new_draft)) {}
  ~State() {
    const Hdf5Quiet quiet;
    trials.Close();
    file.Close();
  }

  absl::Status Break(absl::string_view what) {
    broken = true;
    return IoError(path, absl::StrCat(what, ": ", Hdf5LastError()));
  }

  std::string FreeId() const {
    size_t number = ids.size();
    std::string id;
    do {
      id = absl::StrFormat("%06d", number++);
    } while (ids.contains(id));
    return id;
  }
};

TrialFileWriter::TrialFileWriter(std::unique_ptr<State> state)
    : state_(std::move(state)) {}
TrialFileWriter::TrialFileWriter(TrialFileWriter&&) noexcept = default;
TrialFileWriter& TrialFileWriter::operator=(TrialFileWriter&&) noexcept =
    default;
TrialFileWriter::~TrialFileWriter() = default;

absl::StatusOr<TrialFileWriter> TrialFileWriter::Create(
    const std::string& path, const TrialFileOptions& options) {
  if (!options.overwrite) TACTUS_RETURN_IF_ERROR(RefuseExisting(path));
  TACTUS_ASSIGN_OR_RETURN(DraftFile draft, DraftFile::Create(path));
  auto state = std::make_unique<State>(std::move(draft));
  state->path = path;
  state->overwrite = options.overwrite;

  const Hdf5Quiet quiet;
  // This range of versions gives every piece of metadata a checksum.
  const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_libver_bounds(access.get(), H5F_LIBVER_V110, H5F_LIBVER_V110);
  state->file = {H5Fcreate(state->draft.path().c_str(), H5F_ACC_TRUNC,
                           H5P_DEFAULT, access.get()),
                 H5Fclose};
  if (!state->file.ok()) return state->Break("cannot be created");
  const hid_t file = state->file.get();
  const int version = 1;
  state->trials = {
      H5Gcreate2(file, "trials", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
      H5Gclose};
  if (!state->trials.ok() || !WriteText(file, "format", "tactus-trials") ||
      !WriteText(file, "creator", "tactus") ||
      !WriteAttribute(file, "version", H5T_NATIVE_INT, H5T_STD_I32LE,
                      &version)) {
    return state->Break("cannot be written");
  }
  return TrialFileWriter(std::move(state));
}

absl::Status TrialFileWriter::Append(const Trial& trial) {
  if (state_ == nullptr) return IoError("trial file", "is closed");
  State& state = *state_;
  if (state.broken) return IoError(state.path, "an earlier write failed");
  TACTUS_RETURN_IF_ERROR(Validate(trial, state.path));
  const std::string id = trial.id.empty() ? state.FreeId() : trial.id;
  if (const std::string fault = TrialIdFault(id); !fault.empty()) {
    return TrialFileInvalid(
        state.path, absl::StrCat("trial ", Quoted(id), ": id: ", fault));
  }
  if (state.ids.size() >= limits::kMaxTrialsPerFile) {
    return TrialFileInvalid(state.path,
                            absl::StrCat("a file holds at most ",
                                         limits::kMaxTrialsPerFile, " trials"));
  }
  if (!state.ids.insert(id).second) {
    return TrialFileInvalid(state.path,
                            absl::StrCat("trial id \"", id, "\" is repeated"));
  }

  const Hdf5Quiet quiet;
  Hdf5Handle group = CreateGroup(state.trials.get(), id.c_str());
  if (!group.ok() || !WriteTrial(group.get(), trial) || !group.Close()) {
    return state.Break(absl::StrCat("trial ", id, " cannot be written"));
  }
  return absl::OkStatus();
}

absl::Status TrialFileWriter::Close() {
  if (state_ == nullptr) return IoError("trial file", "is closed");
  const std::unique_ptr<State> state = std::move(state_);
  if (state->broken) return IoError(state->path, "an earlier write failed");
  const Hdf5Quiet quiet;
  if (!state->trials.Close() || !state->file.Close()) {
    return state->Break("cannot be finished");
  }
  if (!state->overwrite) TACTUS_RETURN_IF_ERROR(RefuseExisting(state->path));
  return state->draft.Publish();
}

}  // namespace tactus::internal
