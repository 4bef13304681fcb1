#include "core/import/trial_table.h"

#include <algorithm>
#include <filesystem>
#include <iterator>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/import/mistakes.h"
#include "core/import/skin_file.h"

namespace tactus::internal {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMostNamedFiles = 1'000'000;

// True if the name has an ending of files of frames.
bool IsRecording(const std::string& file) {
  constexpr absl::string_view kEndings[] = {".csv", ".tsv", ".npy",  ".npz",
                                            ".h5",  ".mat", ".hdf5", ".bag",
                                            ".db3", ".mcap"};
  return std::any_of(std::begin(kEndings), std::end(kEndings),
                     [&](const auto& ending) {
                       return absl::EndsWithIgnoreCase(file, ending);
                     });
}

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
    const std::map<std::string, std::string>& fields,
    const FileNamePattern* names, bool is_labelled) {
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
  if (names != nullptr && table.Has("frames")) {
    TACTUS_RETURN_IF_ERROR(table.TakeNames(*names));
  }
  for (const absl::string_view needed : {"frames", "label"}) {
    if (table.Has(std::string(needed))) continue;
    if (is_labelled && needed == "label") continue;
    return TrialFileInvalid(
        path, absl::StrCat("has no column ", needed, " but ",
                           Printable(absl::StrJoin(table.csv_.header(), ", ")),
                           "; name it here, or say in ", skin_path,
                           " what it is made of: \"fields\": {\"", needed,
                           "\": \"{NAME}\"}"));
  }
  return table;
}

absl::Status TrialTable::TakeNames(const FileNamePattern& names) {
  Mistakes mistakes("file_names");
  for (size_t row = 0; row < rows(); ++row) {
    const std::string file = Text(row, "frames");
    auto fields = names.Match(file);
    if (fields.ok()) {
      names_.push_back(*std::move(fields));
    } else {
      TACTUS_RETURN_IF_ERROR(mistakes.Add(file, fields.status()));
    }
  }
  return mistakes.Status();
}

absl::StatusOr<TrialTable> TrialTable::OfFiles(
    const std::string& folder, const std::vector<std::string>& files) {
  std::string text = "frames\n";
  for (const std::string& file : files) {
    absl::StrAppend(&text, "\"", absl::StrReplaceAll(file, {{"\"", "\"\""}}),
                    "\"\n");
  }
  TACTUS_ASSIGN_OR_RETURN(CsvTable csv, CsvTable::Parse(folder, text));
  TrialTable table(std::move(csv));
  table.path_ = folder;
  table.from_names_ = true;
  table.templates_["frames"] = "{frames}";
  return table;
}

absl::StatusOr<TrialTable> TrialTable::OfOne(const std::string& folder,
                                             const std::string& file) {
  return OfFiles(folder, {file});
}

absl::StatusOr<TrialTable> TrialTable::FromNames(
    const std::string& folder, const FileNamePattern& names,
    std::vector<std::string>* left_out, bool is_labelled) {
  std::vector<std::string> files;
  std::error_code error;
  for (fs::recursive_directory_iterator it(folder, error), end;
       !error && it != end; it.increment(error)) {
    std::error_code no_file;
    if (!it->is_regular_file(no_file)) continue;
    const std::string file = fs::relative(it->path(), folder, no_file).string();
    if (names.Fits(file)) {
      files.push_back(file);
    } else if (IsRecording(file)) {
      left_out->push_back(file);
    }
    if (files.size() > kMostNamedFiles) {
      return TrialFileInvalid(folder,
                              absl::StrCat("holds more than ", kMostNamedFiles,
                                           " files; name them in a table"));
    }
  }
  if (error) return IoError(folder, error.message());
  if (files.empty()) {
    return TrialFileInvalid(
        folder,
        absl::StrCat("holds no file whose name fits the pattern",
                     left_out->empty()
                         ? ""
                         : absl::StrCat(", but ", Quoted(left_out->front()))));
  }
  std::sort(files.begin(), files.end());
  TACTUS_ASSIGN_OR_RETURN(TrialTable table, OfFiles(folder, files));
  TACTUS_RETURN_IF_ERROR(table.TakeNames(names));
  if (is_labelled || table.Has("label")) return table;
  return InvalidConfig("pattern of file names", "without {label}",
                       "one with {label}, because there is no table of labels");
}

std::string TrialTable::Text(size_t row, const std::string& field) const {
  const auto found = templates_.find(field);
  if (found == templates_.end()) {
    if (row >= names_.size()) return "";
    const auto named = names_[row].find(field);
    return named == names_[row].end() ? "" : named->second;
  }
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
  if (from_names_) {
    return TrialFileInvalid(absl::StrCat(path_, "/", Text(row, "frames")),
                            absl::StrCat(field, ": ", message));
  }
  return csv_.RowError(row, absl::StrCat(field, ": ", message));
}

}  // namespace tactus::internal
