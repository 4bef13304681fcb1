#include "core/data/trial.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"

namespace tactus::internal {
namespace {

// Makes errors that name the file, the trial and the part.
class Complaint {
 public:
  Complaint(const Trial& trial, absl::string_view path)
      : trial_(trial), path_(path) {}

  template <typename... Parts>
  absl::Status operator()(absl::string_view part, const Parts&... text) const {
    return TrialFileInvalid(
        path_, absl::StrCat("trial ", trial_.id, ": ", part, ": ", text...));
  }

 private:
  const Trial& trial_;
  absl::string_view path_;
};

absl::Status ValidateTime(const Trial& trial, const Complaint& complain) {
  const size_t frames = trial.time.size();
  if (frames == 0 || frames > limits::kMaxFramesPerTrial) {
    return complain("time", "has ", frames, " entries; it must have 1 to ",
                    limits::kMaxFramesPerTrial);
  }
  for (size_t i = 0; i < frames; ++i) {
    // Written so that a NaN fails.
    if (!(std::abs(trial.time[i]) <= limits::kMaxTrialTimeS)) {
      return complain("time", "entry ", i, " is ", trial.time[i],
                      " s; it must be finite and at most ",
                      limits::kMaxTrialTimeS, " s from 0");
    }
    if (i > 0 && !(trial.time[i] > trial.time[i - 1])) {
      return complain("time", "entry ", i, " is ", trial.time[i],
                      " s; it must be above the one before, ",
                      trial.time[i - 1], " s");
    }
  }
  return absl::OkStatus();
}

absl::Status ValidateSignals(const Trial& trial, const Complaint& complain) {
  if (trial.signals.empty()) return absl::OkStatus();
  if (trial.signals.size() != trial.time.size()) {
    return complain("signals", "has ", trial.signals.size(),
                    " rows; it must have one per time, ", trial.time.size());
  }
  for (size_t i = 0; i < trial.signals.size(); ++i) {
    for (int f = 0; f < kFeatureCount; ++f) {
      if (!(std::abs(trial.signals[i][f]) <= limits::kMaxSignal)) {
        return complain("signals", FeatureName(static_cast<Feature>(f)),
                        " of row ", i, " is ", trial.signals[i][f],
                        "; it must be finite and at most ", limits::kMaxSignal,
                        " from 0");
      }
    }
  }
  return absl::OkStatus();
}

absl::Status ValidateShape(const Trial& trial, const Complaint& complain) {
  const TaxelSeries& taxels = trial.taxels;
  if (taxels.rows < 1 || taxels.rows > limits::kMaxRows || taxels.columns < 1 ||
      taxels.columns > limits::kMaxColumns) {
    return complain("taxels", "frames are ", taxels.rows, " x ", taxels.columns,
                    "; each side must be 1 to ", limits::kMaxRows);
  }
  const int axes = trial.skin ? trial.skin->axes : 1;
  if (taxels.axes != axes) {
    return complain("taxels", "a taxel has ", taxels.axes,
                    " values; the skin has ", axes, " axes");
  }
  const int types =
      !taxels.u16.empty() + !taxels.i16.empty() + !taxels.f32.empty();
  if (types > 1) {
    return complain("taxels", types, " types are filled; only one may be");
  }
  const size_t count =
      taxels.u16.size() + taxels.i16.size() + taxels.f32.size();
  if (count != trial.time.size() * taxels.frame_size()) {
    return complain("taxels", "has ", count,
                    " values; it must have one frame of ", taxels.frame_size(),
                    " per time, ", trial.time.size());
  }
  return absl::OkStatus();
}

absl::Status ValidateTaxels(const Trial& trial, const Complaint& complain) {
  const TaxelSeries& taxels = trial.taxels;
  if (taxels.empty()) return absl::OkStatus();
  TACTUS_RETURN_IF_ERROR(ValidateShape(trial, complain));
  if (!std::isfinite(taxels.scale) || taxels.scale <= 0 ||
      taxels.scale * 65535 > limits::kMaxTaxelValue) {
    return complain("taxels", "scale is ", taxels.scale,
                    "; it must be above 0 and at most 1e7");
  }
  if (!taxels.f32.empty() && taxels.scale != 1) {
    return complain("taxels", "scale is ", taxels.scale,
                    "; it must be 1 with float values");
  }
  const bool has_sign = trial.skin && trial.skin->signed_values;
  if (!taxels.i16.empty() && !has_sign) {
    return complain("taxels",
                    "are int16; only a skin with signed_values has them");
  }
  const float lowest = has_sign ? -limits::kMaxTaxelValue : 0;
  for (size_t i = 0; i < taxels.f32.size(); ++i) {
    const float value = taxels.f32[i];
    if (!(value >= lowest && value <= limits::kMaxTaxelValue)) {
      return complain("taxels", "taxel ", i % taxels.frame_size() / taxels.axes,
                      " of frame ", i / taxels.frame_size(), " is ", value,
                      "; it must be ", has_sign ? "-1e12" : "0", " to 1e12");
    }
  }
  return absl::OkStatus();
}

absl::Status ValidatePoses(const Trial& trial, const Complaint& complain) {
  if (trial.poses.empty()) return absl::OkStatus();
  if (trial.poses.size() != trial.time.size()) {
    return complain("pose", "has ", trial.poses.size(),
                    " rows; it must have one per time, ", trial.time.size());
  }
  for (size_t i = 0; i < trial.poses.size(); ++i) {
    const Pose& pose = trial.poses[i];
    // Written so that a NaN fails.
    if (!(pose.position.cwiseAbs().maxCoeff() <= limits::kMaxPositionM) ||
        !pose.position.allFinite()) {
      return complain("pose", "position of row ", i,
                      " is not finite or beyond 1e6 m");
    }
    const double norm = pose.orientation.norm();
    if (!(std::abs(norm - 1) <= limits::kQuaternionTolerance)) {
      return complain("pose", "quaternion of row ", i, " has length ", norm,
                      "; it must be 1 to within ",
                      limits::kQuaternionTolerance);
    }
  }
  return absl::OkStatus();
}

absl::Status ValidateObjectMotion(const Trial& trial,
                                  const Complaint& complain) {
  const std::vector<double>& motion = trial.object_motion;
  if (motion.empty()) return absl::OkStatus();
  if (motion.size() != trial.time.size()) {
    return complain("object_motion", "has ", motion.size(),
                    " entries; it must have one per time, ", trial.time.size());
  }
  for (size_t i = 0; i < motion.size(); ++i) {
    // Written so that a NaN fails.
    if (!(std::abs(motion[i]) <= limits::kMaxPositionM)) {
      return complain("object_motion", "entry ", i, " is ", motion[i],
                      "; it must be finite and at most 1e6 m from 0");
    }
  }
  return absl::OkStatus();
}

absl::Status ValidateTouches(const Trial& trial, const Complaint& complain) {
  if (trial.touches.empty()) return absl::OkStatus();
  const std::string fault = TouchesFault(trial.touches, trial.time);
  if (!fault.empty()) return complain("touches", fault);
  if (trial.touches.front().label != trial.label) {
    return complain("touches", "0: label is ",
                    Quoted(trial.touches.front().label),
                    "; it must be the trial's, ", Quoted(trial.label));
  }
  if (!trial.object_motion.empty()) {
    return complain("touches",
                    "the trial has an object_motion; with touches, each of "
                    "them has its own");
  }
  return absl::OkStatus();
}

absl::Status ValidateAttributes(const Trial& trial, const Complaint& complain) {
  struct Text {
    absl::string_view name;
    absl::string_view value;
  };
  const Text texts[] = {
      {"id", trial.id},         {"source", trial.source},
      {"label", trial.label},   {"condition", trial.condition},
      {"object", trial.object}, {"material", trial.material},
      {"layout", trial.layout}};
  for (const Text& text : texts) {
    const std::string fault = TextFault(text.value, limits::kMaxTrialTextBytes);
    if (!fault.empty()) return complain(text.name, fault);
  }
  if (trial.unit != "newton" && trial.unit != "counts") {
    return complain("unit", "is \"", trial.unit,
                    "\"; it must be newton or counts");
  }
  if (!std::isfinite(trial.stiffness) || trial.stiffness < 0) {
    return complain("stiffness", "is ", trial.stiffness,
                    " N/m; it must be finite and at least 0");
  }
  if (!std::isfinite(trial.velocity) || trial.velocity < 0) {
    return complain("velocity", "is ", trial.velocity,
                    " m/s; it must be finite and at least 0");
  }
  if (!(trial.sample_rate_hz >= limits::kMinSampleRateHz &&
        trial.sample_rate_hz <= limits::kMaxSampleRateHz)) {
    return complain("sample_rate_hz", "is ", trial.sample_rate_hz,
                    "; it must be ", limits::kMinSampleRateHz, " to ",
                    limits::kMaxSampleRateHz);
  }
  return absl::OkStatus();
}

// The thing that `skin` says must be what the trial says beside it.
absl::Status ValidateSkin(const Trial& trial, const Complaint& complain) {
  if (!trial.skin) return absl::OkStatus();
  const SkinLayout& skin = *trial.skin;
  if (trial.taxels.empty()) return complain("skin", "given without taxels");
  if (skin.name != trial.layout) {
    return complain("skin", "has the name ", Quoted(skin.name),
                    "; it must be the layout's, ", Quoted(trial.layout));
  }
  if (skin.rows != trial.taxels.rows || skin.columns != trial.taxels.columns) {
    return complain("skin", "is ", skin.rows, " x ", skin.columns,
                    "; the taxels are ", trial.taxels.rows, " x ",
                    trial.taxels.columns);
  }
  if (UnitText(skin.unit) != trial.unit) {
    return complain("skin", "has the unit ", UnitText(skin.unit),
                    "; the trial has ", trial.unit);
  }
  if (const absl::Status status = Validate(skin); !status.ok()) {
    return complain("skin", status.message());
  }
  return absl::OkStatus();
}

}  // namespace

std::string UnitText(TaxelUnit unit) {
  return unit == TaxelUnit::kNewton ? "newton" : "counts";
}

void SetSkin(const SkinLayout& skin, Trial& trial) {
  trial.layout = skin.name;
  trial.unit = UnitText(skin.unit);
  trial.skin = skin;
}

size_t TaxelSeries::frames() const {
  const size_t per_frame = frame_size();
  return per_frame == 0 ? 0
                        : (u16.size() + i16.size() + f32.size()) / per_frame;
}

v1::TaxelType TaxelSeries::type() const {
  if (!u16.empty()) return v1::TAXEL_TYPE_UINT16;
  return i16.empty() ? v1::TAXEL_TYPE_FLOAT32 : v1::TAXEL_TYPE_INT16;
}

std::vector<size_t> TaxelSeries::shape() const {
  std::vector<size_t> shape = {frames(), static_cast<size_t>(rows),
                               static_cast<size_t>(columns)};
  if (axes > 1) shape.push_back(axes);
  return shape;
}

void TaxelSeries::SetShape(const SkinLayout& skin) {
  rows = skin.rows;
  columns = skin.columns;
  axes = skin.axes;
}

void TaxelSeries::Decode(size_t index, float* out) const {
  const size_t per_frame = frame_size();
  const size_t begin = index * per_frame;
  if (!f32.empty()) {
    for (size_t i = 0; i < per_frame; ++i) out[i] = f32[begin + i];
    return;
  }
  if (!i16.empty()) {
    for (size_t i = 0; i < per_frame; ++i) {
      out[i] = static_cast<float>(i16[begin + i] * scale);
    }
    return;
  }
  for (size_t i = 0; i < per_frame; ++i) {
    out[i] = static_cast<float>(u16[begin + i] * scale);
  }
}

absl::Status Validate(const Trial& trial, absl::string_view path) {
  const Complaint complain(trial, path);
  TACTUS_RETURN_IF_ERROR(ValidateTime(trial, complain));
  if (trial.signals.empty() && trial.taxels.empty()) {
    return complain("signals", "missing, and so are taxels; one is needed");
  }
  TACTUS_RETURN_IF_ERROR(ValidateSignals(trial, complain));
  TACTUS_RETURN_IF_ERROR(ValidateTaxels(trial, complain));
  TACTUS_RETURN_IF_ERROR(ValidatePoses(trial, complain));
  TACTUS_RETURN_IF_ERROR(ValidateObjectMotion(trial, complain));
  TACTUS_RETURN_IF_ERROR(ValidateAttributes(trial, complain));
  TACTUS_RETURN_IF_ERROR(ValidateTouches(trial, complain));
  return ValidateSkin(trial, complain);
}

}  // namespace tactus::internal
