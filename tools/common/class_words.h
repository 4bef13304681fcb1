// File: class_words.h
//
// The names of the four classes of the paper in words. Models and files have
// the short ones.
//
//   ClassWords("HU");     // "hard-unmoved"
//   ClassWords("metal");  // "metal"
//
// Thread-safe: a free function without state.
#pragma once

#include <string>
#include <utility>

#include "absl/strings/string_view.h"

namespace tactus::internal::client {

inline std::string ClassWords(absl::string_view name) {
  static constexpr std::pair<absl::string_view, absl::string_view> kWords[] = {
      {"HU", "hard-unmoved"},
      {"HM", "hard-moved"},
      {"SU", "soft-unmoved"},
      {"SM", "soft-moved"}};
  for (const auto& [short_name, words] : kWords) {
    if (name == short_name) return std::string(words);
  }
  return std::string(name);
}

}  // namespace tactus::internal::client
