#include "core/import/recorded_frames.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/import/event_frames.h"
#include "core/import/frame_columns.h"
#include "core/import/rising_columns.h"

namespace tactus::internal {
namespace {

constexpr size_t kPoseNumbers = 7;

Pose PoseOf(const std::array<double, kPoseNumbers>& v) {
  Pose pose;
  pose.position = {v[0], v[1], v[2]};
  // Eigen's constructor takes w first.
  pose.orientation = {v[6], v[3], v[4], v[5]};
  return pose;
}

// A frame's numbers, in the order of the file, for any kind of file.
struct Numbers {
  // [frames x taxels of the file].
  std::vector<double> values;
  std::vector<double> time;
  std::vector<Pose> poses;
};

Numbers TakeNumbers(const ArrayFile& file, const FrameColumns& columns,
                    double time_scale_s) {
  Numbers numbers;
  const size_t frames = file.array.shape[0];
  const size_t width = file.size() / std::max<size_t>(frames, 1);
  for (size_t t = 0; t < frames; ++t) {
    const auto at = [&](size_t column) {
      return file.Number(t * width + column);
    };
    for (const size_t column : columns.taxels) {
      numbers.values.push_back(at(column));
    }
    for (const size_t column : columns.time) {
      numbers.time.push_back(at(column) * time_scale_s);
    }
    if (columns.pose.empty()) continue;
    std::array<double, kPoseNumbers> pose;
    for (size_t i = 0; i < pose.size(); ++i) pose[i] = at(columns.pose[i]);
    numbers.poses.push_back(PoseOf(pose));
  }
  return numbers;
}

// The taxels' baselines, in the order of the file.
absl::StatusOr<std::vector<double>> Baselines(const std::string& path,
                                              const std::vector<double>& values,
                                              const SkinFile& skin) {
  const size_t size = skin.frame_size();
  std::vector<double> baselines(size, skin.baseline);
  if (!skin.baseline_from_idle) return baselines;
  const auto idle = static_cast<size_t>(skin.idle_frames);
  if (values.size() < idle * size) {
    return TrialFileInvalid(
        path, absl::StrCat("has ", values.size() / size,
                           " frames; the baseline is taken from ", idle));
  }
  for (size_t i = 0; i < size; ++i) {
    baselines[i] = 0;
    for (size_t t = 0; t < idle; ++t) baselines[i] += values[t * size + i];
    baselines[i] /= static_cast<double>(idle);
  }
  return baselines;
}

absl::Status Convert(const std::string& path, const std::vector<double>& values,
                     const SkinFile& skin, TaxelSeries& taxels) {
  TACTUS_ASSIGN_OR_RETURN(const std::vector<double> baselines,
                          Baselines(path, values, skin));
  const size_t size = skin.frame_size();
  const SkinLayout& layout = skin.layout;
  const auto places = static_cast<size_t>(layout.values());
  const double gain = skin.pressing_lowers ? -skin.scale : skin.scale;
  const std::vector<uint8_t> mask = ValueMask(layout);
  taxels.f32.assign(values.size() / size * places, 0);
  for (size_t i = 0; i < values.size(); ++i) {
    const size_t number = i % size;
    const size_t place = skin.PlaceOf(number);
    const bool auxiliary = std::ranges::binary_search(
        layout.auxiliary, static_cast<uint32_t>(place / layout.axes));
    double value = values[i];
    if (!auxiliary) {
      value = gain * (value - baselines[number]);
      if (value < 0 && skin.negative_values == NegativeValues::kZero) value = 0;
      if (value < 0 && skin.negative_values == NegativeValues::kAbsolute) {
        value = -value;
      }
    }
    const double lowest =
        layout.signed_values && (auxiliary || !skin.unsigned_touch)
            ? -limits::kMaxTaxelValue
            : 0;
    // Written so that a NaN fails. A masked taxel may hold anything.
    if (!mask.empty() && mask[place] == 0) value = 0;
    if (!(value >= lowest && value <= limits::kMaxTaxelValue)) {
      return TrialFileInvalid(
          path,
          absl::StrCat("taxel ", number / layout.axes, " of frame ", i / size,
                       " is ", value, "; it must be ", lowest, " to 1e12",
                       value < 0 && lowest == 0
                           ? ". If values below zero are right, say in "
                             "skin.json what they mean: baseline, pressing, "
                             "negative_values or signed_values"
                           : ""));
    }
    // No negative zero.
    taxels.f32[i / size * places + place] = static_cast<float>(value) + 0.0F;
  }
  return absl::OkStatus();
}

// True if the stored numbers times the scale are the values.
bool StaysU16(const ArrayFile& file, const SkinFile& skin) {
  return !file.array.u16.empty() && skin.cells.empty() && skin.baseline == 0 &&
         !skin.baseline_from_idle && !skin.pressing_lowers &&
         skin.events == EventRule::kNone;
}

}  // namespace

absl::StatusOr<RecordedFrames> MakeFrames(const std::string& path,
                                          const ArrayFile& file,
                                          const SkinFile& skin,
                                          double rate_hz) {
  RecordedFrames frames;
  frames.taxels.SetShape(skin.layout);
  if (skin.events != EventRule::kNone) {
    TACTUS_ASSIGN_OR_RETURN(EventFrames events,
                            MakeEventFrames(path, file, skin, rate_hz));
    TACTUS_RETURN_IF_ERROR(Convert(path, events.numbers, skin, frames.taxels));
    frames.time = std::move(events.time);
    return frames;
  }
  TACTUS_ASSIGN_OR_RETURN(const FrameColumns columns,
                          FindFrameColumns(path, file, skin));
  frames.found = columns.found;
  const size_t width = file.size() / std::max<size_t>(file.array.shape[0], 1);
  if (StaysU16(file, skin) && columns.taxels.size() == width &&
      std::is_sorted(columns.taxels.begin(), columns.taxels.end())) {
    frames.taxels.u16 = file.array.u16;
    frames.taxels.scale = skin.scale;
    return frames;
  }
  Numbers numbers = TakeNumbers(file, columns, skin.time_scale_s);
  TACTUS_RETURN_IF_ERROR(Convert(path, numbers.values, skin, frames.taxels));
  frames.time = std::move(numbers.time);
  frames.poses = std::move(numbers.poses);
  if (!columns.taxels_are_named) {
    // A joint may sweep steadily: columns that are named are what they are.
    const size_t named = skin.auxiliary_columns.empty()
                             ? 0
                             : skin.layout.auxiliary.size() * skin.layout.axes;
    std::vector<size_t> others = columns.taxels;
    others.resize(others.size() - named);
    frames.rising = FindRising(file, others);
  }
  return frames;
}

absl::StatusOr<std::vector<Pose>> MakePoses(const std::string& path,
                                            const ArrayFile& file) {
  const std::vector<size_t>& shape = file.array.shape;
  if (shape.size() != 2 || shape[1] != kPoseNumbers) {
    return TrialFileInvalid(
        path, absl::StrCat("has shape ", absl::StrJoin(shape, " x "),
                           "; poses are frames x 7: ",
                           absl::StrJoin(PoseColumns(), ", ")));
  }
  std::vector<Pose> poses;
  for (size_t t = 0; t < shape[0]; ++t) {
    std::array<double, kPoseNumbers> values;
    for (size_t i = 0; i < values.size(); ++i) {
      values[i] = file.Number(t * values.size() + i);
    }
    poses.push_back(PoseOf(values));
  }
  return poses;
}

}  // namespace tactus::internal
