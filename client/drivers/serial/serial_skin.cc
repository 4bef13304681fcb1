#include "client/drivers/serial/serial_skin.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/drivers/one_axis.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"

namespace tactus::internal::client {
namespace {

// Setup waits for this many frames of a slow skin.
constexpr int64_t kFirstPeriods = 8;

}  // namespace

SerialSkin::SerialSkin(std::string path, const SerialSkinOptions& options,
                       Clock* clock)
    : options_(options),
      clock_(clock),
      port_(std::move(path), options.baud),
      frames_(options.format, options.layout.rows, options.layout.columns,
              options.layout.mask) {}

absl::Status SerialSkin::Open() {
  TACTUS_RETURN_IF_ERROR(Validate(options_.layout));
  TACTUS_RETURN_IF_ERROR(
      CheckOneAxis("a skin on a serial line", options_.layout));
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
  finders_.clear();
  finders_.emplace_back(SerialFormat::kAscii);
  finders_.emplace_back(SerialFormat::kAa55);
  const int64_t end_ns = clock.NowNs() + std::max(options_.first_frame_ns,
                                                  kFirstPeriods * period_ns());
  SkinFrame frame;
  while (true) {
    const int64_t left_ns = end_ns - clock.NowNs();
    if (left_ns <= 0) return IoError(name(), Missing());
    TACTUS_ASSIGN_OR_RETURN(const bool whole, Poll(frame, left_ns));
    if (whole) break;
  }
  finders_.clear();
  SkinInfo info;
  info.layout = options_.layout;
  info.scale = options_.scale;
  info.sample_rate_hz = options_.sample_rate_hz;
  return info;
}

absl::Status SerialSkin::Start() {
  frames_.Reset();
  bytes_before_ = bytes_;
  blocks_before_ = 0;
  return absl::OkStatus();
}

absl::StatusOr<bool> SerialSkin::Poll(SkinFrame& frame, int64_t timeout_ns) {
  frame.f32.clear();
  if (frames_.Next(frame.u16, frame.capture_time_ns)) return true;
  TACTUS_ASSIGN_OR_RETURN(const size_t count, port_.Read(buffer_, timeout_ns));
  bytes_ += count;
  frames_.Add({buffer_.data(), count}, clock_->NowNs());
  for (SerialShapeFinder& finder : finders_) {
    finder.Add({buffer_.data(), count}, clock_->NowNs());
  }
  if (!frames_.Next(frame.u16, frame.capture_time_ns)) return false;
  bytes_before_ = bytes_;
  blocks_before_ = frames_.seen_shape().blocks;
  return true;
}

int64_t SerialSkin::period_ns() const {
  return std::llround(1e9 / options_.sample_rate_hz);
}

std::string SerialSkin::Missing() const {
  if (bytes_ == bytes_before_) return "the skin sends nothing";
  std::string text = absl::StrCat(
      bytes_ - bytes_before_, " bytes came without a whole frame of ",
      options_.layout.rows, " x ", options_.layout.columns);
  if (const std::string why = frames_.Ambiguity(); !why.empty()) {
    return absl::StrCat(text, ": ", why);
  }
  if (const std::string why = frames_.OutOfRange(); !why.empty()) {
    return absl::StrCat(text, ": ", why);
  }
  const auto rows = static_cast<size_t>(options_.layout.rows);
  const auto columns = static_cast<size_t>(options_.layout.columns);
  for (const SerialShapeFinder& finder : finders_) {
    const auto found = finder.shape();
    if (!found) continue;
    if (found->format != options_.format) {
      const bool ascii = found->format == SerialFormat::kAscii;
      return absl::StrCat(text, ", but frames of ", ToText(*found),
                          ": give --format=", ascii ? "ascii" : "aa55");
    }
    if (found->format == SerialFormat::kAa55 &&
        found->taxels != rows * columns) {
      return absl::StrCat(text, ", but frames of ", found->taxels,
                          " taxels: give a layout of that size, which may be ",
                          ShapesOf(found->taxels));
    }
  }
  const SerialFrames::Shape& seen = frames_.seen_shape();
  if (seen.blocks > blocks_before_ &&
      (seen.rows != rows || seen.columns != columns)) {
    return absl::StrCat(text, ", but frames of ", seen.rows, " x ",
                        seen.columns, ": give a layout of that shape");
  }
  return absl::StrCat(text, ": check baud rate, format and layout");
}

}  // namespace tactus::internal::client
