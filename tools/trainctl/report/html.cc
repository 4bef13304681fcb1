#include "tools/trainctl/report/html.h"

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "tools/common/json.h"

namespace tactus::internal::client {
namespace {

constexpr char kStyle[] =
    ":root{color-scheme:light}"
    "body{font:15px/1.45 sans-serif;margin:0;color:#222;background:#fff}"
    "main{max-width:62rem;margin:0 auto;padding:1rem 1rem 4rem}"
    "h1{font-size:1.5rem;margin:.8rem 0;overflow-wrap:anywhere}"
    "h2{font-size:1.15rem;margin:2.4rem 0 .6rem}"
    "p{margin:.5rem 0;overflow-wrap:anywhere}"
    ".wide{overflow-x:auto;margin:.6rem 0 1.2rem}"
    "table{border-collapse:collapse}"
    "td,th{border:1px solid #ccc;padding:.2rem .6rem;text-align:right;"
    "white-space:nowrap;font-variant-numeric:tabular-nums}"
    "th{background:#f3f3f3;font-weight:600;white-space:normal}"
    "td.t,th.t{text-align:left}"
    "td.t{white-space:pre-wrap;overflow-wrap:anywhere;min-width:5rem;"
    "max-width:26rem}"
    "th.v{writing-mode:vertical-rl;text-align:right;padding:.5rem .2rem;"
    "max-height:16rem}"
    "th.own,th.v{white-space:pre-wrap}"
    ".big{font-size:2.6rem;font-weight:600;line-height:1.1;margin:.4rem 0 0}"
    "img{display:block;width:100%;max-width:50rem;height:auto;"
    "margin:.6rem 0 1.4rem}";

}  // namespace

std::string Escaped(absl::string_view text) {
  // JSON's writer repairs UTF-8.
  const std::string repaired =
      Json::parse(JsonText(Json(std::string(text)))).get<std::string>();
  std::string html;
  for (const char c : repaired) {
    switch (c) {
      case '&':
        html += "&amp;";
        break;
      case '<':
        html += "&lt;";
        break;
      case '>':
        html += "&gt;";
        break;
      case '"':
        html += "&quot;";
        break;
      case '\'':
        html += "&#39;";
        break;
      default:
        if (absl::ascii_iscntrl(static_cast<unsigned char>(c)) && c != '\n' &&
            c != '\t') {
          html += "\uFFFD";
        } else {
          html += c;
        }
    }
  }
  return html;
}

Html::Html(absl::string_view title) {
  Add("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, "
      "initial-scale=1\">\n<title>",
      Escaped(title), "</title>\n<style>", kStyle,
      "</style>\n</head>\n<body>\n<main>\n<h1>", Escaped(title), "</h1>\n");
}

void Html::Heading(absl::string_view text) {
  Add("<h2>", Escaped(text), "</h2>\n");
}

void Html::Paragraph(absl::string_view text) {
  Add("<p>", Escaped(text), "</p>\n");
}

void Html::Table(const std::vector<HtmlColumn>& columns,
                 const std::vector<std::vector<std::string>>& rows) {
  Add("<div class=\"wide\">\n<table>\n<thead><tr>");
  for (const HtmlColumn& column : columns) {
    Add("<th scope=\"col\"", column.number ? "" : " class=\"t\"", ">",
        Escaped(column.title), "</th>");
  }
  Add("</tr></thead>\n<tbody>\n");
  for (const std::vector<std::string>& row : rows) {
    Add("<tr>");
    for (size_t i = 0; i < row.size(); ++i) {
      if (columns[i].number) {
        Add("<td>", Escaped(row[i]), "</td>");
      } else {
        // Names of another direction of writing keep to their cell.
        Add("<td class=\"t\"><bdi>", Escaped(row[i]), "</bdi></td>");
      }
    }
    Add("</tr>\n");
  }
  Add("</tbody>\n</table>\n</div>\n");
}

void Html::Picture(absl::string_view description, absl::string_view png) {
  Add("<img alt=\"", Escaped(description), "\" src=\"data:image/png;base64,",
      absl::Base64Escape(png), "\">\n");
}

std::string Html::Finish() const {
  return absl::StrCat(text_, "</main>\n</body>\n</html>\n");
}

}  // namespace tactus::internal::client
