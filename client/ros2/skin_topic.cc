#include "client/ros2/skin_topic.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "client/front/skin_convert.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/import/recorded_frames.h"
#include "core/import/ros2/ros2_taxels.h"

namespace tactus::internal::client {

absl::StatusOr<Skin> SkinOf(const SkinFile& file, bool with_poses) {
  if (file.thresholds_from_idle) {
    return InvalidConfig(
        "thresholds", "\"from idle frames\"",
        "numbers: contact_threshold and onset_threshold, as trainctl import "
        "printed them for the recordings of this skin");
  }
  if (file.events != EventRule::kNone || file.two_planes) {
    return InvalidConfig("events", "given",
                         "absent: a message is a frame of all taxels");
  }
  if (!(file.sample_rate_hz > 0)) {
    return InvalidConfig("sample_rate_hz", file.sample_rate_hz,
                         "the rate of the topic");
  }
  SkinInfo info;
  info.layout = file.layout;
  info.taxel_type = v1::TAXEL_TYPE_FLOAT32;
  info.sample_rate_hz = file.sample_rate_hz;
  info.with_poses = with_poses;
  return ToSkin(info);
}

absl::StatusOr<SkinTopic> SkinTopic::Make(SkinFile file,
                                          const std::string& type,
                                          absl::string_view definition) {
  TACTUS_ASSIGN_OR_RETURN(Ros2Type reader, Ros2Type::Parse(type, definition));
  return SkinTopic(std::move(file), type, std::move(reader));
}

SkinTopic::SkinTopic(SkinFile file, std::string type, Ros2Type reader)
    : file_(std::move(file)),
      type_(std::move(type)),
      reader_(std::move(reader)) {
  if (file_.baseline_from_idle) {
    needs_idle_ = true;
    idle_left_ = file_.idle_frames;
    file_.baseline_from_idle = false;
    file_.baseline = 0;
  }
}

absl::StatusOr<bool> SkinTopic::Read(const DdsMessage& message, Frame& frame) {
  TACTUS_ASSIGN_OR_RETURN(const Ros2Message read, reader_.Read(message.bytes));
  const bool chosen = file_.bag_values != SkinFile().bag_values;
  TACTUS_ASSIGN_OR_RETURN(
      Ros2Taxels taxels, TaxelsOf(type_, read, chosen ? file_.bag_values : ""));
  const size_t size = taxels.numbers.size();
  if (needs_idle_ && idle_sums_.empty()) idle_sums_.assign(size, 0);
  if (needs_idle_ && idle_sums_.size() != size) {
    return TrialFileInvalid("a message", absl::StrCat("has ", size,
                                                      " numbers; those before "
                                                      "it had ",
                                                      idle_sums_.size()));
  }
  if (idle_left_ > 0) {
    for (size_t i = 0; i < size; ++i) idle_sums_[i] += taxels.numbers[i];
    --idle_left_;
    return false;
  }
  for (size_t i = 0; needs_idle_ && i < size; ++i) {
    taxels.numbers[i] -= idle_sums_[i] / file_.idle_frames;
  }
  if (header_.size() != size + 1) {
    header_ = {"time"};
    for (size_t i = 0; i < size; ++i) {
      header_.push_back(absl::StrCat("taxel ", i));
    }
  }
  // As ReadRos2Bag has it: a row with the time and the numbers.
  ArrayFile row;
  row.header = header_;
  row.array.shape = {1, size + 1};
  row.array.f64 = std::move(taxels.numbers);
  row.array.f64.insert(row.array.f64.begin(), 0);
  TACTUS_ASSIGN_OR_RETURN(
      RecordedFrames frames,
      MakeFrames("a message", row, file_, file_.sample_rate_hz));
  frame.values = std::move(frames.taxels.f32);
  frame.capture_time_ns = StampOf(read).value_or(message.published_ns);
  frame.missing_before = 0;
  return true;
}

std::optional<int64_t> StampOf(const Ros2Message& message) {
  const auto seconds = message.numbers.find("header.stamp.sec");
  const auto rest = message.numbers.find("header.stamp.nanosec");
  if (seconds == message.numbers.end() || rest == message.numbers.end() ||
      seconds->second.size() != 1 || rest->second.size() != 1) {
    return std::nullopt;
  }
  const auto time_ns =
      static_cast<int64_t>(seconds->second[0]) * 1'000'000'000 +
      static_cast<int64_t>(rest->second[0]);
  if (time_ns == 0) return std::nullopt;
  return time_ns;
}

}  // namespace tactus::internal::client
