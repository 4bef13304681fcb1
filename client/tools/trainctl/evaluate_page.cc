#include "client/tools/trainctl/evaluate_page.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "client/tools/trainctl/text.h"

namespace tactus::client {
namespace {

constexpr char kStyle[] =
    "body{font:15px/1.4 sans-serif;margin:2em;color:#222}"
    "table{border-collapse:collapse;margin:.5em 0 2em}"
    "td,th{border:1px solid #ccc;padding:.2em .6em;text-align:right}"
    "th{background:#f3f3f3}td.t,th.t{text-align:left}"
    "th.v{writing-mode:vertical-rl;text-align:right}";

std::string Escaped(const std::string& text) {
  return absl::StrReplaceAll(
      text, {{"&", "&amp;"}, {"<", "&lt;"}, {">", "&gt;"}, {"\"", "&quot;"}});
}

std::string PercentOrDash(const Json& fraction) {
  return fraction.is_number() ? Percent(fraction.get<double>()) : "-";
}

std::string ClassTable(const Json& per_class) {
  std::string html =
      "<table><tr><th class=t>class<th>contacts<th>right<th>recall"
      "<th>95 % interval<th>answers<th>precision</tr>\n";
  for (const Json& c : per_class) {
    absl::StrAppendFormat(
        &html,
        "<tr><td class=t>%s<td>%d<td>%d<td>%s<td>%.2f to %.2f %%<td>%d<td>%s"
        "</tr>\n",
        Escaped(c["class"].get<std::string>()), c["contacts"].get<int>(),
        c["right"].get<int>(), PercentOrDash(c["recall"]),
        100 * c["recall_interval"][0].get<double>(),
        100 * c["recall_interval"][1].get<double>(), c["answers"].get<int>(),
        PercentOrDash(c["precision"]));
  }
  return absl::StrCat(html, "</table>\n");
}

std::string MatrixTable(const Json& classes, const Json& confusion) {
  std::string html = "<table><tr><th>";
  for (const Json& name : classes) {
    absl::StrAppend(&html, "<th class=v>", Escaped(name.get<std::string>()));
  }
  html += "</tr>\n";
  for (size_t i = 0; i < classes.size(); ++i) {
    int contacts = 0;
    for (const Json& count : confusion[i]) contacts += count.get<int>();
    absl::StrAppend(&html, "<tr><th class=t>",
                    Escaped(classes[i].get<std::string>()));
    for (size_t k = 0; k < classes.size(); ++k) {
      const int count = confusion[i][k].get<int>();
      const double weight = count / std::max<double>(contacts, 1);
      // Right answers are blue, wrong ones red.
      absl::StrAppendFormat(&html, "<td style=\"background:rgba(%s,%.2f)\">%s",
                            i == k ? "60,120,216" : "216,60,60",
                            std::min(1.0, i == k ? weight : 2 * weight),
                            count == 0 ? "" : absl::StrCat(count));
    }
    html += "</tr>\n";
  }
  return absl::StrCat(html, "</table>\n");
}

std::string TimeTable(const Json& r) {
  std::string html =
      "<table><tr><th>seconds since onset<th>accuracy<th>95 % interval"
      "<th>calibration error</tr>\n";
  for (const auto& [seconds, accuracy] : r["accuracy_at"].items()) {
    const Json& interval = r["accuracy_interval_at"][seconds];
    absl::StrAppendFormat(
        &html, "<tr><td>%s<td>%s<td>%.2f to %.2f %%<td>%.3f</tr>\n", seconds,
        Percent(accuracy.get<double>()), 100 * interval[0].get<double>(),
        100 * interval[1].get<double>(), r["ece_at"][seconds].get<double>());
  }
  return absl::StrCat(html, "</table>\n");
}

std::string WorstTable(const Json& worst) {
  if (worst.empty()) return "<p>None.</p>\n";
  std::string html =
      "<table><tr><th class=t>trial<th class=t>label<th class=t>answer"
      "<th>probability</tr>\n";
  for (const Json& w : worst) {
    absl::StrAppendFormat(
        &html, "<tr><td class=t>%s<td class=t>%s<td class=t>%s<td>%.3f</tr>\n",
        Escaped(w["trial"].get<std::string>()),
        Escaped(w["label"].get<std::string>()),
        Escaped(w["answer"].get<std::string>()),
        w["probability"].get<double>());
  }
  return absl::StrCat(html, "</table>\n");
}

}  // namespace

Json WorstTrials(const Evaluation& result,
                 const std::vector<const LabelledContact*>& contacts) {
  constexpr size_t kMost = 20;
  std::vector<size_t> wrong;
  for (size_t i = 0; i < result.final.size(); ++i) {
    if (result.final[i].answer() != result.final[i].label) wrong.push_back(i);
  }
  const auto probability = [&](size_t i) {
    return result.final[i].probability[result.final[i].answer()];
  };
  std::stable_sort(wrong.begin(), wrong.end(), [&](size_t a, size_t b) {
    return probability(a) > probability(b);
  });
  wrong.resize(std::min(wrong.size(), kMost));
  Json worst = Json::array();
  for (const size_t i : wrong) {
    worst.push_back({{"trial", contacts[i]->id},
                     {"label", result.class_names[result.final[i].label]},
                     {"answer", result.class_names[result.final[i].answer()]},
                     {"probability", probability(i)}});
  }
  return worst;
}

std::string EvaluationPage(const std::string& title, const Json& evaluation,
                           const Json& worst) {
  const Json& r = evaluation;
  const int felt = r["felt"].get<int>();
  return absl::StrCat(
      "<!DOCTYPE html>\n<html lang=en><meta charset=utf-8>\n<title>",
      Escaped(title), "</title>\n<style>", kStyle, "</style>\n<h1>",
      Escaped(title), "</h1>\n<p>",
      Escaped(PercentOf(r["right"].get<int>(), felt)), " of ",
      Escaped(FeltContacts(felt, r["trials"].get<int>())),
      ".</p>\n<h2>Accuracy over time</h2>\n", TimeTable(r),
      "<h2>Classes</h2>\n", ClassTable(r["per_class"]),
      "<h2>Confusion matrix</h2>\n<p>Rows are labels, columns are "
      "answers.</p>\n",
      MatrixTable(r["classes"], r["confusion"]),
      "<h2>Wrong answers, the surest first</h2>\n", WorstTable(worst),
      "</html>\n");
}

}  // namespace tactus::client
