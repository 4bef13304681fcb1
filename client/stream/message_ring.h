// File: message_ring.h
//
// MessageRing: a queue of byte strings in one buffer, for the messages that a
// stream may have to send again.
//
//   MessageRing ring(limits::kMaxReplayBytes);
//   if (char* bytes = ring.Append(message.ByteSizeLong())) {
//     message.SerializeToArray(bytes, size);
//   }
//   for (auto at = ring.begin(); at != ring.end(); at = ring.Next(at)) {
//     Send(ring.At(at));
//   }
//   ring.PopFront();
//
// A position stays valid until its record is removed. The buffer doubles up to
// its limit; once it is large enough, nothing allocates. Not thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "absl/strings/string_view.h"

namespace tactus::internal::client {

class MessageRing {
 public:
  using Position = uint64_t;

  // The limit is the largest power of two that is at most `max_bytes`; at
  // least 64.
  explicit MessageRing(size_t max_bytes);

  // Returns room for a record of `size` bytes at the end, or null if there is
  // none. The pointer is valid until the next Append.
  char* Append(size_t size);
  // Removes the first record; there must be one.
  void PopFront();
  // Removes all records. Positions go on.
  void Clear() { begin_ = end_; }

  bool empty() const { return begin_ == end_; }
  // Places of the first record, and behind the last.
  Position begin() const { return begin_; }
  Position end() const { return end_; }
  Position Next(Position at) const;
  // The record; valid until the next Append.
  absl::string_view At(Position at) const;
  // Bytes in use, and bytes of the buffer.
  size_t bytes() const { return end_ - begin_; }
  size_t capacity() const { return capacity_; }

 private:
  // Precedes each record. Records are not split at the end of the buffer; a
  // gap fills the room before it.
  struct Header {
    uint32_t bytes = 0;
    uint32_t is_gap = 0;
  };

  // Bytes that a record takes with its header, a multiple of 8.
  static size_t Room(size_t bytes) {
    return sizeof(Header) + (bytes + 7) / 8 * 8;
  }
  char* Address(Position at) { return buffer_.get() + at % capacity_; }
  const char* Address(Position at) const {
    return buffer_.get() + at % capacity_;
  }
  Header HeaderAt(Position at) const;
  void WriteHeader(Position at, const Header& header);
  // Skips a gap.
  Position RecordFrom(Position at) const;
  // Bytes of a gap before a record of `room` bytes.
  size_t GapBefore(size_t room) const;
  void Grow();

  const size_t max_capacity_;
  size_t capacity_;
  std::unique_ptr<char[]> buffer_;
  Position begin_ = 0;
  Position end_ = 0;
};

}  // namespace tactus::internal::client
