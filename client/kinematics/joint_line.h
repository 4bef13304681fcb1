// File: joint_line.h
//
// ParseJointLine: the text in which robots' programs send joint values,
// "time_ns q1 q2 ...": numbers with white space between them.
//
//   int64_t time_ns = 0;
//   std::vector<double> values(7);
//   TACTUS_RETURN_IF_ERROR(ParseJointLine("0 0.1 -1.2 0 1.5 0 0.7 0", time_ns,
//                                         values));
//
// Allocates nothing but the texts of errors. Thread-safe: a free function
// without state.
#pragma once

#include <cstdint>
#include <span>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace tactus::internal::client {

// INVALID_CONFIG unless `line` is a whole number and one number for each of
// `values`.
absl::Status ParseJointLine(absl::string_view line, int64_t& time_ns,
                            std::span<double> values);

}  // namespace tactus::internal::client
