#include "client/stream/message_ring.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>

namespace tactus::internal::client {
namespace {

constexpr size_t kFirstCapacity = 16 * 1024;
constexpr size_t kMinCapacity = 64;

}  // namespace

MessageRing::MessageRing(size_t max_bytes)
    : max_capacity_(std::bit_floor(std::max(max_bytes, kMinCapacity))),
      capacity_(std::min(max_capacity_, kFirstCapacity)),
      buffer_(std::make_unique<char[]>(capacity_)) {}

char* MessageRing::Append(size_t size) {
  const size_t room = Room(size);
  while (bytes() + GapBefore(room) + room > capacity_) {
    if (capacity_ == max_capacity_) return nullptr;
    Grow();
  }
  if (const size_t gap = GapBefore(room); gap > 0) {
    const auto bytes = static_cast<uint32_t>(gap - sizeof(Header));
    WriteHeader(end_, {.bytes = bytes, .is_gap = 1});
    end_ += gap;
  }
  WriteHeader(end_, {.bytes = static_cast<uint32_t>(size)});
  char* const record = Address(end_) + sizeof(Header);
  end_ += room;
  return record;
}

void MessageRing::PopFront() { begin_ = Next(begin_); }

MessageRing::Position MessageRing::Next(Position at) const {
  at = RecordFrom(at);
  return at + Room(HeaderAt(at).bytes);
}

absl::string_view MessageRing::At(Position at) const {
  at = RecordFrom(at);
  return {Address(at) + sizeof(Header), HeaderAt(at).bytes};
}

MessageRing::Header MessageRing::HeaderAt(Position at) const {
  Header header;
  std::memcpy(&header, Address(at), sizeof(header));
  return header;
}

void MessageRing::WriteHeader(Position at, const Header& header) {
  std::memcpy(Address(at), &header, sizeof(header));
}

MessageRing::Position MessageRing::RecordFrom(Position at) const {
  const Header header = HeaderAt(at);
  return header.is_gap != 0 ? at + Room(header.bytes) : at;
}

size_t MessageRing::GapBefore(size_t room) const {
  const size_t to_end = capacity_ - end_ % capacity_;
  return room > to_end ? to_end : 0;
}

void MessageRing::Grow() {
  const size_t capacity = 2 * capacity_;
  auto buffer = std::make_unique<char[]>(capacity);
  // No record crosses a multiple of the old capacity, so none crosses the end
  // of the new buffer.
  for (Position at = begin_; at < end_;) {
    const size_t bytes =
        std::min<size_t>(capacity_ - at % capacity_, end_ - at);
    std::memcpy(buffer.get() + at % capacity, Address(at), bytes);
    at += bytes;
  }
  buffer_ = std::move(buffer);
  capacity_ = capacity;
}

}  // namespace tactus::internal::client
