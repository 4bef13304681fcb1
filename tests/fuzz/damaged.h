// File: damaged.h
//
// What fuzz targets of parsers share: a good file with the damage that the
// fuzzer chooses, a folder for files, and the check of what a parser returns.
//
//   FuzzedDataProvider data(bytes, size);
//   const std::string file = Damaged({kGood, kOther}, data);
//   RequireReason(Parse(file).status());
#pragma once

#include <fuzzer/FuzzedDataProvider.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "core/base/errors.h"

#define REQUIRE(condition) \
  if (!(condition)) __builtin_trap()

namespace tactus::internal::fuzz {

// One of `good`, with bytes that are changed, removed and put in; or the
// fuzzer's bytes alone.
inline std::string Damaged(const std::vector<std::string>& good,
                           FuzzedDataProvider& data) {
  const size_t choice = data.ConsumeIntegralInRange<size_t>(0, good.size());
  if (choice == good.size()) return data.ConsumeRemainingBytesAsString();
  std::string bytes = good[choice];
  while (data.remaining_bytes() > 0 && !bytes.empty()) {
    const auto at = data.ConsumeIntegralInRange<size_t>(0, bytes.size() - 1);
    switch (data.ConsumeIntegralInRange(0, 3)) {
      case 0:
        bytes[at] = static_cast<char>(data.ConsumeIntegral<uint8_t>());
        break;
      case 1:
        bytes.erase(at, data.ConsumeIntegralInRange<size_t>(1, 64));
        break;
      case 2:
        bytes.insert(at, data.ConsumeRandomLengthString(16));
        break;
      default:
        bytes.insert(at, bytes.substr(data.ConsumeIntegralInRange<size_t>(
                                          0, bytes.size() - 1),
                                      data.ConsumeIntegralInRange(1, 64)));
    }
  }
  return bytes;
}

// A status that callers can tell apart.
inline void RequireReason(const absl::Status& status) {
  REQUIRE(status.ok() || !ReasonOf(status).empty());
}

// A folder in memory for the files of this process.
inline const std::string& Folder() {
  static const auto* const folder = [] {
    auto* name =
        new std::string("/dev/shm/tactus-fuzz-" + std::to_string(getpid()));
    std::filesystem::create_directories(*name);
    std::atexit([] { std::filesystem::remove_all(Folder()); });
    return name;
  }();
  return *folder;
}

inline std::string Write(const std::string& name, const std::string& bytes) {
  const std::string path = Folder() + "/" + name;
  std::ofstream(path, std::ios::binary) << bytes;
  return path;
}

// A file of tests/golden.
inline std::string Golden(const std::string& name) {
  std::ifstream in(TACTUS_GOLDEN "/" + name, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(in), {}};
  REQUIRE(!bytes.empty());
  return bytes;
}

}  // namespace tactus::internal::fuzz
