// File: parallel.h
//
// How a caller lends threads to core, which starts none itself.
#pragma once

#include <functional>

namespace tactus {

// Calls body(0) .. body(count - 1), in any order, on any threads, and returns
// when all are done.
using ParallelFor =
    std::function<void(int count, const std::function<void(int)>& body)>;

// One after another on the calling thread.
inline void RunSerially(int count, const std::function<void(int)>& body) {
  for (int i = 0; i < count; ++i) body(i);
}

}  // namespace tactus
