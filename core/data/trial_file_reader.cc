#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/data/trial_file.h"
#include "core/files/hdf5_handle.h"
#include "core/files/hdf5_probe.h"
#include "core/files/hdf5_read.h"
#include "core/skin/layout_json.h"

namespace tactus::internal {
namespace {

absl::Status ReadTaxels(hid_t group, hsize_t frames,
                        const Hdf5Complaint& complain, TaxelSeries* out) {
  constexpr char kName[] = "taxels";
  TACTUS_ASSIGN_OR_RETURN(const bool has, HasHardLink(group, kName, complain));
  if (!has) return absl::OkStatus();
  Hdf5Dataset dataset;
  TACTUS_RETURN_IF_ERROR(OpenDataset(group, kName, complain, &dataset));
  const hid_t type = dataset.type.get();
  const size_t bytes = H5Tget_size(type);
  const bool integer = H5Tget_class(type) == H5T_INTEGER && bytes == 2;
  const bool has_sign = integer && H5Tget_sign(type) != H5T_SGN_NONE;
  if (!integer && !(H5Tget_class(type) == H5T_FLOAT && bytes == 4)) {
    return complain(kName, "must be uint16, int16 or float32");
  }
  const bool has_axes = dataset.dims.size() == 4;
  if ((dataset.dims.size() == 3 || has_axes) &&
      (dataset.dims[1] > limits::kMaxRows ||
       dataset.dims[2] > limits::kMaxColumns)) {
    return complain(kName, "frames are ", dataset.dims[1], " x ",
                    dataset.dims[2], "; each side must be 1 to ",
                    limits::kMaxRows);
  }
  std::vector<hsize_t> want = {frames, 0, 0};
  if (has_axes) want.push_back(3);
  TACTUS_RETURN_IF_ERROR(CheckShape(dataset, kName, want, bytes, complain));
  out->rows = static_cast<int>(dataset.dims[1]);
  out->columns = static_cast<int>(dataset.dims[2]);
  out->axes = has_axes ? 3 : 1;
  const size_t count = frames * out->frame_size();
  if (!integer) {
    out->f32.resize(count);
    return ReadValues(dataset, kName, H5T_NATIVE_FLOAT, complain,
                      out->f32.data());
  }
  TACTUS_RETURN_IF_ERROR(
      ReadNumber(dataset.id.get(), "scale", complain, &out->scale));
  if (has_sign) {
    out->i16.resize(count);
    return ReadValues(dataset, kName, H5T_NATIVE_INT16, complain,
                      out->i16.data());
  }
  out->u16.resize(count);
  return ReadValues(dataset, kName, H5T_NATIVE_UINT16, complain,
                    out->u16.data());
}

absl::Status ReadArrays(hid_t group, const Hdf5Complaint& complain,
                        Trial* trial) {
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

  return ReadDoubles(group, "object_motion", frames, 0, complain,
                     &trial->object_motion);
}

absl::Status ReadTouch(hid_t group, const Hdf5Complaint& complain,
                       Touch* touch) {
  double row = std::nan("");
  double column = std::nan("");
  const std::pair<const char*, double*> numbers[] = {
      {"begin_s", &touch->begin_s},
      {"end_s", &touch->end_s},
      {"stiffness", &touch->stiffness},
      {"row", &row},
      {"column", &column},
  };
  for (const auto& [name, value] : numbers) {
    TACTUS_RETURN_IF_ERROR(ReadNumber(group, name, complain, value));
  }
  if (!std::isnan(row) || !std::isnan(column)) {
    touch->centre = SkinPoint{row, column};
  }
  const std::pair<const char*, std::string*> texts[] = {
      {"label", &touch->label},
      {"object", &touch->object},
      {"material", &touch->material},
  };
  for (const auto& [name, value] : texts) {
    TACTUS_RETURN_IF_ERROR(ReadText(group, name, complain, value));
  }
  return ReadDoubles(group, "object_motion", 0, 0, complain,
                     &touch->object_motion);
}

absl::Status ReadTouches(hid_t trial, const Hdf5Complaint& complain,
                         std::vector<Touch>* touches) {
  TACTUS_ASSIGN_OR_RETURN(const bool has,
                          HasHardLink(trial, "touches", complain));
  if (!has) return absl::OkStatus();
  const Hdf5Handle all(H5Gopen2(trial, "touches", H5P_DEFAULT), H5Gclose);
  if (!all.ok()) return complain.Hdf5("touches");
  TACTUS_ASSIGN_OR_RETURN(const std::vector<std::string> names,
                          ListNames(all.get(), complain));
  if (names.size() > limits::kMaxTouchesPerTrial) {
    return complain("touches", "there are ", names.size(), "; at most ",
                    limits::kMaxTouchesPerTrial, " are allowed");
  }
  for (const std::string& name : names) {
    TACTUS_RETURN_IF_ERROR(
        HasHardLink(all.get(), name.c_str(), complain).status());
    const Hdf5Handle group(H5Gopen2(all.get(), name.c_str(), H5P_DEFAULT),
                           H5Gclose);
    if (!group.ok()) return complain.Hdf5("touches");
    TACTUS_RETURN_IF_ERROR(
        ReadTouch(group.get(), complain, &touches->emplace_back()));
  }
  return absl::OkStatus();
}

absl::Status ReadAttributes(hid_t group, const Hdf5Complaint& complain,
                            Trial* trial) {
  const std::pair<const char*, std::string*> texts[] = {
      {"source", &trial->source},       {"label", &trial->label},
      {"condition", &trial->condition}, {"object", &trial->object},
      {"material", &trial->material},   {"layout", &trial->layout},
      {"unit", &trial->unit},
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

// The skin that was read last. All trials of a file have the same one, as a
// rule, and it takes longer to parse than to compare.
struct LastSkin {
  std::string text;
  SkinLayout skin;
};

absl::Status ReadSkin(hid_t group, const Hdf5Complaint& complain,
                      LastSkin* last, Trial* trial) {
  std::string text;
  TACTUS_RETURN_IF_ERROR(ReadText(group, "skin", complain, &text));
  if (text.empty()) return absl::OkStatus();
  if (text != last->text) {
    auto skin = LayoutFromJson(text);
    if (!skin.ok()) return complain("skin", skin.status().message());
    *last = {std::move(text), *std::move(skin)};
  }
  trial->skin = last->skin;
  return absl::OkStatus();
}

// True if the superblock says version 2 or above: all metadata of the file
// reachable without a global heap (where text of variable length lies) has
// checksums.
bool HasChecksums(const std::string& path) {
  constexpr char kSignature[] = "\x89HDF\r\n\x1a\n";
  char head[9] = {};
  std::ifstream(path, std::ios::binary).read(head, sizeof(head));
  return std::memcmp(head, kSignature, 8) == 0 && head[8] >= 2;
}

// True if TrialFileWriter made the file: all its metadata has checksums and
// none of its text has variable length.
bool IsOwnFile(const std::string& path, hid_t file) {
  const Hdf5Complaint complain(path, "");
  Hdf5Handle attribute;
  Hdf5Handle type;
  std::string creator;
  return HasChecksums(path) &&
         OpenScalarAttribute(file, "creator", complain, &attribute, &type)
             .ok() &&
         H5Tis_variable_str(type.get()) == 0 &&
         ReadText(file, "creator", complain, &creator).ok() &&
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
  LastSkin last_skin;

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
  TACTUS_RETURN_IF_ERROR(ProbeInChild(path, [&path] {
    TACTUS_ASSIGN_OR_RETURN(const auto reader, OpenUnprobed(path));
    const Hdf5Quiet quiet;
    if (IsOwnFile(path, reader.state_->file.get())) return absl::OkStatus();
    for (size_t i = 0; i < reader.size(); ++i) {
      TACTUS_RETURN_IF_ERROR(reader.Read(i).status());
    }
    return absl::OkStatus();
  }));
  return OpenUnprobed(path);
}

absl::StatusOr<TrialFileReader> TrialFileReader::OpenUnprobed(
    const std::string& path) {
  const Hdf5Quiet quiet;
  const Hdf5Complaint complain(path, "");
  auto state = std::make_unique<State>();
  state->path = path;
  state->file = {H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose};
  if (!state->file.ok())
    return complain.Hdf5(
        "is no trial file (HDF5), as trainctl import makes one of recordings, "
        "or damaged");
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
  const Hdf5Complaint complain(state_->path, trial.id);
  const hid_t trials = state_->trials.get();
  TACTUS_RETURN_IF_ERROR(
      HasHardLink(trials, trial.id.c_str(), complain).status());
  const Hdf5Handle group(H5Gopen2(trials, trial.id.c_str(), H5P_DEFAULT),
                         H5Gclose);
  if (!group.ok()) return complain.Hdf5("group");
  TACTUS_RETURN_IF_ERROR(ReadArrays(group.get(), complain, &trial));
  TACTUS_RETURN_IF_ERROR(ReadAttributes(group.get(), complain, &trial));
  TACTUS_RETURN_IF_ERROR(ReadTouches(group.get(), complain, &trial.touches));
  TACTUS_RETURN_IF_ERROR(
      ReadSkin(group.get(), complain, &state_->last_skin, &trial));
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

}  // namespace tactus::internal
