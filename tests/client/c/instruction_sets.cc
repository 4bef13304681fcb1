// Prints the instruction sets that Highway compiles for and that this processor
// has, the one that it takes first: "AVX2 SSE4 SSSE3 ..." or "NEON".
#include <cstdint>
#include <cstdio>

#include "hwy/highway.h"

int main() {
  const int64_t usable = hwy::SupportedTargets() & HWY_TARGETS;
  for (int64_t bit = 1; bit > 0 && bit <= HWY_SCALAR; bit <<= 1) {
    if ((usable & bit) != 0) std::printf("%s ", hwy::TargetName(bit));
  }
  std::printf("\n");
  return 0;
}
