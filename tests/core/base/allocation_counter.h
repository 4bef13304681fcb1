// File: allocation_counter.h
//
// Counts heap allocations of the test binary it is linked into, to prove that
// a per-frame path makes none.
//
//   const int64_t before = AllocationCount();
//   tracker.Step(frame);
//   EXPECT_EQ(AllocationCount(), before);
#pragma once

#include <cstdint>

namespace tactus {

// Calls of operator new so far, from all threads.
int64_t AllocationCount();

}  // namespace tactus
