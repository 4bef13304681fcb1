// File: trial_table.h
//
// TrialTable: the table of a folder of recordings, a row per trial, with the
// fields that a skin.json makes of its columns.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       const TrialTable table,
//       TrialTable::Read("mine/trials.csv", "mine/skin.json", skin.fields));
//   const std::string label = table.Text(0, "label");
//
// Owns its text. Thread-safe once built.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/files/csv.h"
#include "core/import/file_names.h"

namespace tactus::internal {

class TrialTable {
 public:
  // `fields` says what a field is made of: text in which {NAME} stands for the
  // row's cell in the column NAME. Other fields are the columns of their names.
  // Fields that are neither come from the names of the files, if there are
  // `names`. With `is_labelled`, the table needs no labels. IO or
  // TRIAL_FILE_INVALID, also if `fields` names a column that there is not; then
  // the error is about `skin_path`.
  static absl::StatusOr<TrialTable> Read(
      const std::string& path, const std::string& skin_path,
      const std::map<std::string, std::string>& fields,
      const FileNamePattern* names = nullptr, bool is_labelled = false);
  // A table of the files in `folder` whose names fit, in the order of their
  // names. Gives `left_out` those that have an ending of recordings and do not.
  static absl::StatusOr<TrialTable> FromNames(
      const std::string& folder, const FileNamePattern& names,
      std::vector<std::string>* left_out, bool is_labelled = false);
  // A table of one file in `folder`, which has no other field.
  static absl::StatusOr<TrialTable> OfOne(const std::string& folder,
                                          const std::string& file);

  size_t rows() const { return csv_.rows(); }
  bool Has(const std::string& field) const {
    return templates_.contains(field) ||
           (!names_.empty() && names_.front().contains(field));
  }
  // The field of a row; empty if the table has no such field.
  std::string Text(size_t row, const std::string& field) const;
  // As a number; `absent` if the table has no such field.
  absl::StatusOr<double> Number(size_t row, const std::string& field,
                                double absent) const;
  // TRIAL_FILE_INVALID with file, line and field.
  absl::Status Error(size_t row, absl::string_view field,
                     absl::string_view message) const;

 private:
  explicit TrialTable(CsvTable csv) : csv_(std::move(csv)) {}

  static absl::StatusOr<TrialTable> OfFiles(
      const std::string& folder, const std::vector<std::string>& files);
  absl::Status TakeNames(const FileNamePattern& names);

  CsvTable csv_;
  std::map<std::string, std::string> templates_;
  // The fields of each row that come from the name of its file.
  std::vector<std::map<std::string, std::string>> names_;
  // The table was made from the names of files, so it has no lines.
  bool from_names_ = false;
  // Then the folder.
  std::string path_;
};

}  // namespace tactus::internal
