#include "client/drivers/anyskin/magnet_frames.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

#include "absl/strings/str_format.h"
#include "core/base/limits_skin.h"

namespace tactus::internal::client {
namespace {

static_assert(std::endian::native == std::endian::little,
              "numbers are copied as they come");

constexpr uint8_t kReturn = '\r';
constexpr uint8_t kNewLine = '\n';
constexpr size_t kEndBytes = 2;
// Temperature, x, y and z.
constexpr size_t kNumbers = 4;
constexpr size_t kMagnetBytes = kNumbers * sizeof(float);
// The sketch computes 16-bit readings times a sensitivity: at most 0.62 T at
// the coarsest setting of the chip, and temperatures of -998 to 452 degrees.
constexpr float kMostMicrotesla = 1e6F;
constexpr float kMostDegrees = 1e3F;
// What rounding leaves of 0 degrees is larger.
constexpr float kLeastNumber = 1e-6F;
constexpr size_t kMaxWaitingFrames = 64;
// So many frames with impossible numbers are reported even if no good frame
// came before them. So many equal distances tell the number of magnetometers.
constexpr uint64_t kSureMisfits = 3;
constexpr uint64_t kSureDistances = 5;
// A frame's time goes this part of the way from an even period to its arrival,
// so that times follow a skin whose period differs.
constexpr int64_t kPull = 16;
// Lost frames that are counted by their bytes.
constexpr uint64_t kMostLost = 1'000;

bool IsReading(float number, float most) {
  const float size = std::abs(number);
  return size == 0 || (size >= kLeastNumber && size <= most);
}

}  // namespace

MagnetFrames::MagnetFrames(size_t magnets, int64_t period_ns)
    : magnets_(magnets), period_ns_(period_ns), ring_(kMaxWaitingFrames) {
  bytes_.reserve(frame_bytes() + 2 * kEndBytes);
  reading_.reserve(magnets_ * (kNumbers - 1));
}

size_t MagnetFrames::frame_bytes() const {
  return magnets_ * kMagnetBytes + kEndBytes;
}

void MagnetFrames::Add(std::span<const uint8_t> bytes, int64_t now_ns) {
  fresh_ = 0;
  for (const uint8_t byte : bytes) {
    WatchEnds(byte);
    bytes_.push_back(byte);
    while (Take()) {
    }
  }
  if (fresh_ > 0) Stamp(now_ns);
}

bool MagnetFrames::Next(std::vector<float>& field_ut, int64_t& time_ns) {
  if (waiting_ == 0) return false;
  std::swap(field_ut, ring_[first_].field_ut);
  time_ns = ring_[first_].time_ns;
  first_ = (first_ + 1) % ring_.size();
  --waiting_;
  return true;
}

void MagnetFrames::Reset() {
  bytes_.clear();
  in_step_ = false;
  dropped_ = 0;
  first_ = waiting_ = fresh_ = 0;
  last_ns_.reset();
  bad_.reset();
  misfits_ = 0;
  refused_ = false;
  since_end_ = distance_ = equal_distances_ = 0;
  last_byte_ = 0;
}

bool MagnetFrames::IsEnd(size_t at) const {
  return bytes_[at] == kReturn && bytes_[at + 1] == kNewLine;
}

bool MagnetFrames::Read(std::vector<float>& field_ut) {
  field_ut.clear();
  for (size_t magnet = 0; magnet < magnets_; ++magnet) {
    float numbers[kNumbers];
    std::memcpy(numbers, &bytes_[kEndBytes + magnet * kMagnetBytes],
                sizeof numbers);
    for (size_t i = 0; i < kNumbers; ++i) {
      if (!IsReading(numbers[i], i == 0 ? kMostDegrees : kMostMicrotesla)) {
        bad_ = {.magnet = magnet, .number = i, .value = numbers[i]};
        return false;
      }
      if (i > 0) field_ut.push_back(numbers[i]);
    }
  }
  return true;
}

bool MagnetFrames::Take() {
  if (bytes_.size() < kEndBytes) return false;
  if (!IsEnd(0)) {
    ++counters_.skipped_bytes;
    Drop(1);
    return true;
  }
  // The end of the frame before is its beginning.
  const size_t end = frame_bytes();
  if (bytes_.size() < end + kEndBytes) return false;
  const bool whole = IsEnd(end);
  if (whole && Read(reading_)) {
    Deliver();
    in_step_ = true;
    misfits_ = 0;
    Drop(end);
    dropped_ = 0;
    return true;
  }
  if (whole) ++misfits_;
  if (in_step_) {
    ++counters_.spoiled;
    if (whole) {
      // It begins and ends where frames do, and so the next one is found.
      ++counters_.out_of_range;
      refused_ = true;
      Drop(end);
      return true;
    }
    in_step_ = false;
  }
  ++counters_.skipped_bytes;
  Drop(1);
  return true;
}

void MagnetFrames::Deliver() {
  if (waiting_ == ring_.size()) {
    first_ = (first_ + 1) % ring_.size();
    --waiting_;
    ++counters_.overwritten;
  }
  Frame& frame = ring_[(first_ + waiting_) % ring_.size()];
  std::swap(frame.field_ut, reading_);
  const uint64_t period = frame_bytes();
  frame.lost = static_cast<int64_t>(
      std::min((dropped_ + period / 2) / period, kMostLost));
  ++waiting_;
  fresh_ = std::min(fresh_ + 1, ring_.size());
  ++counters_.frames;
}

void MagnetFrames::Drop(size_t bytes) {
  bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<ptrdiff_t>(bytes));
  dropped_ += bytes;
}

void MagnetFrames::Stamp(int64_t now_ns) {
  const size_t begin = first_ + waiting_ - fresh_;
  const auto frame = [&](size_t i) -> Frame& {
    return ring_[(begin + i) % ring_.size()];
  };
  int64_t after_first_ns = 0;
  for (size_t i = 1; i < fresh_; ++i) {
    after_first_ns += (1 + frame(i).lost) * period_ns_;
  }
  const int64_t latest_ns = now_ns - after_first_ns;
  int64_t time_ns = latest_ns;
  if (last_ns_) {
    const int64_t even_ns = *last_ns_ + (1 + frame(0).lost) * period_ns_;
    time_ns = std::clamp(even_ns + (latest_ns - even_ns) / kPull,
                         latest_ns - period_ns_, latest_ns);
  }
  for (size_t i = 0; i < fresh_; ++i) {
    if (i > 0) time_ns += (1 + frame(i).lost) * period_ns_;
    if (last_ns_) time_ns = std::max(time_ns, *last_ns_ + 1);
    frame(i).time_ns = time_ns;
    last_ns_ = time_ns;
  }
}

void MagnetFrames::WatchEnds(uint8_t byte) {
  ++since_end_;
  const bool ends = last_byte_ == kReturn && byte == kNewLine;
  last_byte_ = byte;
  if (!ends) return;
  equal_distances_ = since_end_ == distance_ ? equal_distances_ + 1 : 1;
  distance_ = since_end_;
  since_end_ = 0;
}

size_t MagnetFrames::seen_magnets() const {
  const size_t most = limits::kMaxMagnetometers * kMagnetBytes + kEndBytes;
  if (equal_distances_ < kSureDistances || distance_ <= kEndBytes ||
      distance_ > most || (distance_ - kEndBytes) % kMagnetBytes != 0) {
    return 0;
  }
  return (distance_ - kEndBytes) / kMagnetBytes;
}

std::string MagnetFrames::Refused() const {
  if (!bad_ || (!refused_ && misfits_ < kSureMisfits)) return "";
  const std::string number =
      bad_->number == 0
          ? absl::StrFormat("a temperature of %g degrees", bad_->value)
          : absl::StrFormat("a field of %g uT along %c", bad_->value,
                            "xyz"[bad_->number - 1]);
  return absl::StrFormat(
      "magnetometer %d sent %s; frames must have temperatures of -%g to %g "
      "degrees and fields of -%g to %g uT: check its wires and the sketch",
      bad_->magnet, number, kMostDegrees, kMostDegrees, kMostMicrotesla,
      kMostMicrotesla);
}

}  // namespace tactus::internal::client
