#include "core/import/file_names.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/import/skin_file.h"

namespace tactus::internal {
namespace {

constexpr absl::string_view kWhat = "pattern of file names";
constexpr size_t kMostPatternBytes = 1000;
// Longer names are no names of files.
constexpr size_t kMostNameBytes = 4096;

absl::Status CheckField(const std::string& pattern, const std::string& field) {
  const auto& known = TableFields();
  if (field != "frames" &&
      std::find(known.begin(), known.end(), field) != known.end()) {
    return absl::OkStatus();
  }
  std::vector<absl::string_view> names(known.begin() + 1, known.end());
  return InvalidConfig(
      kWhat, Quoted(pattern),
      absl::StrCat("one of fields of a trial, and ", Quoted(field),
                   " is none; use ", absl::StrJoin(names, ", "),
                   ", or {} for text that is no field"));
}

// What the two expressions of a template are made of.
struct Expressions {
  std::string few;
  std::string many;
};

// "{label}_{group}.csv" as "([^/]+?)_([^/]+?)\.csv".
absl::Status FromTemplate(const std::string& text, Expressions* out,
                          std::vector<std::string>* groups) {
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '{') {
      const size_t end = text.find('}', i);
      if (end == std::string::npos) {
        return InvalidConfig(kWhat, Quoted(text), "one with a } for each {");
      }
      const std::string field = text.substr(i + 1, end - i - 1);
      if (!field.empty()) {
        TACTUS_RETURN_IF_ERROR(CheckField(text, field));
      }
      groups->push_back(field);
      out->few += "([^/]+?)";
      out->many += "([^/]+)";
      i = end;
      continue;
    }
    const std::string literal =
        absl::StrContains(R"(\^$.|?*+()[]})", text[i])
            ? absl::StrCat("\\", std::string(1, text[i]))
            : std::string(1, text[i]);
    out->few += literal;
    out->many += literal;
  }
  return absl::OkStatus();
}

// "(?<label>a)(b)" as "(a)(b)", with the groups "label" and "".
absl::Status FromExpression(const std::string& text, Expressions* out,
                            std::vector<std::string>* groups) {
  std::string plain;
  bool in_class = false;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\\' && i + 1 < text.size()) {
      plain += text.substr(i++, 2);
      continue;
    }
    if (text[i] == '[') in_class = true;
    if (text[i] == ']') in_class = false;
    plain += text[i];
    if (text[i] != '(' || in_class) continue;
    const absl::string_view rest = absl::string_view(text).substr(i + 1);
    const bool python = absl::StartsWith(rest, "?P<");
    if (!python &&
        (!absl::StartsWith(rest, "?<") || absl::StartsWith(rest, "?<=") ||
         absl::StartsWith(rest, "?<!"))) {
      if (!absl::StartsWith(rest, "?")) groups->emplace_back();
      continue;
    }
    const size_t begin = i + (python ? 4 : 3);
    const size_t end = text.find('>', begin);
    if (end == std::string::npos) {
      return InvalidConfig(kWhat, Quoted(text), "one with a > for each (?<");
    }
    groups->push_back(text.substr(begin, end - begin));
    TACTUS_RETURN_IF_ERROR(CheckField(text, groups->back()));
    i = end;
  }
  out->few = out->many = plain;
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<FileNamePattern> FileNamePattern::Parse(
    const std::string& text) {
  FileNamePattern pattern;
  pattern.text_ = text;
  if (text.empty() || text.size() > kMostPatternBytes) {
    return InvalidConfig(kWhat, Quoted(text),
                         "a template like {label}_{group}.csv");
  }
  Expressions expressions;
  const bool regular = absl::StrContains(text, "(?");
  TACTUS_RETURN_IF_ERROR(
      regular ? FromExpression(text, &expressions, &pattern.groups_)
              : FromTemplate(text, &expressions, &pattern.groups_));
  std::set<std::string> seen;
  for (const std::string& group : pattern.groups_) {
    if (group.empty() || seen.insert(group).second) continue;
    return InvalidConfig(kWhat, Quoted(text),
                         absl::StrCat("one that names ", group, " once"));
  }
  if (seen.empty()) {
    return InvalidConfig(kWhat, Quoted(text),
                         "one with a field, like {label}_{group}.csv");
  }
  // The library reports by exception only what is wrong with an expression.
  try {
    pattern.few_ = std::regex(expressions.few);
    pattern.many_ = std::regex(expressions.many);
  } catch (const std::regex_error& error) {
    return InvalidConfig(kWhat, Quoted(text),
                         "a regular expression of ECMAScript");
  }
  return pattern;
}

std::string FileNamePattern::Covered(const std::string& file) const {
  return absl::StrContains(text_, '/')
             ? file
             : std::filesystem::path(file).filename().string();
}

std::map<std::string, std::string> FileNamePattern::FieldsOf(
    const std::smatch& match) const {
  std::map<std::string, std::string> fields;
  for (size_t i = 0; i < groups_.size(); ++i) {
    if (!groups_[i].empty()) fields[groups_[i]] = match[i + 1].str();
  }
  return fields;
}

bool FileNamePattern::Fits(const std::string& file) const {
  const std::string name = Covered(file);
  // The library reports by exception if an expression is too complex.
  try {
    return name.size() <= kMostNameBytes && std::regex_match(name, few_);
  } catch (const std::regex_error& error) {
    return false;
  }
}

absl::StatusOr<std::map<std::string, std::string>> FileNamePattern::Match(
    const std::string& file) const {
  if (!Fits(file)) {
    return TrialFileInvalid(
        file, absl::StrCat("does not fit the pattern ", Quoted(text_)));
  }
  const std::string name = Covered(file);
  std::smatch few;
  std::smatch many;
  try {
    std::regex_match(name, few, few_);
    std::regex_match(name, many, many_);
  } catch (const std::regex_error& error) {
    return TrialFileInvalid(
        file, absl::StrCat("is too long for the pattern ", Quoted(text_)));
  }
  const auto fields = FieldsOf(few);
  const auto others = FieldsOf(many);
  for (const auto& [field, value] : fields) {
    if (others.at(field) == value) continue;
    return TrialFileInvalid(
        file, absl::StrCat("fits the pattern ", Quoted(text_),
                           " in several ways: its ", field, " may be ",
                           Quoted(value), " or ", Quoted(others.at(field)),
                           "; use a regular expression, such as "
                           "(?<label>[a-z]+)_(?<group>.+)[.]csv"));
  }
  return fields;
}

std::vector<std::string> FileNamePattern::fields() const {
  std::vector<std::string> fields;
  for (const std::string& group : groups_) {
    if (!group.empty()) fields.push_back(group);
  }
  return fields;
}

}  // namespace tactus::internal
