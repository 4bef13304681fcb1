// File: similar_names.h
//
// Names of classes, conditions and groups that differ by what people do not
// mean to say: "soft", "Soft" and "soft " are three classes to a program.
//
//   SimilarNames labels("label");
//   for (const Trial& trial : trials) labels.Add(trial.label);
//   labels.Remarks();  // {"the labels \"Soft\" and \"soft\" differ ..."}
//
// Not thread-safe.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "absl/strings/string_view.h"

namespace tactus::internal {

// `name` without the blanks at its ends and without the characters there that
// cannot be seen. `name` is UTF-8.
std::string TrimmedName(absl::string_view name);

class SimilarNames {
 public:
  // `what` names the names: "label".
  explicit SimilarNames(std::string what) : what_(std::move(what)) {}

  void Add(const std::string& name);
  // A sentence for each set of names that differ only by case, blanks, accents,
  // the form of a number ("1" and "1.0") or characters that cannot be seen; at
  // most 10.
  std::vector<std::string> Remarks() const;

 private:
  std::string what_;
  // By what is left of them without these.
  std::map<std::string, std::set<std::string>> names_;
};

}  // namespace tactus::internal
