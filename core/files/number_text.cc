#include "core/files/number_text.h"

#include <algorithm>
#include <array>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/strip.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/base/text_cells.h"
#include "core/base/text_lines.h"
#include "core/files/cell_advice.h"
#include "core/files/number_cells.h"

namespace tactus::internal {
namespace {

using Cells = std::vector<absl::string_view>;

// Lines by which delimiter and decimal sign are detected.
constexpr size_t kSampledLines = 50;
// A line of fewer numbers in order may as well be a frame.
constexpr size_t kLeastNumbersInOrder = 4;
// The first of several equally good delimiters is taken.
constexpr std::array<char, 5> kDelimiters = {'\t', ';', '|', ',', ' '};

struct Line {
  absl::string_view text;
  size_t number = 0;
};

bool IsComment(absl::string_view line) {
  line = absl::StripLeadingAsciiWhitespace(line);
  return absl::StartsWith(line, "#") || absl::StartsWith(line, "%") ||
         absl::StartsWith(line, "//");
}

// One pass through a file: what its format is, then its numbers.
class Parser {
 public:
  Parser(const std::string& path, absl::string_view text,
         const NumberTextFormat& format)
      : path_(path), text_(text), format_(format) {}

  absl::StatusOr<NumberText> Parse() {
    if (const auto fault = TextFileFault(text_); !fault.empty()) {
      return TrialFileInvalid(path_, fault);
    }
    TakeSample();
    if (sample_.empty()) return TrialFileInvalid(path_, "holds no numbers");
    DetectDelimiter();
    TACTUS_RETURN_IF_ERROR(DetectDecimal());
    TACTUS_RETURN_IF_ERROR(DetectHeader());
    TACTUS_RETURN_IF_ERROR(ReadRows());
    if (table_.numbers.empty()) {
      return TrialFileInvalid(path_, "holds no numbers");
    }
    TACTUS_RETURN_IF_ERROR(TakeIndexAway());
    Describe();
    return std::move(table_);
  }

 private:
  template <typename... Parts>
  absl::Status Complain(size_t number, const Parts&... parts) const {
    return TrialFileInvalid(path_,
                            absl::StrCat("line ", number, ": ", parts...));
  }

  // Moves to the next line of cells.
  bool NextLine(TextLines& lines) {
    while (lines.Next()) {
      if (IsComment(lines.line())) {
        if (sample_.empty()) comment_ = lines.line();
        continue;
      }
      // What Excel takes for the delimiter of a file.
      absl::string_view line = absl::StripAsciiWhitespace(lines.line());
      if (lines.number() == 1 && line.size() == 5 &&
          absl::ConsumePrefix(&line, "sep=")) {
        if (format_.delimiter == 0) format_.delimiter = line.front();
        continue;
      }
      return true;
    }
    return false;
  }

  void TakeSample() {
    TextLines lines(text_);
    while (sample_.size() < kSampledLines && NextLine(lines)) {
      sample_.push_back({lines.line(), lines.number()});
    }
  }

  void DetectDelimiter() {
    delimiter_ = format_.delimiter;
    if (delimiter_ != 0) return;
    size_t most_lines = 0;
    size_t most_cells = 0;
    delimiter_ = ',';
    for (const char candidate : kDelimiters) {
      size_t lines = 0;
      size_t numbers = 0;
      Cells cells;
      for (const Line& line : sample_) {
        if (!SplitCells(line.text, candidate, &cells) || cells.size() < 2) {
          continue;
        }
        const auto count = static_cast<size_t>(
            std::count_if(cells.begin(), cells.end(), [](const auto& cell) {
              return IsNumber(cell) || IsMissing(cell);
            }));
        lines += count == cells.size();
        numbers += count;
      }
      if (lines > most_lines || (lines == most_lines && numbers > most_cells)) {
        most_lines = lines;
        most_cells = numbers;
        delimiter_ = candidate;
      }
    }
  }

  absl::Status DetectDecimal() {
    decimal_ = format_.decimal;
    if (decimal_ != 0) return absl::OkStatus();
    decimal_ = '.';
    Cells cells;
    const Line* doubtful = nullptr;
    std::string doubt;
    for (const Line& line : sample_) {
      if (!SplitCells(line.text, delimiter_, &cells)) continue;
      for (const absl::string_view cell : cells) {
        double value = 0;
        if (!absl::StrContains(cell, ',')) continue;
        if (MayHaveThousands(cell)) {
          if (doubtful == nullptr) {
            doubtful = &line;
            doubt = std::string(cell);
          }
        } else if (ParseCell(cell, ',', &value)) {
          decimal_ = ',';
          return absl::OkStatus();
        }
      }
    }
    if (doubtful == nullptr) return CheckPoints();
    return Complain(doubtful->number, Quoted(doubt),
                    " may have a decimal comma or a sign between thousands; "
                    "say \"decimal\": \",\" in skin.json if it is decimal, or "
                    "write numbers without signs between thousands");
  }

  // Points between thousands look like decimal signs.
  absl::Status CheckPoints() {
    std::vector<Cells> rows(sample_.size());
    // The first line may be a header of numbers.
    for (size_t i = 1; i < sample_.size(); ++i) {
      SplitCells(sample_[i].text, delimiter_, &rows[i]);
      for (const auto& cell : rows[i]) {
        points_ |= absl::StrContains(cell, '.') && IsNumber(cell);
      }
    }
    const DoubtfulPoint doubtful = FindDoubtfulPoint(rows);
    if (doubtful.cell.empty()) return absl::OkStatus();
    return Complain(
        sample_[doubtful.row].number, Quoted(doubtful.cell),
        " may have a decimal point or a point between thousands, because "
        "other numbers of its column have none; say \"decimal\": \".\" in "
        "skin.json if it is decimal, or write numbers without signs between "
        "thousands");
  }

  // True if the first cells rise in all lines of the sample, as times do.
  bool FirstColumnRises() const {
    double last = 0;
    for (size_t i = 0; i < sample_.size(); ++i) {
      Cells cells;
      double value = 0;
      if (!SplitCells(sample_[i].text, delimiter_, &cells) || cells.empty() ||
          !ParseCell(cells[0], decimal_, &value) || (i > 0 && value <= last)) {
        return false;
      }
      last = value;
    }
    return sample_.size() > 2;
  }

  // A line of numbers in order is a header, unless the next one is too.
  absl::Status DetectNumberedHeader(const Cells& cells) {
    double first = 0;
    if (!InOrder(cells, &first) || (first != 0 && first != 1) ||
        cells.size() < 2) {
      return absl::OkStatus();
    }
    Cells next;
    double next_first = 0;
    if (sample_.size() > 1 && SplitCells(sample_[1].text, delimiter_, &next) &&
        next.size() == cells.size() && InOrder(next, &next_first)) {
      return absl::OkStatus();
    }
    if (cells.size() < kLeastNumbersInOrder) {
      if (format_.doubtful_line_is_numbers || FirstColumnRises()) {
        return absl::OkStatus();
      }
      return Complain(sample_[0].number, "holds ", absl::StrJoin(cells, ", "),
                      ", which may be a header or a frame; say "
                      "\"header_lines\": 1 or 0 in skin.json");
    }
    numbered_ = true;
    header_lines_ = 1;
    return absl::OkStatus();
  }

  absl::Status DetectHeader() {
    Cells cells;
    if (format_.header_lines >= 0) {
      header_lines_ = static_cast<size_t>(format_.header_lines);
      return absl::OkStatus();
    }
    if (!SplitCells(sample_[0].text, delimiter_, &cells)) {
      return Complain(sample_[0].number, "has a quote that is not closed");
    }
    // A column without a name in front is an index.
    Cells named(cells.begin() + (cells.size() > 1 && cells[0].empty() ? 1 : 0),
                cells.end());
    if (named.size() > 1 && named.back().empty()) named.pop_back();
    Cells numbers;
    size_t missing = 0;
    size_t empty = 0;
    absl::string_view word;
    for (const absl::string_view cell : named) {
      if (IsNumber(cell)) {
        numbers.push_back(cell);
      } else if (IsMissing(cell)) {
        missing += !cell.empty();
        empty += cell.empty();
      } else if (word.empty()) {
        word = cell;
      }
    }
    double first = 0;
    if (word.empty()) {
      missing += empty;
      if (missing == 0 && named.size() < cells.size() && cells[0].empty() &&
          InOrder(named, &first)) {
        numbered_ = true;
        header_lines_ = 1;
        return absl::OkStatus();
      }
      return missing > 0 ? absl::OkStatus() : DetectNumberedHeader(named);
    }
    if (missing > 0 || (!numbers.empty() && !InOrder(numbers, &first))) {
      return Complain(sample_[0].number,
                      "is neither a line of names nor one of numbers: it holds "
                      "the cell ",
                      Quoted(word),
                      ". If names or notes precede the numbers, say how many "
                      "lines: \"header_lines\": 2 in skin.json");
    }
    header_lines_ = 1;
    return absl::OkStatus();
  }

  // The names in a comment before the first line, as numpy.savetxt writes them.
  void TakeCommentedHeader(size_t width) {
    if (!table_.header.empty() || header_lines_ > 0 || comment_.empty() ||
        width < 2) {
      return;
    }
    absl::string_view text = absl::StripLeadingAsciiWhitespace(comment_);
    text.remove_prefix(std::min(text.find_first_not_of("#%/"), text.size()));
    Cells cells;
    if (!SplitCells(text, delimiter_, &cells) || cells.size() != width) return;
    for (const absl::string_view cell : cells) {
      if (IsNumber(cell) || IsMissing(cell)) return;
    }
    for (const absl::string_view cell : cells) {
      table_.header.push_back(Printable(cell));
    }
    commented_ = true;
  }

  // What to do about a first line of `names` cells before `width` numbers.
  std::string WidthAdvice(size_t width, size_t names) const {
    std::string advice =
        delimiter_ == ',' && width == 2 * names
            ? ". If commas are decimal signs too, write the file with "
              "semicolons or points"
            : absl::StrCat(". Cells are separated by ",
                           DelimiterName(delimiter_),
                           "; if that is wrong, say \"delimiter\" in "
                           "skin.json");
    if (names == 1) {
      absl::StrAppend(&advice,
                      ". If the first line is a title, say how many lines "
                      "precede the numbers: \"header_lines\": 2 in skin.json");
    }
    return advice;
  }

  // Fixes the columns by the first line of numbers.
  absl::Status TakeWidth(size_t number, const Cells& cells,
                         const std::vector<Cells>& headers) {
    size_t width = cells.size();
    // A column that is named and empty is none that ends each line.
    trailing_ =
        width > 1 && cells.back().empty() &&
        std::none_of(headers.begin(), headers.end(), [&](const Cells& header) {
          return header.size() == width && !header.back().empty();
        });
    for (const Cells& header : headers) {
      // An end that is empty in names and numbers, or in one of both.
      const bool open = header.size() > 1 && header.back().empty();
      const size_t names = header.size() - (open ? 1 : 0);
      const size_t numbers = width - (trailing_ ? 1 : 0);
      // A table of R has no name for the names of the rows.
      const bool row_names = names + 1 == numbers && delimiter_ == ' ';
      if (names != numbers && !row_names) continue;
      if (row_names) table_.header.emplace_back();
      for (size_t i = 0; i < names; ++i) {
        table_.header.push_back(Printable(header[i]));
      }
      break;
    }
    if (trailing_) --width;
    if (!headers.empty() && table_.header.empty() && format_.header_lines < 0) {
      const size_t names = headers.front().size();
      return Complain(number, "has ", width, " cells; the first line has ",
                      names, WidthAdvice(width, names));
    }
    if (width > limits::kMaxTaxels + size_t{16}) {
      return Complain(number, "has ", width, " columns");
    }
    TakeCommentedHeader(width);
    table_.columns = width;
    return absl::OkStatus();
  }

  std::string CellName(size_t column) const {
    return table_.header.empty() || numbered_ || table_.header[column].empty()
               ? absl::StrCat("cell ", column + 1)
               : table_.header[column];
  }

  // Why a cell is no number, and what to do about it.
  std::string Advice(absl::string_view cell, bool first_row) const {
    if (std::string advice = CellAdvice(cell, decimal_); !advice.empty()) {
      return advice;
    }
    if (first_row && header_lines_ > 0 && format_.header_lines < 0) {
      return absl::StrCat(
          ". If more lines precede the numbers, say "
          "\"header_lines\": ",
          header_lines_ + 1, " in skin.json");
    }
    for (const char other : kDelimiters) {
      if (other == delimiter_ || !absl::StrContains(cell, other)) continue;
      return absl::StrCat(". Cells are separated by ",
                          DelimiterName(delimiter_),
                          "; if that is wrong, say \"delimiter\" in skin.json");
    }
    return "";
  }

  absl::Status ReadRow(size_t number, Cells& cells, bool first_row, bool last) {
    if (trailing_ && cells.size() == table_.columns + 1 &&
        cells.back().empty()) {
      cells.pop_back();
    }
    if (cells.size() != table_.columns) {
      return Complain(number, "has ", cells.size(),
                      " cells; the first line has ", table_.columns,
                      last && cells.size() < table_.columns
                          ? ". It is the last line, so the file may be cut off"
                          : "");
    }
    if (table_.numbers.size() + cells.size() > limits::kMaxCsvCells) {
      return Complain(number, "is beyond the ", limits::kMaxCsvCells,
                      " cells that are read of a file");
    }
    for (size_t i = 0; i < cells.size(); ++i) {
      double value = 0;
      if (!ParseCell(cells[i], decimal_, &value)) {
        if (header_line_ == current_) {
          return Complain(number,
                          "repeats the header, as in files that were joined; "
                          "make a file of each part");
        }
        return Complain(number, CellName(i), " is ", Quoted(cells[i]),
                        "; it must be a finite number",
                        Advice(cells[i], first_row));
      }
      table_.numbers.push_back(value);
    }
    return absl::OkStatus();
  }

  absl::Status ReadRows() {
    TextLines lines(text_);
    Cells cells;
    std::vector<Cells> headers;
    size_t line = 0;
    while (NextLine(lines)) {
      current_ = lines.line();
      const bool split = SplitCells(lines.line(), delimiter_, &cells);
      if (line++ < header_lines_) {
        if (line == 1) {
          header_line_ = lines.line();
          header_number_ = lines.number();
        }
        if (split) headers.push_back(cells);
        continue;
      }
      if (!split) {
        return Complain(lines.number(),
                        "has a quote that is not closed, or text behind one");
      }
      const bool first_row = table_.columns == 0;
      if (first_row) {
        TACTUS_RETURN_IF_ERROR(TakeWidth(lines.number(), cells, headers));
      }
      TACTUS_RETURN_IF_ERROR(
          ReadRow(lines.number(), cells, first_row, lines.last()));
    }
    return absl::OkStatus();
  }

  static bool IsUnnamed(absl::string_view name) {
    return name.empty() || name == "Unnamed: 0";
  }

  // A first column without a name counts the rows, and is none of the
  // recording.
  absl::Status TakeIndexAway() {
    std::vector<std::string>& header = table_.header;
    const size_t rows = table_.numbers.size() / table_.columns;
    for (size_t i = 0; i < header.size(); ++i) {
      if (!IsUnnamed(header[i])) continue;
      bool counts = i == 0 && table_.columns > 1;
      for (size_t row = 1; counts && row < rows; ++row) {
        counts = table_.numbers[row * table_.columns] ==
                 table_.numbers[0] + static_cast<double>(row);
      }
      if (counts) {
        index_ = true;
        continue;
      }
      return Complain(header_number_, "column ", i + 1,
                      " has no name, and its numbers do not count the lines; "
                      "name it");
    }
    if (!index_) return absl::OkStatus();
    size_t to = 0;
    for (size_t from = 0; from < table_.numbers.size(); ++from) {
      if (from % table_.columns == 0) continue;
      table_.numbers[to++] = table_.numbers[from];
    }
    table_.numbers.resize(to);
    --table_.columns;
    header.erase(header.begin());
    return absl::OkStatus();
  }

  void Describe() {
    if (format_.delimiter != 0 && format_.decimal != 0 &&
        format_.header_lines >= 0 && !index_) {
      return;
    }
    std::vector<std::string> parts;
    if (table_.columns > 1) {
      parts.push_back(
          absl::StrCat("cells are separated by ", DelimiterName(delimiter_)));
    }
    if (decimal_ == ',') parts.emplace_back("the decimal sign is a comma");
    // Such files often have a decimal comma, and points between thousands.
    if (points_ && delimiter_ == ';') {
      parts.emplace_back("the decimal sign is a point");
    }
    parts.push_back(commented_ ? "a comment names the columns"
                    : numbered_
                        ? "the first line, numbers in order, is a header"
                    : table_.header.empty() ? "no line names the columns"
                                            : "a line names the columns");
    if (index_) {
      parts.emplace_back("the first column counts the lines and is left out");
    }
    table_.found = absl::StrJoin(parts, ", ");
  }

  const std::string& path_;
  const absl::string_view text_;
  NumberTextFormat format_;
  std::vector<Line> sample_;
  absl::string_view comment_;
  char delimiter_ = ',';
  char decimal_ = '.';
  size_t header_lines_ = 0;
  // The header is numbers in order.
  bool numbered_ = false;
  // The header is a comment.
  bool commented_ = false;
  // Lines end with an empty cell.
  bool trailing_ = false;
  bool index_ = false;
  // Some numbers have a point.
  bool points_ = false;
  absl::string_view header_line_ = "\n";
  size_t header_number_ = 1;
  absl::string_view current_;
  NumberText table_;
};

}  // namespace

absl::StatusOr<NumberText> ParseNumberText(const std::string& path,
                                           absl::string_view text,
                                           const NumberTextFormat& format) {
  return Parser(path, text, format).Parse();
}

}  // namespace tactus::internal
