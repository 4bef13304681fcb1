// File: cdr_writer.h
//
// CdrWriter: numbers and texts as a message of ROS 2, in plain CDR with the
// lowest byte first; what CdrReader (core/import/ros2/cdr_reader.h) reads.
//
//   CdrWriter writer;
//   writer.Number<int32_t>(seconds);
//   writer.Text("forearm");
//   writer.List(contacts, [&](const Contact& contact) { Write(contact); });
//   Send(writer.bytes());
//
// Owns the bytes. Not thread-safe.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>

#include "absl/strings/string_view.h"

namespace tactus::internal::client {

class CdrWriter {
 public:
  // As a template argument, so that each field states its width. A bool is one
  // byte.
  template <typename Value>
  void Number(std::type_identity_t<Value> value) {
    bytes_.resize(kHeaderBytes +
                  (size() + sizeof(Value) - 1) / sizeof(Value) * sizeof(Value));
    char bytes[sizeof(Value)];
    std::copy_n(reinterpret_cast<const char*>(&value), sizeof(Value), bytes);
    if constexpr (std::endian::native == std::endian::big) {
      std::reverse(bytes, bytes + sizeof(Value));
    }
    bytes_.append(bytes, sizeof(Value));
  }

  void Text(absl::string_view text) {
    Number<uint32_t>(static_cast<uint32_t>(text.size() + 1));
    bytes_.append(text.data(), text.size());
    bytes_ += '\0';
  }

  // A sequence: its length, then `write` of each element.
  template <typename Range, typename Write>
  void List(const Range& range, const Write& write) {
    Number<uint32_t>(static_cast<uint32_t>(range.size()));
    for (const auto& element : range) write(element);
  }
  void EmptyList() { Number<uint32_t>(0); }

  const std::string& bytes() const { return bytes_; }

 private:
  static constexpr size_t kHeaderBytes = 4;

  size_t size() const { return bytes_.size() - kHeaderBytes; }

  std::string bytes_ = std::string("\0\1\0\0", kHeaderBytes);
};

}  // namespace tactus::internal::client
