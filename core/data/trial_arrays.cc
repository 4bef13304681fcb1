#include "core/data/trial_arrays.h"

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/files/npy_write.h"
#include "core/files/npz.h"
#include "core/skin/layout_json.h"

namespace tactus::internal {
namespace {

constexpr size_t kPoseSize = 7;

// As in a trial file, so that "touches/00/label" is the first touch's label.
std::string TouchPrefix(size_t index) {
  return absl::StrCat("touches/", TouchName(index), "/");
}

void AddPoses(const std::vector<Pose>& poses, NamedArrays* arrays) {
  std::vector<double> values;
  for (const Pose& pose : poses) {
    const Eigen::Quaterniond& q = pose.orientation;
    values.insert(values.end(),
                  {pose.position.x(), pose.position.y(), pose.position.z(),
                   q.x(), q.y(), q.z(), q.w()});
  }
  arrays->emplace_back("pose", NpyBytes({poses.size(), kPoseSize},
                                        std::span<const double>(values)));
}

void AddTaxels(const TaxelSeries& taxels, NamedArrays* arrays) {
  const std::vector<size_t> shape = taxels.shape();
  std::string& bytes = arrays->emplace_back("taxels", "").second;
  if (!taxels.u16.empty()) {
    bytes = NpyBytes(shape, std::span<const uint16_t>(taxels.u16));
  } else if (!taxels.i16.empty()) {
    bytes = NpyBytes(shape, std::span<const int16_t>(taxels.i16));
  } else {
    bytes = NpyBytes(shape, std::span<const float>(taxels.f32));
  }
  arrays->emplace_back("taxel_scale",
                       NpyBytes({}, std::span(&taxels.scale, 1)));
}

void AddTouches(const std::vector<Touch>& touches, NamedArrays* arrays) {
  for (size_t i = 0; i < touches.size(); ++i) {
    const Touch& touch = touches[i];
    const std::string prefix = TouchPrefix(i);
    const auto number = [&](const char* name, const double& value) {
      arrays->emplace_back(prefix + name, NpyBytes({}, std::span(&value, 1)));
    };
    number("begin_s", touch.begin_s);
    number("end_s", touch.end_s);
    arrays->emplace_back(prefix + "label", NpyText(touch.label));
    if (touch.centre) {
      number("row", touch.centre->row);
      number("column", touch.centre->column);
    }
    arrays->emplace_back(prefix + "object", NpyText(touch.object));
    arrays->emplace_back(prefix + "material", NpyText(touch.material));
    number("stiffness", touch.stiffness);
    if (touch.object_motion.empty()) continue;
    arrays->emplace_back(
        prefix + "object_motion",
        NpyBytes({touch.object_motion.size()},
                 std::span<const double>(touch.object_motion)));
  }
}

// Texts and numbers of a trial by their names in files.
std::vector<std::pair<absl::string_view, std::string*>> TextsOf(Trial& trial) {
  return {{"source", &trial.source},
          {"label", &trial.label},
          {"condition", &trial.condition},
          {"object", &trial.object},
          {"material", &trial.material},
          {"layout", &trial.layout},
          {"unit", &trial.unit}};
}

std::vector<std::pair<absl::string_view, double*>> NumbersOf(Trial& trial) {
  return {{"stiffness", &trial.stiffness},
          {"velocity", &trial.velocity},
          {"sample_rate_hz", &trial.sample_rate_hz},
          {"taxel_scale", &trial.taxels.scale}};
}

// Takes the arrays of one archive, each once.
class TrialArrays {
 public:
  TrialArrays(absl::string_view path, NpzArrays arrays)
      : path_(path), arrays_(std::move(arrays)) {}

  // Fills `out` with an array of real numbers whose shape is `shape`, where 0
  // takes any size. Leaves `out` as it is if there is no such array.
  absl::Status Numbers(absl::string_view name, const std::vector<size_t>& shape,
                       std::vector<double>* out) {
    auto node = arrays_.extract(std::string(name));
    if (node.empty()) return absl::OkStatus();
    const NpyArray& array = node.mapped();
    TACTUS_RETURN_IF_ERROR(CheckShape(name, array, shape));
    out->assign(array.f64.begin(), array.f64.end());
    out->insert(out->end(), array.f32.begin(), array.f32.end());
    out->insert(out->end(), array.i64.begin(), array.i64.end());
    if (!array.text.empty() || !array.u16.empty() || !array.i16.empty()) {
      return Invalid(name, "must be floating-point numbers");
    }
    return absl::OkStatus();
  }

  absl::Status Number(absl::string_view name, double* out) {
    std::vector<double> values;
    TACTUS_RETURN_IF_ERROR(Numbers(name, {}, &values));
    if (!values.empty()) *out = values.front();
    return absl::OkStatus();
  }

  absl::Status Text(absl::string_view name, std::string* out) {
    auto node = arrays_.extract(std::string(name));
    if (node.empty()) return absl::OkStatus();
    TACTUS_RETURN_IF_ERROR(CheckShape(name, node.mapped(), {}));
    if (node.mapped().text.empty()) return Invalid(name, "must be text");
    *out = node.mapped().text.front();
    return absl::OkStatus();
  }

  // Fills `out` with touch `index`; nothing if the archive has no such touch.
  absl::Status OneTouch(size_t index, std::optional<Touch>* out) {
    const std::string prefix = TouchPrefix(index);
    if (!arrays_.contains(prefix + "begin_s")) return absl::OkStatus();
    Touch& touch = out->emplace();
    double row = std::nan("");
    double column = std::nan("");
    const std::pair<const char*, double*> numbers[] = {
        {"begin_s", &touch.begin_s},
        {"end_s", &touch.end_s},
        {"stiffness", &touch.stiffness},
        {"row", &row},
        {"column", &column},
    };
    for (const auto& [name, value] : numbers) {
      TACTUS_RETURN_IF_ERROR(Number(prefix + name, value));
    }
    if (!std::isnan(row) || !std::isnan(column)) {
      touch.centre = SkinPoint{row, column};
    }
    TACTUS_RETURN_IF_ERROR(Text(prefix + "label", &touch.label));
    TACTUS_RETURN_IF_ERROR(Text(prefix + "object", &touch.object));
    TACTUS_RETURN_IF_ERROR(Text(prefix + "material", &touch.material));
    return Numbers(prefix + "object_motion", {0}, &touch.object_motion);
  }

  absl::Status Touches(std::vector<Touch>* out) {
    for (size_t i = 0; i < limits::kMaxTouchesPerTrial; ++i) {
      std::optional<Touch> touch;
      TACTUS_RETURN_IF_ERROR(OneTouch(i, &touch));
      if (!touch) break;
      out->push_back(*std::move(touch));
    }
    return absl::OkStatus();
  }

  absl::Status Skin(std::optional<SkinLayout>* out) {
    std::string text;
    TACTUS_RETURN_IF_ERROR(Text("skin", &text));
    if (text.empty()) return absl::OkStatus();
    auto skin = LayoutFromJson(text);
    if (!skin.ok()) return Invalid("skin", skin.status().message());
    *out = *std::move(skin);
    return absl::OkStatus();
  }

  absl::Status Taxels(size_t frames, TaxelSeries* out) {
    auto node = arrays_.extract("taxels");
    if (node.empty()) return absl::OkStatus();
    NpyArray& array = node.mapped();
    std::vector<size_t> shape = {frames, 0, 0};
    if (array.shape.size() == 4) shape.push_back(3);
    TACTUS_RETURN_IF_ERROR(CheckShape("taxels", array, shape));
    if (array.shape[1] > limits::kMaxRows ||
        array.shape[2] > limits::kMaxColumns) {
      return Invalid(
          "taxels",
          absl::StrCat("has frames of ", array.shape[1], " x ", array.shape[2],
                       "; each side must be 1 to ", limits::kMaxRows));
    }
    if (array.u16.empty() && array.i16.empty() && array.f32.empty()) {
      return Invalid("taxels", "must be uint16, int16 or float32");
    }
    out->rows = static_cast<int>(array.shape[1]);
    out->columns = static_cast<int>(array.shape[2]);
    out->axes = array.shape.size() == 4 ? 3 : 1;
    out->u16 = std::move(array.u16);
    out->i16 = std::move(array.i16);
    out->f32 = std::move(array.f32);
    return absl::OkStatus();
  }

  // An error if an array is left.
  absl::Status CheckAllTaken() const {
    if (arrays_.empty()) return absl::OkStatus();
    return Invalid(
        arrays_.begin()->first,
        "is of no use; use time, signals, taxels, taxel_scale, "
        "pose, object_motion, source, label, condition, object, material, "
        "layout, skin, unit, stiffness, velocity, sample_rate_hz and "
        "touches/00/begin_s and so on (docs/formats.md)");
  }

 private:
  absl::Status Invalid(absl::string_view name, absl::string_view what) const {
    return TrialFileInvalid(path_, absl::StrCat("array ", name, " ", what));
  }

  absl::Status CheckShape(absl::string_view name, const NpyArray& array,
                          const std::vector<size_t>& want) const {
    bool fits = array.shape.size() == want.size();
    for (size_t i = 0; fits && i < want.size(); ++i) {
      fits = array.shape[i] > 0 && (want[i] == 0 || array.shape[i] == want[i]);
    }
    if (fits) return absl::OkStatus();
    std::vector<std::string> sizes;
    for (const size_t size : want) {
      sizes.push_back(size == 0 ? "any" : absl::StrCat(size));
    }
    return Invalid(
        name, absl::StrCat("has shape (", absl::StrJoin(array.shape, ", "),
                           "); it must be (", absl::StrJoin(sizes, ", "), ")"));
  }

  std::string path_;
  NpzArrays arrays_;
};

}  // namespace

absl::StatusOr<NamedArrays> TrialToArrays(const Trial& trial) {
  TACTUS_RETURN_IF_ERROR(Validate(trial, "export"));
  const size_t frames = trial.time.size();
  NamedArrays arrays;
  arrays.emplace_back("time",
                      NpyBytes({frames}, std::span<const double>(trial.time)));
  if (!trial.signals.empty()) {
    static_assert(sizeof(FeatureVector) == kFeatureCount * sizeof(double));
    arrays.emplace_back("signals", NpyBytes({frames, kFeatureCount},
                                            std::span(trial.signals[0].data(),
                                                      kFeatureCount * frames)));
  }
  if (!trial.taxels.empty()) AddTaxels(trial.taxels, &arrays);
  if (!trial.poses.empty()) AddPoses(trial.poses, &arrays);
  if (!trial.object_motion.empty()) {
    arrays.emplace_back(
        "object_motion",
        NpyBytes({frames}, std::span<const double>(trial.object_motion)));
  }
  AddTouches(trial.touches, &arrays);
  Trial attributes;
  attributes.source = trial.source;
  attributes.label = trial.label;
  attributes.condition = trial.condition;
  attributes.object = trial.object;
  attributes.material = trial.material;
  attributes.layout = trial.layout;
  attributes.unit = trial.unit;
  for (const auto& [name, text] : TextsOf(attributes)) {
    if (name == "source" && text->empty()) continue;
    arrays.emplace_back(name, NpyText(*text));
  }
  if (trial.skin) {
    arrays.emplace_back("skin", NpyText(LayoutToJson(*trial.skin)));
  }
  const std::pair<const char*, double> numbers[] = {
      {"stiffness", trial.stiffness},
      {"velocity", trial.velocity},
      {"sample_rate_hz", trial.sample_rate_hz}};
  for (const auto& [name, number] : numbers) {
    arrays.emplace_back(name, NpyBytes({}, std::span(&number, 1)));
  }
  return arrays;
}

absl::StatusOr<Trial> TrialFromArrays(absl::string_view path, NpzArrays named) {
  TrialArrays arrays(path, std::move(named));
  Trial trial;
  TACTUS_RETURN_IF_ERROR(arrays.Numbers("time", {0}, &trial.time));
  const size_t frames = trial.time.size();
  if (frames == 0) return TrialFileInvalid(path, "has no array time");
  std::vector<double> values;
  TACTUS_RETURN_IF_ERROR(
      arrays.Numbers("signals", {frames, kFeatureCount}, &values));
  for (size_t i = 0; i < values.size(); i += kFeatureCount) {
    trial.signals.push_back({values[i], values[i + 1], values[i + 2]});
  }
  TACTUS_RETURN_IF_ERROR(arrays.Taxels(frames, &trial.taxels));
  values.clear();
  TACTUS_RETURN_IF_ERROR(arrays.Numbers("pose", {frames, kPoseSize}, &values));
  for (size_t i = 0; i < values.size(); i += kPoseSize) {
    Pose& pose = trial.poses.emplace_back();
    pose.position = {values[i], values[i + 1], values[i + 2]};
    pose.orientation = Eigen::Quaterniond(values[i + 6], values[i + 3],
                                          values[i + 4], values[i + 5]);
  }
  TACTUS_RETURN_IF_ERROR(
      arrays.Numbers("object_motion", {frames}, &trial.object_motion));
  for (const auto& [name, text] : TextsOf(trial)) {
    TACTUS_RETURN_IF_ERROR(arrays.Text(name, text));
  }
  TACTUS_RETURN_IF_ERROR(arrays.Skin(&trial.skin));
  for (const auto& [name, number] : NumbersOf(trial)) {
    TACTUS_RETURN_IF_ERROR(arrays.Number(name, number));
  }
  TACTUS_RETURN_IF_ERROR(arrays.Touches(&trial.touches));
  TACTUS_RETURN_IF_ERROR(arrays.CheckAllTaken());
  TACTUS_RETURN_IF_ERROR(Validate(trial, path));
  return trial;
}

}  // namespace tactus::internal
