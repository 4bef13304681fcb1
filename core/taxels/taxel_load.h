// File: taxel_load.h
//
// TaxelLoad: one touched taxel of a frame, or a component of one
// (components.h). A frame's touched taxels are a list of these, by rising
// index.
//
//   std::vector<TaxelLoad> loads = {{.taxel = 17, .root = 0.5F}};
//
// Plain data.
#pragma once

#include <cstdint>

namespace tactus::internal {

struct TaxelLoad {
  // Row-major; components follow.
  uint32_t taxel = 0;
  // The square root of the load, in the square root of the layout's unit. The
  // root makes the spread independent of the load, because larger loads vary
  // more.
  float root = 0;

  bool operator==(const TaxelLoad&) const = default;
};

}  // namespace tactus::internal
