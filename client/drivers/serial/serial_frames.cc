#include "client/drivers/serial/serial_frames.h"

#include <algorithm>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_split.h"

namespace tactus::client {
namespace {

constexpr uint8_t kFirst = 0xAA;
constexpr uint8_t kSecond = 0x55;
constexpr size_t kHeader = 2;
// Frames that wait to be taken.
constexpr size_t kMaxWaiting = 64;
// Characters for each number of a line, with room.
constexpr size_t kCharactersPerNumber = 8;
// Lines of other shapes are understood up to so many numbers.
constexpr size_t kMostColumns = 64;

}  // namespace

SerialFrames::SerialFrames(SerialFormat format, int rows, int columns)
    : format_(format),
      rows_(static_cast<size_t>(std::max(rows, 1))),
      columns_(static_cast<size_t>(std::max(columns, 1))) {}

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
  good_ = long_line_ = whole_block_ = false;
  seen_shape_ = {};
  bytes_.clear();
  times_.clear();
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
    bool good = !long_line_ && words.size() == columns_ && lines_ <= rows_;
    if (lines_ == 1) block_columns_ = words.size();
    if (block_columns_ != words.size() || long_line_) block_columns_ = 0;
    for (const absl::string_view word : words) {
      int value = 0;
      const bool number = word[0] >= '0' && word[0] <= '9' &&
                          absl::SimpleAtoi(word, &value) && value <= 255;
      if (!number) block_columns_ = 0;
      good = good && number;
      if (good) current_.taxels.push_back(static_cast<uint16_t>(value));
    }
    good_ = good_ && good;
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
  good_ = whole_block_ = true;
}

void SerialFrames::AddBinary(uint8_t byte, int64_t now_ns) {
  const size_t frame = kHeader + rows_ * columns_;
  bytes_.push_back(byte);
  times_.push_back(now_ns);
  while (!bytes_.empty()) {
    // A header must be at the begin, and where the next frame begins.
    const size_t size = bytes_.size();
    const bool begins =
        bytes_[0] == kFirst && (size < 2 || bytes_[1] == kSecond);
    const bool goes_on = (size <= frame || bytes_[frame] == kFirst) &&
                         (size <= frame + 1 || bytes_[frame + 1] == kSecond);
    if (!begins || !goes_on) {
      if (begins) ++counters_.spoiled;
      Resynchronise();
      continue;
    }
    if (size < frame + kHeader) return;
    Frame whole;
    whole.time_ns = times_[0];
    whole.taxels.assign(bytes_.begin() + kHeader,
                        bytes_.begin() + static_cast<ptrdiff_t>(frame));
    Deliver(std::move(whole));
    bytes_.erase(bytes_.begin(),
                 bytes_.begin() + static_cast<ptrdiff_t>(frame));
    times_.erase(times_.begin(),
                 times_.begin() + static_cast<ptrdiff_t>(frame));
  }
}

void SerialFrames::Resynchronise() {
  size_t next = 1;
  while (next < bytes_.size() &&
         !(bytes_[next] == kFirst &&
           (next + 1 == bytes_.size() || bytes_[next + 1] == kSecond))) {
    ++next;
  }
  counters_.skipped_bytes += next;
  bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<ptrdiff_t>(next));
  times_.erase(times_.begin(), times_.begin() + static_cast<ptrdiff_t>(next));
}

}  // namespace tactus::client
