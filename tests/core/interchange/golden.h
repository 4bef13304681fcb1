// File: golden.h
//
// The recorded files of tests/golden/interchange, which check.sh --record
// makes. Test-only.
//
//   const std::string bytes = Golden("hmms.npz");
#pragma once

#include <cstdlib>
#include <string>

#include "gtest/gtest.h"
#include "tests/core/data/trial_samples.h"

namespace tactus::internal {

inline std::string GoldenPath(const std::string& name) {
  const char* root = std::getenv("TACTUS_SOURCE_DIR");
  return std::string(root == nullptr ? "." : root) +
         "/tests/golden/interchange/" + name;
}

inline std::string Golden(const std::string& name) {
  std::string bytes = ReadBytes(GoldenPath(name));
  EXPECT_FALSE(bytes.empty()) << name;
  return bytes;
}

}  // namespace tactus::internal
