// File: row_marks.h
//
// RowMarks: marked taxels, a word per row of a skin; bit c is column c.
//
//   RowMarks felt(/*rows=*/16);
//   felt.data()[3] |= uint64_t{1} << column;
//
// Thread-safe as std::vector is.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "core/base/aligned_vector.h"

namespace tactus::internal {

class RowMarks {
 public:
  explicit RowMarks(size_t rows) : words_(kBeside + rows + kBeside) {}

  // The word of the first row. There are words before it and after the last
  // one, for kernels that search whole vectors and the rows around a row.
  uint64_t* data() { return words_.data() + kBeside; }

  // Clears all rows.
  void Clear() { std::ranges::fill(words_, 0); }

 private:
  // At least the rows of a region (limits::kMaxLightSide) and a cache line.
  static constexpr size_t kBeside = 24;

  AlignedVector<uint64_t> words_;
};

}  // namespace tactus::internal
