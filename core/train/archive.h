// File: archive.h
//
// The bytes of plain data, for saved parts of a fit and for fingerprints. One
// list of fields per structure serves writing and reading.
//
//   ByteWriter writer;
//   writer(checkpoint.network, checkpoint.history);
//   ByteReader reader(writer.bytes());
//   reader(checkpoint.network, checkpoint.history);
//   if (!reader.AtEnd()) return CheckpointInvalid(part, "it is cut off");
//
// A structure takes part with a function Fields(archive, value) in its
// namespace, which calls archive(value.a, value.b). Numbers are written as they
// lie in memory, so the bytes belong to one kind of machine. A reader whose
// bytes run out returns zeros and is not AtEnd().
//
// Writers own their bytes; readers refer to the caller's. Not thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "absl/strings/string_view.h"

namespace tactus::internal {

template <typename T>
concept Plain = std::is_arithmetic_v<T> || std::is_enum_v<T>;

class ByteWriter {
 public:
  template <typename... T>
  void operator()(const T&... values) {
    (Put(values), ...);
  }

  const std::string& bytes() const { return bytes_; }
  std::string Take() { return std::move(bytes_); }

 private:
  template <Plain T>
  void Put(const T& value) {
    PutRange(&value, 1);
  }
  template <Plain T>
  void PutRange(const T* values, size_t count) {
    bytes_.append(reinterpret_cast<const char*>(values), count * sizeof(T));
  }
  void Put(const std::string& text) {
    Put(uint64_t{text.size()});
    bytes_ += text;
  }
  template <typename T>
  void Put(const std::vector<T>& values) {
    Put(uint64_t{values.size()});
    if constexpr (Plain<T>) {
      PutRange(values.data(), values.size());
    } else {
      for (const T& value : values) Put(value);
    }
  }
  template <typename T, size_t N>
  void Put(const std::array<T, N>& values) {
    for (const T& value : values) Put(value);
  }
  template <typename T>
  void Put(const std::optional<T>& value) {
    Put(value.has_value());
    if (value.has_value()) Put(*value);
  }
  template <typename T>
  requires std::is_class_v<T>
  void Put(const T& value) {
    // Fields() only reads: a writer takes its arguments as constants.
    Fields(*this, const_cast<T&>(value));
  }

  std::string bytes_;
};

class ByteReader {
 public:
  explicit ByteReader(absl::string_view bytes) : rest_(bytes) {}

  template <typename... T>
  void operator()(T&... values) {
    (Get(values), ...);
  }

  // True if all bytes were read, and none was missing.
  bool AtEnd() const { return whole_ && rest_.empty(); }

 private:
  template <Plain T>
  void Get(T& value) {
    GetRange(&value, 1);
  }
  template <Plain T>
  void GetRange(T* values, size_t count) {
    const size_t size = count * sizeof(T);
    whole_ = whole_ && size <= rest_.size();
    if (!whole_ || size == 0) return;
    std::memcpy(values, rest_.data(), size);
    rest_.remove_prefix(size);
  }
  // The number of items that follow, each of at least `size` bytes.
  size_t Count(size_t size) {
    uint64_t count = 0;
    Get(count);
    whole_ = whole_ && count <= rest_.size() / size;
    return whole_ ? count : 0;
  }
  void Get(std::string& text) {
    const size_t size = Count(1);
    text.assign(rest_.data(), size);
    rest_.remove_prefix(size);
  }
  template <typename T>
  void Get(std::vector<T>& values) {
    if constexpr (Plain<T>) {
      values.resize(Count(sizeof(T)));
      GetRange(values.data(), values.size());
    } else {
      values.resize(Count(1));
      for (T& value : values) Get(value);
    }
  }
  template <typename T, size_t N>
  void Get(std::array<T, N>& values) {
    for (T& value : values) Get(value);
  }
  template <typename T>
  void Get(std::optional<T>& value) {
    bool has_value = false;
    Get(has_value);
    value.reset();
    if (has_value) Get(value.emplace());
  }
  template <typename T>
  requires std::is_class_v<T>
  void Get(T& value) { Fields(*this, value); }

  absl::string_view rest_;
  bool whole_ = true;
};

}  // namespace tactus::internal
