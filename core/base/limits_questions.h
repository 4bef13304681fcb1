// File: limits_questions.h
//
// Limits of the questions that a model answers (core/questions), beside those
// in limits.h. Thread-safe: constants.
#pragma once

#include <cstddef>

namespace tactus::internal::limits {

inline constexpr size_t kMaxQuestions = 8;
inline constexpr size_t kMaxQuestionNameBytes = 64;
// Text of a label table.
inline constexpr size_t kMaxQuestionTableBytes = 256 * 1024;

}  // namespace tactus::internal::limits
