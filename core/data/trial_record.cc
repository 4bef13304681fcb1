#include "core/data/trial_record.h"

#include <bit>
#include <cstring>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/base/wire_check.h"
#include "core/data/trial_layout.h"
#include "core/skin/layout_proto.h"
#include "core/skin/taxel_values.h"

namespace tactus::internal {
namespace {

// Arrays of values are copied as they lie in memory.
static_assert(std::endian::native == std::endian::little);

constexpr size_t kPoseNumbers = 7;
constexpr char kPath[] = "record";

// Makes errors that name the trial and the field.
class RecordComplaint {
 public:
  explicit RecordComplaint(const std::string& id) : id_(id) {}

  template <typename... Parts>
  absl::Status operator()(absl::string_view field, const Parts&... text) const {
    return InvalidTrial(
        absl::StrCat("trial ", id_, ": ", field, ": ", text...));
  }

 private:
  const std::string& id_;
};

v1::TaxelUnit UnitToProto(const std::string& unit) {
  return unit == "counts" ? v1::TAXEL_UNIT_COUNTS : v1::TAXEL_UNIT_NEWTON;
}

// If the skin is not known, the geometry has only what the trial says of it.
v1::SensorGeometry GeometryOf(const Trial& trial) {
  if (const auto layout = LayoutOfTrial(trial); layout.ok()) {
    return LayoutToProto(*layout);
  }
  v1::SensorGeometry geometry;
  geometry.set_layout(trial.layout);
  geometry.set_rows(trial.taxels.rows);
  geometry.set_columns(trial.taxels.columns);
  if (trial.taxels.axes > 1) geometry.set_axes(trial.taxels.axes);
  geometry.set_unit(UnitToProto(trial.unit));
  return geometry;
}

absl::Status TakeGeometry(const v1::SensorGeometry& geometry,
                          const RecordComplaint& complain, Trial* trial) {
  const auto layout = LayoutFromProto(geometry);
  if (!layout.ok()) return complain("geometry", layout.status().message());
  const std::string unit = UnitText(layout->unit);
  if (trial->unit != unit) {
    return complain("unit", "is ", trial->unit, "; that of the geometry is ",
                    unit);
  }
  SetSkin(*layout, *trial);
  trial->taxels.SetShape(*layout);
  return absl::OkStatus();
}

absl::Status TakeUnit(const v1::TrialRecord& record,
                      const RecordComplaint& complain, Trial* trial) {
  switch (record.unit()) {
    case v1::TAXEL_UNIT_NEWTON:
      trial->unit = "newton";
      break;
    case v1::TAXEL_UNIT_COUNTS:
      trial->unit = "counts";
      break;
    default:
      return complain("unit", "is ", static_cast<int>(record.unit()),
                      "; it must be TAXEL_UNIT_NEWTON or TAXEL_UNIT_COUNTS");
  }
  return absl::OkStatus();
}

// An array of `per_frame` numbers a frame, or an empty one.
absl::Status CheckLength(absl::string_view field, size_t length,
                         size_t per_frame, size_t frames,
                         const RecordComplaint& complain) {
  if (length == 0 || length == per_frame * frames) return absl::OkStatus();
  return complain(field, "has ", length, " numbers; it must have ", per_frame,
                  " per time, ", per_frame * frames);
}

absl::Status CheckShapes(const v1::TrialRecord& record,
                         const RecordComplaint& complain) {
  const size_t frames = record.time_size();
  if (frames == 0 || frames > limits::kMaxFramesPerTrial) {
    return complain("time", "has ", frames, " entries; it must have 1 to ",
                    limits::kMaxFramesPerTrial);
  }
  TACTUS_RETURN_IF_ERROR(CheckLength("signals", record.signals_size(),
                                     kFeatureCount, frames, complain));
  TACTUS_RETURN_IF_ERROR(CheckLength("poses", record.poses_size(), kPoseNumbers,
                                     frames, complain));
  return CheckLength("object_motion", record.object_motion_size(), 1, frames,
                     complain);
}

absl::Status TakeTaxels(const v1::TrialRecord& record,
                        const RecordComplaint& complain, Trial* trial) {
  if (record.taxels().empty()) {
    if (record.has_geometry()) {
      return complain("geometry", "is given without taxels");
    }
    return absl::OkStatus();
  }
  if (!record.has_geometry()) {
    return complain("geometry", "is missing; taxels need one");
  }
  TACTUS_RETURN_IF_ERROR(TakeGeometry(record.geometry(), complain, trial));
  TaxelSeries& taxels = trial->taxels;
  const size_t value_bytes = TaxelBytes(record.taxel_type());
  if (value_bytes == 0) {
    return complain("taxel_type", "is ", static_cast<int>(record.taxel_type()),
                    "; it must be TAXEL_TYPE_UINT16, TAXEL_TYPE_INT16 or "
                    "TAXEL_TYPE_FLOAT32");
  }
  const size_t count = taxels.frame_size() * record.time_size();
  const std::string& bytes = record.taxels();
  if (bytes.size() != count * value_bytes) {
    return complain(
        "taxels", "has ", bytes.size(), " bytes; it must have one frame of ",
        taxels.rows, " x ", taxels.columns,
        taxels.axes > 1 ? " x 3 values per time, " : " values per time, ",
        count * value_bytes, " bytes");
  }
  if (record.taxel_type() == v1::TAXEL_TYPE_UINT16) {
    taxels.scale = record.scale();
    taxels.u16.resize(count);
    std::memcpy(taxels.u16.data(), bytes.data(), bytes.size());
    return absl::OkStatus();
  }
  if (record.taxel_type() == v1::TAXEL_TYPE_INT16) {
    taxels.scale = record.scale();
    taxels.i16.resize(count);
    std::memcpy(taxels.i16.data(), bytes.data(), bytes.size());
    return absl::OkStatus();
  }
  if (record.scale() != 0) {
    return complain("scale", "is ", record.scale(),
                    "; it must be 0 with TAXEL_TYPE_FLOAT32");
  }
  taxels.f32.resize(count);
  std::memcpy(taxels.f32.data(), bytes.data(), bytes.size());
  return absl::OkStatus();
}

void AddTouch(const Touch& touch, v1::TrialRecord* record) {
  v1::Touch& to = *record->add_touches();
  to.set_begin_s(touch.begin_s);
  to.set_end_s(touch.end_s);
  to.set_label(touch.label);
  if (touch.centre) {
    to.set_row(touch.centre->row);
    to.set_column(touch.centre->column);
  }
  to.set_object(touch.object);
  to.set_material(touch.material);
  to.set_stiffness(touch.stiffness);
  to.mutable_object_motion()->Add(touch.object_motion.begin(),
                                  touch.object_motion.end());
}

absl::Status TakeTouches(const v1::TrialRecord& record,
                         const RecordComplaint& complain, Trial* trial) {
  for (const v1::Touch& from : record.touches()) {
    Touch& touch = trial->touches.emplace_back();
    touch.begin_s = from.begin_s();
    touch.end_s = from.end_s();
    touch.label = from.label();
    if (from.has_row() != from.has_column()) {
      return complain("touches", trial->touches.size() - 1,
                      ": has a row or a column alone; give both or none");
    }
    if (from.has_row()) touch.centre = SkinPoint{from.row(), from.column()};
    touch.object = from.object();
    touch.material = from.material();
    touch.stiffness = from.stiffness();
    touch.object_motion.assign(from.object_motion().begin(),
                               from.object_motion().end());
  }
  return absl::OkStatus();
}

void TakeArrays(const v1::TrialRecord& record, Trial* trial) {
  trial->time.assign(record.time().begin(), record.time().end());
  trial->signals.resize(record.signals_size() / kFeatureCount);
  for (int i = 0; i < record.signals_size(); ++i) {
    trial->signals[i / kFeatureCount][i % kFeatureCount] = record.signals(i);
  }
  trial->poses.resize(record.poses_size() / kPoseNumbers);
  for (size_t i = 0; i < trial->poses.size(); ++i) {
    const double* numbers = record.poses().data() + i * kPoseNumbers;
    trial->poses[i].position = {numbers[0], numbers[1], numbers[2]};
    trial->poses[i].orientation.coeffs() = {numbers[3], numbers[4], numbers[5],
                                            numbers[6]};
  }
  trial->object_motion.assign(record.object_motion().begin(),
                              record.object_motion().end());
}

}  // namespace

v1::TrialRecord ToRecord(const Trial& trial) {
  v1::TrialRecord record;
  record.set_id(trial.id);
  record.set_source(trial.source);
  record.set_label(trial.label);
  record.set_condition(trial.condition);
  record.set_object(trial.object);
  record.set_material(trial.material);
  record.set_stiffness(trial.stiffness);
  record.set_velocity(trial.velocity);
  record.set_sample_rate_hz(trial.sample_rate_hz);
  record.set_unit(UnitToProto(trial.unit));
  record.mutable_time()->Add(trial.time.begin(), trial.time.end());
  for (const FeatureVector& signals : trial.signals) {
    record.mutable_signals()->Add(signals.begin(), signals.end());
  }
  for (const Pose& pose : trial.poses) {
    const double* position = pose.position.data();
    const double* orientation = pose.orientation.coeffs().data();
    record.mutable_poses()->Add(position, position + 3);
    record.mutable_poses()->Add(orientation, orientation + 4);
  }
  record.mutable_object_motion()->Add(trial.object_motion.begin(),
                                      trial.object_motion.end());
  for (const Touch& touch : trial.touches) AddTouch(touch, &record);
  const TaxelSeries& taxels = trial.taxels;
  if (taxels.empty()) return record;
  *record.mutable_geometry() = GeometryOf(trial);
  record.set_taxel_type(taxels.type());
  if (!taxels.u16.empty()) {
    record.set_scale(taxels.scale);
    record.set_taxels(taxels.u16.data(), taxels.u16.size() * sizeof(uint16_t));
  } else if (!taxels.i16.empty()) {
    record.set_scale(taxels.scale);
    record.set_taxels(taxels.i16.data(), taxels.i16.size() * sizeof(int16_t));
  } else {
    record.set_taxels(taxels.f32.data(), taxels.f32.size() * sizeof(float));
  }
  return record;
}

absl::StatusOr<v1::TrialRecord> ParseTrialRecord(absl::string_view bytes,
                                                 absl::string_view name) {
  const WireCheck check = CheckWire(*v1::TrialRecord::descriptor(), bytes);
  if (!check.fault.empty()) {
    return InvalidTrial(
        absl::StrCat(name, " is not a tactus.v1.TrialRecord: ", check.fault));
  }
  const int64_t most = ParsedBytesAtMost(static_cast<int64_t>(bytes.size()));
  if (check.parsed_bytes > most) {
    return InvalidTrial(absl::StrCat(name, " has ", bytes.size(),
                                     " bytes and takes ", check.parsed_bytes,
                                     " bytes of memory; it may take ", most));
  }
  v1::TrialRecord record;
  if (!record.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
    return InvalidTrial(absl::StrCat(
        name, " is not a tactus.v1.TrialRecord: a text in it is not UTF-8"));
  }
  return record;
}

int64_t ParsedBytesAtMost(int64_t record_bytes) {
  // A small record may take more memory than its size says.
  constexpr int64_t kSlack = 64L * 1024;
  return 2 * record_bytes + kSlack;
}

absl::StatusOr<v1::TrialRecord> StoredTrialRecord(const std::string& bytes,
                                                  absl::string_view path) {
  v1::TrialRecord record;
  if (!record.ParseFromString(bytes)) {
    return DataLost(path, "the trial cannot be parsed");
  }
  return record;
}

absl::StatusOr<Trial> FromRecord(const v1::TrialRecord& record) {
  const std::string fault =
      record.id().empty() ? "is empty; it must have 1 to 256 bytes"
                          : TextFault(record.id(), limits::kMaxTrialTextBytes);
  if (!fault.empty()) {
    return InvalidTrial(
        absl::StrCat("trial ", Quoted(record.id()), ": id: ", fault));
  }
  const RecordComplaint complain(record.id());
  TACTUS_RETURN_IF_ERROR(CheckShapes(record, complain));
  Trial trial;
  trial.id = record.id();
  trial.source = record.source();
  trial.label = record.label();
  trial.condition = record.condition();
  trial.object = record.object();
  trial.material = record.material();
  trial.stiffness = record.stiffness();
  trial.velocity = record.velocity();
  trial.sample_rate_hz = record.sample_rate_hz();
  TACTUS_RETURN_IF_ERROR(TakeUnit(record, complain, &trial));
  TACTUS_RETURN_IF_ERROR(TakeTaxels(record, complain, &trial));
  TakeArrays(record, &trial);
  TACTUS_RETURN_IF_ERROR(TakeTouches(record, complain, &trial));
  if (const absl::Status status = Validate(trial, kPath); !status.ok()) {
    return InvalidTrial(
        absl::StripPrefix(status.message(), absl::StrCat(kPath, ": ")));
  }
  return trial;
}

}  // namespace tactus::internal
