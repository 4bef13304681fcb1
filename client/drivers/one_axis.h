// File: one_axis.h
//
// CheckOneAxis: refuses layouts of three axes or of signed values, for parts
// that have one number per taxel, which is its load.
//
//   TACTUS_RETURN_IF_ERROR(CheckOneAxis("a skin on a serial line", layout));
//
// Thread-safe: a free function without state.
#pragma once

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "core/base/errors.h"
#include "core/skin/layout.h"

namespace tactus::internal::client {

// OK for axes 1 without signed values; else INVALID_CONFIG, which calls the
// part `what`.
inline absl::Status CheckOneAxis(absl::string_view what,
                                 const SkinLayout& layout) {
  if (layout.axes == 1 && !layout.signed_values) return absl::OkStatus();
  return InvalidConfig(
      absl::StrCat("axes of the layout of ", what),
      absl::StrCat(layout.axes, layout.signed_values ? ", signed" : ""),
      "1, without signed_values");
}

}  // namespace tactus::internal::client
