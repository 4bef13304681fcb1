#include "tools/common/text_canvas.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "core/base/text.h"

namespace tactus::internal::client {
namespace {

// Bytes of the character that begins with `first`.
size_t LengthOf(char first) {
  const auto byte = static_cast<unsigned char>(first);
  if (byte >= 0xF0) return 4;
  if (byte >= 0xE0) return 3;
  return byte >= 0xC0 ? 2 : 1;
}

std::string Escape(int foreground, int background) {
  std::string escape = "\x1b[0";
  if (foreground >= 0) absl::StrAppend(&escape, ";38;5;", foreground);
  if (background >= 0) absl::StrAppend(&escape, ";48;5;", background);
  return escape + "m";
}

}  // namespace

TextCanvas::TextCanvas(int columns, int rows)
    : columns_(std::max(columns, 0)),
      rows_(std::max(rows, 0)),
      cells_(static_cast<size_t>(columns_) * rows_) {}

void TextCanvas::Put(int column, int row, absl::string_view character,
                     int foreground, int background) {
  if (column < 0 || column >= columns_ || row < 0 || row >= rows_) return;
  cells_[static_cast<size_t>(row) * columns_ + column] = {
      std::string(character), foreground, background};
}

void TextCanvas::Text(int column, int row, absl::string_view text,
                      int foreground) {
  const std::string printable = Printable(text);
  for (size_t at = 0; at < printable.size(); ++column) {
    const size_t length = LengthOf(printable[at]);
    Put(column, row, absl::string_view(printable).substr(at, length),
        foreground);
    at += length;
  }
}

std::vector<std::string> TextCanvas::Lines(bool colour) const {
  std::vector<std::string> lines(rows_);
  for (int row = 0; row < rows_; ++row) {
    const Cell* const cells =
        cells_.data() + static_cast<size_t>(row) * columns_;
    int end = columns_;
    while (end > 0 && cells[end - 1].character == " " &&
           (!colour || cells[end - 1].background == kUsual)) {
      --end;
    }
    int foreground = kUsual;
    int background = kUsual;
    std::string& line = lines[row];
    for (int column = 0; column < end; ++column) {
      const Cell& cell = cells[column];
      if (colour &&
          (cell.foreground != foreground || cell.background != background)) {
        foreground = cell.foreground;
        background = cell.background;
        line += Escape(foreground, background);
      }
      line += cell.character;
    }
    if (foreground != kUsual || background != kUsual) line += "\x1b[0m";
  }
  return lines;
}

}  // namespace tactus::internal::client
