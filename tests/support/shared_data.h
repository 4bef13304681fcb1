// File: shared_data.h
//
// Where real recordings lie: the directory TACTUS_DATA_DIR, else ../shared/data
// beside the project. Tests say so and return when a file is absent.
#pragma once

#include <cstdlib>
#include <string>

namespace tactus::internal {

inline std::string SharedDataPath(const std::string& name) {
  if (const char* data = std::getenv("TACTUS_DATA_DIR")) {
    return std::string(data) + "/" + name;
  }
  const char* source = std::getenv("TACTUS_SOURCE_DIR");
  return std::string(source != nullptr ? source : ".") + "/../shared/data/" +
         name;
}

}  // namespace tactus::internal
