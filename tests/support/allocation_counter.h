// File: allocation_counter.h
//
// Counts calls of operator new in this test binary. Link the source
// allocation_counter.cc to replace the global operators. Under ThreadSanitizer,
// which has its own, calls of malloc count too.
//
//   AllocationCounter counter;
//   filter.Step(frame);
//   EXPECT_EQ(counter.count(), 0);
#pragma once

#include <cstdint>

namespace tactus::internal::testing {

// Allocations since the program started, all threads.
int64_t AllocationsSoFar();

class AllocationCounter {
 public:
  AllocationCounter() : start_(AllocationsSoFar()) {}
  int64_t count() const { return AllocationsSoFar() - start_; }

 private:
  int64_t start_;
};

}  // namespace tactus::internal::testing
