// File: text_lines.h
//
// TextLines: the lines of a text file, whichever program ended them: LF, CR LF
// or CR, with or without a byte order mark, empty lines left out.
//
//   TextLines lines(text);
//   while (lines.Next()) Use(lines.number(), lines.line());
//
// Refers to the text, which must outlive it. Not thread-safe.
#pragma once

#include <algorithm>
#include <cstddef>

#include "absl/strings/ascii.h"
#include "absl/strings/string_view.h"
#include "absl/strings/strip.h"

namespace tactus::internal {

class TextLines {
 public:
  explicit TextLines(absl::string_view text)
      : rest_(text),
        end_(text.find('\n') == absl::string_view::npos ? '\r' : '\n') {
    absl::ConsumePrefix(&rest_, "\xEF\xBB\xBF");
  }

  // Moves to the next line that is not empty; false behind the last one.
  bool Next() {
    while (!rest_.empty()) {
      const size_t end = std::min(rest_.find(end_), rest_.size());
      line_ = rest_.substr(0, end);
      rest_.remove_prefix(std::min(end + 1, rest_.size()));
      while (absl::ConsumeSuffix(&line_, "\r")) {
      }
      ++number_;
      if (!absl::StripAsciiWhitespace(line_).empty()) return true;
    }
    return false;
  }

  absl::string_view line() const { return line_; }
  // Counted from 1, empty lines too.
  size_t number() const { return number_; }
  // True on the last line of the text.
  bool last() const { return rest_.empty(); }

 private:
  absl::string_view rest_;
  const char end_;
  absl::string_view line_;
  size_t number_ = 0;
};

// Why the bytes are those of no text that is read, and what to do: UTF-16, or
// a packed file. Empty for other bytes.
absl::string_view EncodingFault(absl::string_view text);

// The same, and any other bytes that are no text at all.
absl::string_view TextFileFault(absl::string_view text);

}  // namespace tactus::internal
