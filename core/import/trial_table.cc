#include "core/import/trial_table.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/import/skin_file.h"

namespace tactus {
namespace {

// Splits "a{b}c" at its next placeholder: "a", "b", and "c" stays. False if
// there is none, or no closing brace.
bool NextPlaceholder(absl::string_view* text, absl::string_view* before,
                     absl::string_view* name) {
  const size_t open = text->find('{');
  const size_t close = text->find('}', open);
  if (open == absl::string_view::npos || close == absl::string_view::npos) {
    return false;
  }
  *before = text->substr(0, open);
  *name = text->substr(open + 1, close - open - 1);
  text->remove_prefix(close + 1);
  return true;
}

}  // namespace

absl::StatusOr<TrialTable> TrialTable::Read(
    const std::string& path, const std::string& skin_path,
    const std::map<std::string, std::string>& fields) {
  TACTUS_ASSIGN_OR_RETURN(CsvTable csv, CsvTable::Read(path));
  for (const auto& [field, text] : fields) {
    absl::string_view rest = text;
    absl::string_view before;
    absl::string_view name;
    while (NextPlaceholder(&rest, &before, &name)) {
      if (csv.Has(name)) continue;
      return TrialFileInvalid(
          skin_path,
          absl::StrCat("fields.", field, ": there is no column ", Quoted(name),
                       " in ", path, ", which has ",
                       Printable(absl::StrJoin(csv.header(), ", "))));
    }
  }
  TrialTable table(std::move(csv));
  for (const absl::string_view field : TableFields()) {
    if (table.csv_.Has(field)) {
      table.templates_[std::string(field)] = absl::StrCat("{", field, "}");
    }
  }
  for (const auto& [field, text] : fields) table.templates_[field] = text;
  for (const absl::string_view needed : {"frames", "label"}) {
    if (table.Has(std::string(needed))) continue;
    return TrialFileInvalid(
        path, absl::StrCat("has no column ", needed, " but ",
                           Printable(absl::StrJoin(table.csv_.header(), ", ")),
                           "; name it here, or say in ", skin_path,
                           " what it is made of: \"fields\": {\"", needed,
                           "\": \"{NAME}\"}"));
  }
  return table;
}

std::string TrialTable::Text(size_t row, const std::string& field) const {
  const auto found = templates_.find(field);
  if (found == templates_.end()) return "";
  std::string text;
  absl::string_view rest = found->second;
  absl::string_view before;
  absl::string_view name;
  while (NextPlaceholder(&rest, &before, &name)) {
    absl::StrAppend(&text, before, csv_.text(row, *csv_.Column(name)));
  }
  return absl::StrCat(text, rest);
}

absl::StatusOr<double> TrialTable::Number(size_t row, const std::string& field,
                                          double absent) const {
  if (!Has(field)) return absent;
  const std::string text = Text(row, field);
  double value = 0;
  if (ParseNumber(text, &value)) return value;
  return Error(row, field,
               absl::StrCat("is ", Quoted(text), "; it must be a number"));
}

absl::Status TrialTable::Error(size_t row, absl::string_view field,
                               absl::string_view message) const {
  return csv_.RowError(row, absl::StrCat(field, ": ", message));
}

}  // namespace tactus
