// File: hmm_json.h
//
// The HMMs of a model as JSON, under hmmlearn's names or as GHMM's lists A, B
// and pi; docs/interchange.md shows both.
//
//   const std::string text = HmmsToJson(model, HmmJsonStyle::kHmmlearn);
//   TACTUS_ASSIGN_OR_RETURN(ForeignModel foreign, HmmsFromJson(path, text));
//
// Numbers are written with the digits that give the same bits when they are
// read. Thread-safe: free functions without state.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/classify/model.h"
#include "core/interchange/model/foreign_model.h"

namespace tactus::internal {

enum class HmmJsonStyle {
  // startprob_, transmat_, means_, covars_, covariance_type.
  kHmmlearn,
  // pi, A, and B: for each state, its mean and its covariance, row-major.
  kGhmm,
};

// The model must be valid.
std::string HmmsToJson(const Model& model, HmmJsonStyle style);

// Reads what HmmsToJson writes, in either style. A file may also hold one HMM
// alone, whose class it does not name. INVALID_MODEL naming `path` and the
// field; `path` is for error messages only.
absl::StatusOr<ForeignModel> HmmsFromJson(absl::string_view path,
                                          absl::string_view text);

}  // namespace tactus::internal
