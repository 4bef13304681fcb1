// File: any_skin.h
//
// Any skin and what may press on it, from the bytes of a fuzzer: bytes alone
// seldom make a skin that is accepted, or two contacts.
//
//   v1::StreamConfig config = AnyConfig(data);
//   Presses presses(config);
//   presses.Change(data);
//   presses.AppendTo(/*sparse=*/false, &batch);
//
// Owns its values. Not thread-safe.
#pragma once

#include <fuzzer/FuzzedDataProvider.h>

#include <array>
#include <cstdint>
#include <string>

#include "core/skin/taxel_values.h"
#include "tactus/v1/contact.pb.h"

namespace tactus::internal::fuzz {

// Most of them are accepted.
v1::StreamConfig AnyConfig(FuzzedDataProvider& data);

// Up to eight objects, each on a rectangle of taxels.
class Presses {
 public:
  explicit Presses(const v1::StreamConfig& config);

  // One of the objects comes, goes, moves, or presses harder.
  void Change(FuzzedDataProvider& data);
  // Appends a frame to those of `batch`, which are all sparse or all dense.
  void AppendTo(bool sparse, v1::FrameBatch* batch) const;
  // Values of a frame, and the bytes of one.
  size_t values() const { return size_t{rows_} * columns_ * axes_; }
  size_t value_bytes() const { return TaxelBytes(type_); }

 private:
  struct Object {
    uint32_t row = 0;
    uint32_t column = 0;
    uint32_t rows = 0;
    uint32_t columns = 0;
    // Counts of a thousandth of the unit.
    int load = 0;
    int shear = 0;
  };

  // The value at a place of the frame, in thousandths of the unit.
  int ValueAt(size_t place) const;
  void Append(int value, std::string* bytes) const;

  const uint32_t rows_;
  const uint32_t columns_;
  const uint32_t axes_;
  const uint32_t normal_;
  const bool signed_;
  const v1::TaxelType type_;
  std::array<Object, 8> objects_;
};

}  // namespace tactus::internal::fuzz
