// File: file_names.h
//
// FileNamePattern: fields of a trial, taken from the name of its file.
//
//   TACTUS_ASSIGN_OR_RETURN(const FileNamePattern pattern,
//                           FileNamePattern::Parse("{label}_{group}.csv"));
//   TACTUS_ASSIGN_OR_RETURN(const auto fields, pattern.Match("cup_anna.csv"));
//   fields.at("group");  // "anna"
//
// A pattern is a template, in which {FIELD} stands for any text without a slash
// and {} for text that is no field; or, if it holds "(?", a regular expression
// (ECMAScript) with named groups: "(?<label>[a-z]+)\d+\.csv". It covers the
// whole name, with the folders that it is in if the pattern has a slash.
//
// Plain data; thread-safe.
#pragma once

#include <map>
#include <regex>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace tactus::internal {

class FileNamePattern {
 public:
  // INVALID_CONFIG if `text` is no pattern or names something that is no field.
  static absl::StatusOr<FileNamePattern> Parse(const std::string& text);

  // The fields of a name. TRIAL_FILE_INVALID about `file` if the pattern does
  // not fit, or if a template fits in more ways than one.
  absl::StatusOr<std::map<std::string, std::string>> Match(
      const std::string& file) const;
  // True if the pattern fits.
  bool Fits(const std::string& file) const;
  // The fields that a match has.
  std::vector<std::string> fields() const;

 private:
  FileNamePattern() = default;
  // The part of `file` that the pattern covers.
  std::string Covered(const std::string& file) const;
  std::map<std::string, std::string> FieldsOf(const std::smatch& match) const;

  std::string text_;
  // Fields take as few characters as possible, and as many as possible.
  std::regex few_;
  std::regex many_;
  // The field of each group; empty for a group that is none.
  std::vector<std::string> groups_;
};

}  // namespace tactus::internal
