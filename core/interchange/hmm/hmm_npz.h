// File: hmm_npz.h
//
// The HMMs of a model as NumPy's .npz, under hmmlearn's names. HMM k of class c
// has the arrays "c/k/startprob_", "c/k/transmat_", "c/k/means_", "c/k/covars_"
// and "c/k/covariance_type"; class c has "c/weights"; "class_names" names the
// classes, and "inputs" states the inputs as JSON (inputs_json.h).
//
//   TACTUS_ASSIGN_OR_RETURN(const std::string bytes, HmmsToNpz(model));
//   TACTUS_ASSIGN_OR_RETURN(ForeignModel foreign, HmmsFromNpz(path, bytes));
//
// Thread-safe: free functions without state.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/classify/model.h"
#include "core/interchange/model/foreign_model.h"

namespace tactus::internal {

// The model must be valid. INVALID_MODEL if it has more arrays than a file can
// hold.
absl::StatusOr<std::string> HmmsToNpz(const Model& model);

// Reads what HmmsToNpz writes. A file may also hold the five arrays of one HMM
// alone, whose class it does not name. INVALID_MODEL naming `path` and the
// array; `path` is for error messages only. Pickles are refused.
absl::StatusOr<ForeignModel> HmmsFromNpz(absl::string_view path,
                                         absl::string_view bytes);

}  // namespace tactus::internal
