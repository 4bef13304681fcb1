#include "client/drivers/serial/serial_frames.h"

#include <algorithm>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"

namespace tactus::internal::client {
namespace {

constexpr uint8_t kFirst = 0xAA;
constexpr uint8_t kSecond = 0x55;
constexpr size_t kHeader = 2;
// Periods in which a header must come before frames count, and from which on
// another place is a rival.
constexpr size_t kPeriods = 3;
constexpr size_t kRivalPeriods = 2;
// Numbers of ascii.
constexpr double kMostValue = 65'535;
// Frames that wait to be taken.
constexpr size_t kMaxWaiting = 64;
// Characters for each number of a line, with room.
constexpr size_t kCharactersPerNumber = 8;
// Lines of other shapes are understood up to so many numbers.
constexpr size_t kMostColumns = 64;

// A number as skins write it: digits, perhaps with a minus and a point.
bool IsNumber(absl::string_view word, double* value) {
  return word.find_first_not_of("0123456789.-") == absl::string_view::npos &&
         absl::SimpleAtod(word, value);
}

bool IsTaxel(absl::string_view word, double value) {
  return value <= kMostValue &&
         word.find_first_not_of("0123456789") == absl::string_view::npos;
}

}  // namespace

SerialFrames::SerialFrames(SerialFormat format, int rows, int columns,
                           std::vector<uint8_t> mask)
    : format_(format),
      rows_(static_cast<size_t>(std::max(rows, 1))),
      columns_(static_cast<size_t>(std::max(columns, 1))),
      mask_(std::move(mask)) {}

void SerialFrames::Add(std::span<const uint8_t> bytes, int64_t now_ns) {
  for (const uint8_t byte : bytes) {
    if (format_ == SerialFormat::kAscii) {
      AddAscii(byte, now_ns);
    } else {
      AddBinary(byte, now_ns);
    }
  }
}

bool SerialFrames::Next(std::vector<uint16_t>& taxels, int64_t& time_ns) {
  if (whole_.empty()) return false;
  taxels = std::move(whole_.front().taxels);
  time_ns = whole_.front().time_ns;
  whole_.pop_front();
  return true;
}

void SerialFrames::Reset() {
  whole_.clear();
  line_.clear();
  current_.taxels.clear();
  lines_ = 0;
  good_ = long_line_ = whole_block_ = right_shape_ = unfit_ = refused_ = false;
  least_ = most_ = 0;
  unfit_word_.clear();
  seen_shape_ = {};
  found_ = false;
  bytes_.clear();
  times_.clear();
  places_.clear();
}

std::string SerialFrames::OutOfRange() const {
  if (!refused_) return "";
  const std::string which =
      most_ > kMostValue ? absl::StrFormat("values up to %.6g", most_)
      : least_ < 0       ? absl::StrFormat("values down to %.6g", least_)
                         : absl::StrCat("the value ", unfit_word_);
  return absl::StrFormat("%s came; ascii takes whole numbers from 0 to %.0f",
                         which, kMostValue);
}

std::string SerialFrames::Ambiguity() const {
  if (places_.size() < kHeader) return "";
  // Where the other one is, if each of the two is the header.
  const size_t ahead = places_[1] - places_[0];
  const size_t back = period() - ahead;
  return absl::StrFormat(
      "AA 55 comes at %d places of each %d bytes, the first two %d and %d "
      "bytes "
      "apart, so where frames begin is not known: either taxels %d and %d "
      "always read AA 55, or taxels %d and %d do. Mask the two that are stuck "
      "(--mask=%d,%d or --mask=%d,%d), or have the firmware send at most A9 "
      "for "
      "a taxel",
      places_.size(), period(), ahead, back, ahead - 2, ahead - 1, back - 2,
      back - 1, ahead - 2, ahead - 1, back - 2, back - 1);
}

void SerialFrames::Deliver(Frame frame) {
  if (whole_.size() == kMaxWaiting) {
    whole_.pop_front();
    ++counters_.overwritten;
  }
  whole_.push_back(std::move(frame));
  ++counters_.frames;
}

void SerialFrames::AddAscii(uint8_t byte, int64_t now_ns) {
  if (byte == '\r') return;
  if (byte == '\n') return EndLine();
  if (line_.size() >= std::max(columns_, kMostColumns) * kCharactersPerNumber) {
    long_line_ = true;
    ++counters_.skipped_bytes;
    return;
  }
  if (line_.empty() && lines_ == 0) current_.time_ns = now_ns;
  line_.push_back(static_cast<char>(byte));
}

void SerialFrames::EndLine() {
  const std::vector<absl::string_view> words =
      absl::StrSplit(line_, absl::ByAnyChar(" ,\t"), absl::SkipEmpty());
  if (words.empty() && !long_line_) {
    EndAsciiFrame();
  } else {
    ++lines_;
    const bool right =
        !long_line_ && words.size() == columns_ && lines_ <= rows_;
    if (lines_ == 1) block_columns_ = words.size();
    if (block_columns_ != words.size() || long_line_) block_columns_ = 0;
    right_shape_ = right_shape_ && right;
    good_ = good_ && right;
    for (const absl::string_view word : words) {
      double value = 0;
      if (!IsNumber(word, &value)) {
        block_columns_ = 0;
        right_shape_ = good_ = false;
      } else if (!IsTaxel(word, value)) {
        unfit_ = true;
        good_ = false;
        if (right_shape_) {
          unfit_word_ = std::string(word);
          least_ = std::min(least_, value);
          most_ = std::max(most_, value);
        }
      }
      if (good_) current_.taxels.push_back(static_cast<uint16_t>(value));
    }
    if (!good_) counters_.skipped_bytes += line_.size();
  }
  line_.clear();
  long_line_ = false;
}

void SerialFrames::EndAsciiFrame() {
  if (lines_ > 0) {
    if (good_ && lines_ == rows_) {
      Deliver({.taxels = current_.taxels, .time_ns = current_.time_ns});
    } else {
      ++counters_.spoiled;
      if (right_shape_ && unfit_ && lines_ == rows_) {
        ++counters_.out_of_range;
        refused_ = true;
      }
    }
    if (whole_block_ && block_columns_ > 0) {
      seen_shape_ = {.rows = lines_,
                     .columns = block_columns_,
                     .time_ns = current_.time_ns,
                     .blocks = seen_shape_.blocks + 1};
    }
  }
  current_.taxels.clear();
  lines_ = 0;
  unfit_ = false;
  good_ = whole_block_ = right_shape_ = true;
}

void SerialFrames::AddBinary(uint8_t byte, int64_t now_ns) {
  bytes_.push_back(byte);
  times_.push_back(now_ns);
  while (found_ ? TakeBinary() : FindHeader()) {
  }
}

size_t SerialFrames::period() const { return kHeader + rows_ * columns_; }

bool SerialFrames::IsHeader(size_t at) const {
  return bytes_[at] == kFirst && bytes_[at + 1] == kSecond;
}

bool SerialFrames::FindHeader() {
  if (bytes_.size() < kPeriods * period() + 1) return false;
  std::vector<size_t> places;
  bool rival = false;
  for (size_t place = 0; place < period(); ++place) {
    size_t hits = 0;
    for (size_t k = 0; k < kPeriods; ++k) {
      hits += IsHeader(place + k * period()) ? 1 : 0;
    }
    if (hits == kPeriods) places.push_back(place);
    rival = rival || (hits >= kRivalPeriods && hits < kPeriods);
  }
  const std::optional<size_t> header = Explained(places);
  places_ = header ? std::vector<size_t>() : places;
  if (header && !rival) {
    Drop(*header);
    counters_.skipped_bytes += *header;
    found_ = true;
    return true;
  }
  counters_.skipped_bytes += period();
  Drop(period());
  return true;
}

std::optional<size_t> SerialFrames::Explained(
    const std::vector<size_t>& places) const {
  if (places.size() == 1) return places[0];
  std::optional<size_t> found;
  for (const size_t header : places) {
    bool explained = true;
    for (const size_t other : places) {
      if (other == header) continue;
      const size_t taxel = (other + period() - header) % period() - kHeader;
      explained = explained && taxel + 1 < mask_.size() && mask_[taxel] == 0 &&
                  mask_[taxel + 1] == 0;
    }
    if (!explained) continue;
    if (found) return std::nullopt;
    found = header;
  }
  return found;
}

bool SerialFrames::TakeBinary() {
  // The header of the next frame must follow.
  const size_t frame = period();
  const size_t size = bytes_.size();
  const bool goes_on = (size <= frame || bytes_[frame] == kFirst) &&
                       (size <= frame + 1 || bytes_[frame + 1] == kSecond);
  if (!goes_on) {
    ++counters_.spoiled;
    counters_.skipped_bytes += frame;
    found_ = false;
    Drop(frame);
    return true;
  }
  if (size < frame + kHeader) return false;
  Frame whole;
  whole.time_ns = times_[0];
  whole.taxels.assign(bytes_.begin() + kHeader,
                      bytes_.begin() + static_cast<ptrdiff_t>(frame));
  Deliver(std::move(whole));
  Drop(frame);
  return true;
}

void SerialFrames::Drop(size_t bytes) {
  const auto count = static_cast<ptrdiff_t>(bytes);
  bytes_.erase(bytes_.begin(), bytes_.begin() + count);
  times_.erase(times_.begin(), times_.begin() + count);
}

}  // namespace tactus::internal::client
