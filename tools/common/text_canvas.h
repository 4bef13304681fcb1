// File: text_canvas.h
//
// TextCanvas: a rectangle of characters with colours, as a terminal shows it.
//
//   TextCanvas canvas(80, 24);
//   canvas.Text(0, 0, "force");
//   canvas.Put(10, 0, "▀", /*foreground=*/208, /*background=*/16);
//   for (const std::string& line : canvas.Lines(/*colour=*/true)) Print(line);
//
// What lies outside is cut off. Owns its cells. Not thread-safe.
#pragma once

#include <string>
#include <vector>

#include "absl/strings/string_view.h"

namespace tactus::internal::client {

class TextCanvas {
 public:
  // The terminal's usual colour.
  static constexpr int kUsual = -1;

  TextCanvas(int columns, int rows);

  int columns() const { return columns_; }
  int rows() const { return rows_; }

  // One character of UTF-8 that is one column wide, in colours of the
  // 256-colour palette.
  void Put(int column, int row, absl::string_view character,
           int foreground = kUsual, int background = kUsual);
  // Text, a character per column; malformed UTF-8 and control characters become
  // question marks.
  void Text(int column, int row, absl::string_view text,
            int foreground = kUsual);

  // One line per row, without blanks at its end. With `colour`, colours are
  // ANSI escapes, and each line ends with the usual colour.
  std::vector<std::string> Lines(bool colour) const;

 private:
  struct Cell {
    std::string character = " ";
    int foreground = kUsual;
    int background = kUsual;
  };

  const int columns_;
  const int rows_;
  std::vector<Cell> cells_;
};

}  // namespace tactus::internal::client
