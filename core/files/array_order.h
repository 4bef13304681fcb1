// File: array_order.h
//
// Arrays whose first axis lies closest in memory, as Fortran and MATLAB write
// them.
//
//   FromColumnsFirst({2, 3}, std::vector{1, 4, 2, 5, 3, 6});
//   // {1, 2, 3, 4, 5, 6}
//
// Thread-safe: a free function without state.
#pragma once

#include <cstddef>
#include <vector>

namespace tactus::internal {

// The numbers of an array of `shape` with the last axis closest, from those
// with the first axis closest.
template <typename Value>
std::vector<Value> FromColumnsFirst(const std::vector<size_t>& shape,
                                    const std::vector<Value>& values) {
  std::vector<Value> ordered(values.size());
  std::vector<size_t> strides(shape.size());
  size_t stride = 1;
  for (size_t axis = 0; axis < shape.size(); ++axis) {
    strides[axis] = stride;
    stride *= shape[axis];
  }
  std::vector<size_t> index(shape.size(), 0);
  size_t from = 0;
  for (Value& value : ordered) {
    value = values[from];
    for (size_t axis = shape.size(); axis-- > 0;) {
      from += strides[axis];
      if (++index[axis] < shape[axis]) break;
      from -= strides[axis] * shape[axis];
      index[axis] = 0;
    }
  }
  return ordered;
}

}  // namespace tactus::internal
