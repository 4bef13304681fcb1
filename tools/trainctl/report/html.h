// File: html.h
//
// The few parts that an HTML page of trainctl is made of. All text is escaped
// here, so names may hold anything.
//
//   Html page("Evaluation of arm.h5");
//   page.Add("<h1>", Escaped("a < b"), "</h1>\n");
//   page.Picture("Accuracy over time", png);
//   page.Finish();  // the whole page
//
// Owns its text; one thread at a time.
#pragma once

#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"

namespace tactus::internal::client {

// `text` for the content of an element or an attribute in quotes. What is not
// UTF-8 and control characters become U+FFFD.
std::string Escaped(absl::string_view text);

// A column of a table: its title, and whether it holds numbers.
struct HtmlColumn {
  std::string title;
  bool number = true;
};

class Html {
 public:
  explicit Html(absl::string_view title);

  // Adds HTML as it is; texts of others must be Escaped().
  template <typename... Parts>
  void Add(const Parts&... html) {
    absl::StrAppend(&text_, html...);
  }

  void Heading(absl::string_view text);
  void Paragraph(absl::string_view text);
  // Cells are texts, as many in each row as there are columns. The table can be
  // moved sideways where the window is narrow.
  void Table(const std::vector<HtmlColumn>& columns,
             const std::vector<std::vector<std::string>>& rows);
  // A PNG file, inside the page, at most as wide as the window.
  void Picture(absl::string_view description, absl::string_view png);

  std::string Finish() const;

 private:
  std::string text_;
};

}  // namespace tactus::internal::client
