// Ten million steps of one sequence.
#include "tests/core/lstm/many_steps.h"

namespace tactus::internal {
namespace {

TEST(LstmManyStepsTest, TenMillionStepsDoNotDrift) {
  testing::ExpectNoDrift(10'000'000);
}

}  // namespace
}  // namespace tactus::internal
