#include "client/drivers/serial/serial_shape.h"

#include <algorithm>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "core/base/limits.h"

namespace tactus::internal::client {
namespace {

constexpr uint8_t kSyncFirst = 0xAA;
constexpr uint8_t kSyncSecond = 0x55;
constexpr uint64_t kSyncBytes = 2;
// Frames of one shape that make sure that it is one.
constexpr uint64_t kSure = 5;
// Sync words that are kept. A taxel may look like one.
constexpr size_t kMaxSyncs = 256;
constexpr auto kMaxDistance =
    static_cast<uint64_t>(limits::kMaxTaxels) + kSyncBytes;

}  // namespace

std::string ToText(const SerialShape& shape) {
  const std::string size = shape.rows > 0
                               ? absl::StrCat(shape.rows, " x ", shape.columns)
                               : absl::StrCat(shape.taxels);
  return absl::StrFormat(
      "%s taxels at %.1f Hz in %s", size, shape.rate_hz,
      shape.format == SerialFormat::kAscii ? "ascii" : "aa55");
}

std::string ShapesOf(size_t taxels) {
  std::vector<std::string> shapes;
  for (size_t rows = 1; rows <= limits::kMaxRows; ++rows) {
    if (taxels == 0 || taxels % rows != 0) continue;
    if (taxels / rows > limits::kMaxColumns) continue;
    shapes.push_back(absl::StrCat(rows, " x ", taxels / rows));
  }
  return shapes.empty() ? "none" : absl::StrJoin(shapes, ", ");
}

SerialShapeFinder::SerialShapeFinder(SerialFormat format)
    : format_(format), lines_(SerialFormat::kAscii, 1, 1) {}

void SerialShapeFinder::Add(std::span<const uint8_t> bytes, int64_t now_ns) {
  for (const uint8_t byte : bytes) {
    if (format_ == SerialFormat::kAscii) {
      AddAscii(byte, now_ns);
    } else {
      AddBinary(byte, now_ns);
    }
  }
}

std::optional<SerialShape> SerialShapeFinder::shape() const {
  if (shape_.frames < kSure) return std::nullopt;
  SerialShape shape = shape_;
  const auto span_ns = static_cast<double>(last_ns_ - first_ns_);
  if (span_ns > 0) {
    shape.rate_hz = 1e9 * static_cast<double>(shape.frames - 1) / span_ns;
  }
  return shape;
}

void SerialShapeFinder::AddAscii(uint8_t byte, int64_t now_ns) {
  lines_.Add({&byte, 1}, now_ns);
  const SerialFrames::Shape& seen = lines_.seen_shape();
  if (seen.blocks == blocks_) return;
  blocks_ = seen.blocks;
  if (seen.rows != shape_.rows || seen.columns != shape_.columns) {
    shape_ = {.format = SerialFormat::kAscii,
              .taxels = seen.rows * seen.columns,
              .rows = seen.rows,
              .columns = seen.columns};
    first_ns_ = seen.time_ns;
  }
  ++shape_.frames;
  last_ns_ = seen.time_ns;
}

void SerialShapeFinder::AddBinary(uint8_t byte, int64_t now_ns) {
  ++bytes_;
  if (bytes_ > 1 && last_byte_ == kSyncFirst && byte == kSyncSecond) {
    TakeSync({.at = bytes_ - kSyncBytes, .time_ns = last_byte_ns_});
  } else if (distance_ > 0 && bytes_ == next_ + kSyncBytes) {
    // The sync word is missing where it must be.
    distance_ = 0;
    shape_.frames = 0;
  }
  last_byte_ = byte;
  last_byte_ns_ = now_ns;
}

void SerialShapeFinder::TakeSync(const Sync& sync) {
  syncs_.push_back(sync);
  if (syncs_.size() > kMaxSyncs) syncs_.pop_front();
  if (distance_ > 0) {
    if (sync.at != next_) return;
    ++shape_.frames;
    last_ns_ = sync.time_ns;
    next_ += distance_;
    return;
  }
  // The smallest distance at which the last ones lie.
  for (size_t i = syncs_.size() - 1; i-- > 0;) {
    const uint64_t distance = sync.at - syncs_[i].at;
    if (distance > kMaxDistance) return;
    if (distance <= kSyncBytes) continue;
    const Sync* first = &sync;
    for (uint64_t back = 1; back < kSure && first != nullptr; ++back) {
      const uint64_t before = back * distance;
      first = before <= sync.at ? Find(sync.at - before) : nullptr;
    }
    if (first == nullptr) continue;
    distance_ = distance;
    next_ = sync.at + distance;
    shape_ = {.format = SerialFormat::kAa55,
              .taxels = static_cast<size_t>(distance - kSyncBytes),
              .frames = kSure};
    first_ns_ = first->time_ns;
    last_ns_ = sync.time_ns;
    return;
  }
}

const SerialShapeFinder::Sync* SerialShapeFinder::Find(uint64_t at) const {
  const auto found =
      std::lower_bound(syncs_.begin(), syncs_.end(), at,
                       [](const Sync& s, uint64_t a) { return s.at < a; });
  return found != syncs_.end() && found->at == at ? &*found : nullptr;
}

}  // namespace tactus::internal::client
