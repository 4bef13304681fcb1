#include "client/drivers/anyskin/anyskin.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/drivers/calibration/calibration.h"
#include "client/drivers/calibration/tare.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/limits_skin.h"
#include "core/base/status_macros.h"

namespace tactus::internal::client {
namespace {

constexpr int kCrossMagnets = 5;
constexpr int kCrossSide = 3;
// Nominal.
constexpr double kPitchM = 0.007;
// Above most of what a turn in the field of the earth (25 to 65 uT) changes.
constexpr double kContactMicrotesla = 100;
constexpr double kOnsetMicrotesla = 150;
constexpr double kRestS = 1;
// The frames at rest may take this many times as long as at the skin's rate,
// and this much longer.
constexpr int64_t kRestTimes = 2;
constexpr int64_t kRestExtraNs = 2'000'000'000;
// Setup waits for this many frames of a slow skin.
constexpr int64_t kFirstFrames = 8;
// Faster, it would follow a press that rises.
constexpr double kLeastRezeroS = 1;
constexpr double kMostRezeroS = 1e6;

// Which taxel a magnetometer of the cross is, and how its x and y become those
// of the layout: the chips are turned on the board. Row 0 is below, so that y
// points up and z out of the skin.
struct CrossChip {
  size_t taxel;
  int x_of_x;
  int x_of_y;
  int y_of_x;
  int y_of_y;
};
// Centre, left, right, up, down: by the angles of the public viewer.
constexpr CrossChip kCross[kCrossMagnets] = {{4, 0, 1, 1, 0},
                                             {3, 0, 1, 1, 0},
                                             {5, -1, 0, 0, 1},
                                             {7, 0, -1, -1, 0},
                                             {1, 1, 0, 0, -1}};

bool IsCross(int magnets, const SkinLayout& layout) {
  return magnets == kCrossMagnets && layout.rows == kCrossSide &&
         layout.columns == kCrossSide;
}

int64_t PeriodNs(double rate_hz) {
  // A rate that cannot be right is refused by Open.
  const double rate =
      std::clamp(rate_hz, limits::kMinSampleRateHz, limits::kMaxSampleRateHz);
  return std::isnan(rate_hz) ? 1 : std::llround(1e9 / rate);
}

}  // namespace

SkinLayout AnySkinLayout(int magnets) {
  const bool cross = magnets == kCrossMagnets;
  SkinLayout layout = {.name = absl::StrCat("anyskin-", magnets),
                       .rows = cross ? kCrossSide : 1,
                       .columns = cross ? kCrossSide : magnets,
                       .row_pitch_m = kPitchM,
                       .column_pitch_m = kPitchM,
                       .taxel_area_m2 = kPitchM * kPitchM,
                       .unit = TaxelUnit::kCounts,
                       .contact_threshold = kContactMicrotesla,
                       .onset_threshold = kOnsetMicrotesla,
                       .axes = 3,
                       .signed_values = true};
  if (cross) layout.mask = {0, 1, 0, 1, 1, 1, 0, 1, 0};
  return layout;
}

AnySkin::AnySkin(std::string path, const AnySkinOptions& options, Clock* clock)
    : options_(options),
      layout_(options.layout ? *options.layout
                             : AnySkinLayout(options.magnets)),
      period_ns_(PeriodNs(options.sample_rate_hz)),
      clock_(clock),
      port_(std::move(path), options.baud),
      frames_(static_cast<size_t>(
                  std::clamp(options.magnets, 1, limits::kMaxMagnetometers)),
              period_ns_) {}

absl::Status AnySkin::CheckOptions() const {
  const int magnets = options_.magnets;
  if (magnets < 1 || magnets > limits::kMaxMagnetometers) {
    return InvalidConfig("magnetometers", magnets,
                         absl::StrCat("1 to ", limits::kMaxMagnetometers));
  }
  TACTUS_RETURN_IF_ERROR(Validate(layout_));
  if (layout_.axes != static_cast<int>(kAxes) || !layout_.signed_values) {
    return InvalidConfig(
        "axes of the layout of a magnetic skin",
        absl::StrCat(layout_.axes, layout_.signed_values ? ", signed" : ""),
        "3, with signed_values");
  }
  if (Places().empty()) {
    return InvalidConfig(
        "taxels of the layout", layout_.taxels(),
        absl::StrCat(magnets, ", one for each magnetometer",
                     magnets == kCrossMagnets ? ", or 3 x 3" : ""));
  }
  if (!(options_.sample_rate_hz >= limits::kMinSampleRateHz &&
        options_.sample_rate_hz <= limits::kMaxSampleRateHz)) {
    return InvalidConfig("sample_rate_hz", options_.sample_rate_hz,
                         absl::StrCat(limits::kMinSampleRateHz, " to ",
                                      limits::kMaxSampleRateHz));
  }
  if (!(options_.scale > 0 && std::isfinite(options_.scale))) {
    return InvalidConfig("scale", options_.scale, "a number above 0");
  }
  if (options_.rezero_s != 0 && !(options_.rezero_s >= kLeastRezeroS &&
                                  options_.rezero_s <= kMostRezeroS)) {
    return InvalidConfig(
        "rezero_s", options_.rezero_s,
        absl::StrCat("0, or ", kLeastRezeroS, " to ", kMostRezeroS));
  }
  return absl::OkStatus();
}

std::vector<size_t> AnySkin::Places() const {
  std::vector<size_t> places;
  if (IsCross(options_.magnets, layout_)) {
    for (const CrossChip& chip : kCross) places.push_back(chip.taxel);
  } else if (layout_.taxels() == options_.magnets) {
    for (int i = 0; i < options_.magnets; ++i) places.push_back(i);
  }
  return places;
}

absl::Status AnySkin::Open() {
  TACTUS_RETURN_IF_ERROR(CheckOptions());
  places_ = Places();
  values_.assign(static_cast<size_t>(layout_.values()), 0);
  above_.assign(values_.size(), 0);
  frames_.Reset();
  return port_.Open();
}

absl::Status AnySkin::Start() {
  frames_.Reset();
  bytes_before_ = bytes_;
  return absl::OkStatus();
}

absl::StatusOr<SkinInfo> AnySkin::Setup(Clock& clock) {
  TACTUS_RETURN_IF_ERROR(Start());
  const int64_t end_ns = clock.NowNs() + std::max(options_.first_frame_ns,
                                                  kFirstFrames * period_ns_);
  int64_t time_ns = 0;
  while (true) {
    const int64_t left_ns = end_ns - clock.NowNs();
    if (left_ns <= 0) return IoError(name(), Missing());
    TACTUS_ASSIGN_OR_RETURN(const bool came, PollField(time_ns, left_ns));
    if (came) break;
  }
  if (!rest_.empty()) return info_;
  info_.layout = layout_;
  info_.taxel_type = v1::TAXEL_TYPE_FLOAT32;
  info_.scale = options_.scale;
  info_.sample_rate_hz = options_.sample_rate_hz;
  TACTUS_RETURN_IF_ERROR(TakeRest(clock));
  return info_;
}

absl::Status AnySkin::TakeRest(Clock& clock) {
  const auto wanted = std::max(
      kMinTareFrames,
      static_cast<size_t>(std::ceil(kRestS * options_.sample_rate_hz)));
  IdleFrames idle(info_, wanted);
  const int64_t begin_ns = clock.NowNs();
  const int64_t end_ns = begin_ns + kRestExtraNs +
                         kRestTimes * static_cast<int64_t>(wanted) * period_ns_;
  SkinFrame frame;
  int64_t time_ns = 0;
  while (!idle.complete()) {
    const int64_t left_ns = end_ns - clock.NowNs();
    if (left_ns <= 0) {
      const double seconds = static_cast<double>(end_ns - begin_ns) / 1e9;
      return IoError(
          name(), absl::StrFormat(
                      "only %d of %d frames came in %.3g s, and the skin "
                      "is configured for %g Hz: give its rate",
                      idle.frames(), wanted, seconds, options_.sample_rate_hz));
    }
    TACTUS_ASSIGN_OR_RETURN(const bool came, PollField(time_ns, left_ns));
    if (!came) continue;
    Arrange(frame.f32);
    idle.Add(frame);
  }
  auto rest = Tare(idle, nullptr);
  if (!rest.ok()) return Annotate(rest.status(), name());
  FindStill(idle);
  rest_ = *std::move(rest);
  if (options_.rezero_s == 0) return absl::OkStatus();
  drift_.emplace(rest_.size(), DriftTracker::Options{
                                   .time_s = options_.rezero_s,
                                   .sample_rate_hz = options_.sample_rate_hz});
  // Touched is what a model takes for touched.
  Calibration thresholds;
  thresholds.layout = layout_;
  thresholds.deviation.assign(rest_.size(), 0);
  thresholds.contact_threshold.assign(
      static_cast<size_t>(layout_.taxels()),
      layout_.contact_threshold / options_.scale);
  touch_.emplace(thresholds);
  return absl::OkStatus();
}

void AnySkin::FindStill(const IdleFrames& idle) {
  still_.clear();
  for (size_t magnet = 0; magnet < places_.size(); ++magnet) {
    const size_t first = kAxes * places_[magnet];
    bool moves = false;
    for (size_t frame = 1; frame < idle.frames() && !moves; ++frame) {
      moves =
          !std::equal(&idle.Frame(frame)[first],
                      &idle.Frame(frame)[first] + kAxes, &idle.Frame(0)[first]);
    }
    if (!moves) absl::StrAppend(&still_, still_.empty() ? "" : ", ", magnet);
  }
}

std::string AnySkin::Remarks() const {
  if (still_.empty()) return port_.latency();
  return absl::StrCat(port_.latency(), port_.latency().empty() ? "" : "; ",
                      "magnetometers that send the same numbers all the time: ",
                      still_, "; check their wires, or mask their taxels");
}

absl::StatusOr<bool> AnySkin::PollField(int64_t& time_ns, int64_t timeout_ns) {
  if (frames_.Next(field_ut_, time_ns)) return true;
  TACTUS_ASSIGN_OR_RETURN(const size_t count, port_.Read(buffer_, timeout_ns));
  bytes_ += count;
  frames_.Add({buffer_.data(), count}, clock_->NowNs());
  if (!frames_.Next(field_ut_, time_ns)) return false;
  bytes_before_ = bytes_;
  return true;
}

void AnySkin::Arrange(std::vector<float>& values) const {
  values.assign(static_cast<size_t>(layout_.values()), 0);
  const bool cross = IsCross(options_.magnets, layout_);
  for (size_t magnet = 0; magnet < places_.size(); ++magnet) {
    const float* field = &field_ut_[kAxes * magnet];
    float* value = &values[kAxes * places_[magnet]];
    std::copy_n(field, kAxes, value);
    if (!cross) continue;
    const CrossChip& chip = kCross[magnet];
    value[0] = chip.x_of_x * field[0] + chip.x_of_y * field[1];
    value[1] = chip.y_of_x * field[0] + chip.y_of_y * field[1];
  }
}

absl::StatusOr<bool> AnySkin::Poll(SkinFrame& frame, int64_t timeout_ns) {
  TACTUS_ASSIGN_OR_RETURN(const bool came,
                          PollField(frame.capture_time_ns, timeout_ns));
  if (!came) return false;
  Arrange(values_);
  for (size_t i = 0; i < above_.size(); ++i) above_[i] = values_[i] - rest_[i];
  if (drift_) {
    drift_->Step(above_, *touch_, layout_.mask);
    for (size_t i = 0; i < above_.size(); ++i) above_[i] -= drift_->drift()[i];
  }
  frame.u16.clear();
  frame.i16.clear();
  frame.f32.resize(above_.size());
  for (size_t i = 0; i < above_.size(); ++i) {
    // The sum has no negative zero.
    frame.f32[i] = static_cast<float>(above_[i]) + 0.0F;
  }
  return true;
}

std::vector<double> AnySkin::Untouched() const {
  std::vector<double> untouched = rest_;
  for (size_t i = 0; i < untouched.size() && drift_; ++i) {
    untouched[i] += drift_->drift()[i];
  }
  return untouched;
}

std::string AnySkin::Missing() const {
  if (bytes_ == bytes_before_) return "the skin sends nothing";
  const std::string text =
      absl::StrCat(bytes_ - bytes_before_, " bytes came without a whole frame ",
                   "of ", options_.magnets, " magnetometers");
  if (const std::string why = frames_.Refused(); !why.empty()) {
    return absl::StrCat(text, ": ", why);
  }
  const size_t seen = frames_.seen_magnets();
  if (seen > 0 && seen != static_cast<size_t>(options_.magnets)) {
    return absl::StrCat(text, ", but frames of ", seen, ": give that number");
  }
  return absl::StrCat(text, ": check the port, the number of magnetometers (",
                      frames_.frame_bytes(),
                      " bytes are a frame) and that the sketch sends binary "
                      "numbers");
}

}  // namespace tactus::internal::client
