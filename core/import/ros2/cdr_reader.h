// File: cdr_reader.h
//
// CdrReader: numbers and texts of a message of ROS 2, which DDS encodes as CDR
// (OMG DDSI-RTPS 10.2, DDS-XTypes 7.4): four bytes that name the encoding, then
// values at multiples of their size.
//
//   CdrReader reader(bytes);
//   const auto seconds = reader.Number<int32_t>();
//   const absl::string_view frame = reader.Text();
//   if (!reader.good()) return Broken(reader.fault());
//
// What is beyond the end reads as 0 or empty text, and good() is false from
// then on. Does not own the bytes. Not thread-safe.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "absl/strings/string_view.h"

namespace tactus::internal {

class CdrReader {
 public:
  // Knows plain CDR and plain CDR 2, in both byte orders.
  explicit CdrReader(absl::string_view bytes) {
    const int kind =
        bytes.size() < kHeaderBytes || bytes[0] != 0 ? -1 : bytes[1];
    if (kind != 0 && kind != 1 && kind != 6 && kind != 7) {
      Fail("begins with no encoding that is known: plain CDR");
      return;
    }
    swap_ = (kind & 1) == 0;
    largest_ = kind >= 6 ? 4 : 8;
    rest_ = bytes.substr(kHeaderBytes);
  }

  bool good() const { return fault_.empty(); }
  // What is wrong, as a verb and what follows; empty if nothing is.
  absl::string_view fault() const { return fault_; }
  // Bytes that were not read.
  size_t left() const { return rest_.size(); }

  // A bool is read as uint8_t.
  template <typename Value>
  Value Number() {
    Align(sizeof(Value));
    Value value = 0;
    char bytes[sizeof(Value)];
    const absl::string_view taken = Take(sizeof(Value));
    if (taken.empty()) return value;
    std::memcpy(bytes, taken.data(), sizeof(Value));
    if (swap_) std::reverse(bytes, bytes + sizeof(Value));
    std::memcpy(&value, bytes, sizeof(Value));
    return value;
  }

  // Without the zero at its end.
  absl::string_view Text() {
    absl::string_view text = Take(Number<uint32_t>());
    if (!text.empty() && text.back() == '\0') text.remove_suffix(1);
    return text;
  }

 private:
  static constexpr size_t kHeaderBytes = 4;

  void Fail(absl::string_view fault) {
    if (good()) fault_ = fault;
    rest_ = {};
  }
  void Align(size_t size) {
    size = std::min(size, largest_);
    Take((size - at_ % size) % size);
  }
  absl::string_view Take(size_t count) {
    if (count > rest_.size()) {
      Fail("ends too early");
      return {};
    }
    const absl::string_view taken = rest_.substr(0, count);
    rest_.remove_prefix(count);
    at_ += count;
    return taken;
  }

  absl::string_view rest_;
  absl::string_view fault_;
  // Bytes that were read, without the header.
  size_t at_ = 0;
  size_t largest_ = 8;
  bool swap_ = false;
};

}  // namespace tactus::internal
