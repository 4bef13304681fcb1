#include "core/base/text_cells.h"

#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/base/text_lines.h"

namespace tactus::internal {
namespace {

bool IsBlank(char c) { return c == ' ' || c == '\t'; }

// The end of a quoted cell that begins at `text`: its closing quote.
size_t ClosingQuote(absl::string_view text) {
  size_t at = text.find('"', 1);
  while (at != absl::string_view::npos && at + 1 < text.size() &&
         text[at + 1] == '"') {
    at = text.find('"', at + 2);
  }
  return at;
}

}  // namespace

absl::string_view EncodingFault(absl::string_view text) {
  const auto begins = [&](absl::string_view with) {
    return absl::StartsWith(text, with);
  };
  // The first character of a table is ASCII, so one of its two bytes is zero.
  const bool utf16 = text.size() >= 4 && text.size() % 2 == 0 &&
                     ((text[0] == '\0' && text[1] != '\0' && text[2] == '\0') ||
                      (text[0] != '\0' && text[1] == '\0' && text[3] == '\0'));
  if (begins("\xFF\xFE") || begins("\xFE\xFF") || utf16) {
    return "is UTF-16 text; save it as UTF-8";
  }
  if (begins("\x1F\x8B")) return "is packed with gzip; unpack it with gunzip";
  if (begins("PK\x03\x04")) {
    return "is a ZIP archive, as files of Excel are; unpack it, or save the "
           "sheet as CSV";
  }
  if (begins("\x89HDF")) return "is an HDF5 file; give it the ending .h5";
  if (begins("\x93NUMPY")) return "is an array of NumPy; name it .npy";
  return "";
}

absl::string_view TextFileFault(absl::string_view text) {
  const absl::string_view fault = EncodingFault(text);
  if (!fault.empty()) return fault;
  if (text.find('\0') != absl::string_view::npos) {
    return "holds zero bytes, so it is no text";
  }
  return "";
}

bool SplitCells(absl::string_view line, char delimiter,
                std::vector<absl::string_view>* cells) {
  cells->clear();
  if (delimiter == ' ') line = absl::StripAsciiWhitespace(line);
  while (true) {
    const auto begin = std::find_if(line.begin(), line.end(), [&](char c) {
      return !IsBlank(c) || c == delimiter;
    });
    line.remove_prefix(static_cast<size_t>(begin - line.begin()));
    if (!line.empty() && line.front() == '"') {
      const size_t close = ClosingQuote(line);
      if (close == absl::string_view::npos) return false;
      cells->push_back(line.substr(1, close - 1));
      line.remove_prefix(close + 1);
      if (delimiter == ' ') {
        if (line.empty()) return true;
        if (!IsBlank(line.front())) return false;
        line = absl::StripLeadingAsciiWhitespace(line);
        continue;
      }
      const size_t next = std::min(line.find(delimiter), line.size());
      if (!absl::StripAsciiWhitespace(line.substr(0, next)).empty()) {
        return false;
      }
      if (next == line.size()) return true;
      line.remove_prefix(next + 1);
      continue;
    }
    const size_t end = std::min(
        delimiter == ' ' ? line.find_first_of(" \t") : line.find(delimiter),
        line.size());
    cells->push_back(absl::StripAsciiWhitespace(line.substr(0, end)));
    if (end == line.size()) return true;
    line.remove_prefix(end + 1);
    if (delimiter == ' ') line = absl::StripLeadingAsciiWhitespace(line);
  }
}

std::string DelimiterName(char delimiter) {
  switch (delimiter) {
    case ',':
      return "commas";
    case ';':
      return "semicolons";
    case '\t':
      return "tabs";
    case ' ':
      return "blanks";
    default:
      return absl::StrCat(std::string(1, delimiter), " signs");
  }
}

}  // namespace tactus::internal
