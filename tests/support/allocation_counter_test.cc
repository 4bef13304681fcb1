#include "tests/support/allocation_counter.h"

#include <new>

#include "gtest/gtest.h"

namespace tactus::internal::testing {
namespace {

// Else all tests that expect no allocation pass, whatever they do.
TEST(AllocationCounterTest, CountsBothKindsOfNew) {
  const AllocationCounter counter;
  ::operator delete(::operator new(8));
  EXPECT_EQ(counter.count(), 1);
  constexpr std::align_val_t kAlignment{64};
  ::operator delete(::operator new(64, kAlignment), kAlignment);
  EXPECT_EQ(counter.count(), 2);
}

}  // namespace
}  // namespace tactus::internal::testing
