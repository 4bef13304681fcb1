#include "client/drivers/serial/serial_skin.h"

#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"

namespace tactus::client {
SerialSkin::SerialSkin(std::string path, const SerialSkinOptions& options,
                       Clock* clock)
    : options_(options),
      clock_(clock),
      port_(std::move(path), options.baud),
      frames_(options.format, options.layout.rows, options.layout.columns) {}

absl::Status SerialSkin::Open() {
  TACTUS_RETURN_IF_ERROR(Validate(options_.layout));
  if (!(options_.sample_rate_hz >= limits::kMinSampleRateHz &&
        options_.sample_rate_hz <= limits::kMaxSampleRateHz)) {
    return InvalidConfig("sample_rate_hz", options_.sample_rate_hz,
                         absl::StrCat(limits::kMinSampleRateHz, " to ",
                                      limits::kMaxSampleRateHz));
  }
  frames_.Reset();
  return port_.Open();
}

absl::StatusOr<SkinInfo> SerialSkin::Setup(Clock& clock) {
  TACTUS_RETURN_IF_ERROR(Start());
  finder_.emplace(options_.format);
  const int64_t end_ns = clock.NowNs() + options_.first_frame_ns;
  SkinFrame frame;
  while (true) {
    const int64_t left_ns = end_ns - clock.NowNs();
    if (left_ns <= 0) return IoError(name(), Missing());
    TACTUS_ASSIGN_OR_RETURN(const bool whole, Poll(frame, left_ns));
    if (whole) break;
  }
  finder_.reset();
  SkinInfo info;
  info.layout = options_.layout;
  info.scale = options_.scale;
  info.sample_rate_hz = options_.sample_rate_hz;
  return info;
}

absl::Status SerialSkin::Start() {
  frames_.Reset();
  bytes_at_start_ = bytes_;
  return absl::OkStatus();
}

absl::StatusOr<bool> SerialSkin::Poll(SkinFrame& frame, int64_t timeout_ns) {
  frame.f32.clear();
  if (frames_.Next(frame.u16, frame.capture_time_ns)) return true;
  TACTUS_ASSIGN_OR_RETURN(const size_t count, port_.Read(buffer_, timeout_ns));
  bytes_ += count;
  frames_.Add({buffer_.data(), count}, clock_->NowNs());
  if (finder_) finder_->Add({buffer_.data(), count}, clock_->NowNs());
  return frames_.Next(frame.u16, frame.capture_time_ns);
}

int64_t SerialSkin::period_ns() const {
  return std::llround(1e9 / options_.sample_rate_hz);
}

std::string SerialSkin::Missing() const {
  if (bytes_ == bytes_at_start_) return "the skin sends nothing";
  std::string text = absl::StrCat(
      bytes_ - bytes_at_start_, " bytes came without a whole frame of ",
      options_.layout.rows, " x ", options_.layout.columns);
  const SerialFrames::Shape& seen = frames_.seen_shape();
  const auto found = finder_ ? finder_->shape() : std::nullopt;
  if (found && found->format == SerialFormat::kAa55) {
    absl::StrAppend(&text, ", but frames of ", found->taxels,
                    " taxels: give a layout of that size, which may be ",
                    ShapesOf(found->taxels));
  } else if (seen.rows > 0) {
    absl::StrAppend(&text, ", but frames of ", seen.rows, " x ", seen.columns,
                    ": give a layout of that shape");
  } else {
    absl::StrAppend(&text, ": check baud rate, format and layout");
  }
  return text;
}

}  // namespace tactus::client
