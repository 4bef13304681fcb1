// File: trial_filter.h
//
// TrialFilter: which trials a user means, as an expression over their fields.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       const TrialFilter filter,
//       TrialFilter::Parse("condition != 'day 2' and not label in (a, b)"));
//   const bool wanted = filter.Matches(
//       [&](const std::string& field) { return FieldOf(trial, field); });
//
// A comparison is FIELD OPERATOR VALUE, with the operators = == != < <= > >= or
// FIELD in (VALUE, ...). Comparisons are joined by and, or, not and
// parentheses; "and" binds more than "or". A value is a word, or any text in
// single or double quotes. Values that are both numbers are compared as
// numbers, all others as text.
//
// Bounded: at most kMostBytes of text, so that parsing is. Owns its text.
// Thread-safe once built.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/functional/function_ref.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace tactus::internal {

class TrialFilter {
 public:
  static constexpr size_t kMostBytes = 4096;

  // INVALID_CONFIG with the place of a mistake.
  static absl::StatusOr<TrialFilter> Parse(absl::string_view text);

  TrialFilter(TrialFilter&&) noexcept;
  TrialFilter& operator=(TrialFilter&&) noexcept;
  ~TrialFilter();

  // The fields that it asks for, each once, in the order of the text.
  const std::vector<std::string>& fields() const { return fields_; }

  // `field_of` returns the value of a field of the trial.
  bool Matches(
      absl::FunctionRef<std::string(const std::string& field)> field_of) const;

 private:
  struct Node;
  class Parser;

  TrialFilter();

  std::unique_ptr<const Node> root_;
  std::vector<std::string> fields_;
};

}  // namespace tactus::internal
