// File: for_each_target.h
//
// Runs a check of Highway kernels once for each vector width of this CPU.
//
//   ForEachTarget([] { EXPECT_EQ(Sum(taxels), expected); });
//
// Not thread-safe: the chosen width is a global.
#pragma once

#include <cstdint>

#include "gtest/gtest.h"
#include "hwy/targets.h"

namespace tactus::internal {

template <typename Check>
void ForEachTarget(Check check) {
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    SCOPED_TRACE(hwy::TargetName(target));
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    check();
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace tactus::internal
