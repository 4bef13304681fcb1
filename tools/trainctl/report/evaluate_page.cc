#include "tools/trainctl/report/evaluate_page.h"

#include <algorithm>
#include <numeric>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "tools/trainctl/report/html.h"
#include "tools/trainctl/report/question_report.h"
#include "tools/trainctl/text.h"

namespace tactus::internal::client {
namespace {

std::string PercentOrDash(const Json& fraction) {
  return fraction.is_number() ? Percent(fraction.get<double>()) : "-";
}

std::string IntervalText(const Json& interval) {
  return absl::StrFormat("%.2f to %.2f %%", 100 * interval[0].get<double>(),
                         100 * interval[1].get<double>());
}

std::string Text(const Json& json) { return json.get<std::string>(); }

void AddHeadline(const EvaluationPageParts& parts, Html& html) {
  const Json& r = parts.evaluation;
  const int felt = r["felt"].get<int>();
  if (!parts.warning.empty()) html.Paragraph(parts.warning + ".");
  html.Add("<p class=\"big\">", Percent(r["accuracy"].get<double>()), "</p>\n");
  html.Paragraph(
      absl::StrCat(WithCommas(r["right"].get<int>()), " of ",
                   FeltContacts(felt, r["trials"].get<int>()),
                   ". 95 % interval: ", IntervalText(r["accuracy_interval"]),
                   ". After the last frame of each contact."));
  std::vector<std::vector<std::string>> rows;
  for (const auto& [name, value] : parts.facts) rows.push_back({name, value});
  if (!rows.empty()) html.Table({{"setting", false}, {"value", false}}, rows);
}

void AddBaselines(const Json& r, const Json& baselines, Html& html) {
  if (baselines.is_null()) return;
  const int contacts = baselines["contacts"].get<int>();
  std::vector<std::vector<std::string>> rows;
  const auto add = [&](const std::string& name, const std::string& what,
                       int right, int of) {
    rows.push_back({name, Percent(of > 0 ? static_cast<double>(right) / of : 0),
                    IntervalText(IntervalToJson(WilsonInterval(right, of))),
                    absl::StrCat(WithCommas(right), " of ", WithCommas(of)),
                    what});
  };
  add(absl::StrCat("this evaluation: ", Text(r["algorithm"])),
      "the frames of a contact, one after another", r["right"].get<int>(),
      r["felt"].get<int>());
  add("one nearest neighbour",
      "mean, deviation and largest value of each feature",
      baselines["nearest_right"].get<int>(), contacts);
  add("size only", "best thresholds on the largest touched area",
      baselines["size_right"].get<int>(), contacts);
  add("chance", "every answer is the most frequent class",
      baselines["frequent_right"].get<int>(), contacts);
  html.Heading("Beside the baselines");
  html.Table({{"classifier", false},
              {"accuracy"},
              {"95 % interval"},
              {"right"},
              {"what it looks at", false}},
             rows);
  html.Paragraph(Text(baselines["tested"]));
}

void AddMatrix(const Json& classes, const Json& confusion, Html& html) {
  html.Heading("Confusion matrix");
  html.Paragraph(
      "Rows are true classes, columns are answers. Percentages are of the "
      "row.");
  html.Add("<div class=\"wide\">\n<table>\n<thead><tr><td></td>");
  for (const Json& name : classes) {
    html.Add("<th scope=\"col\" class=\"v\"><bdi>", Escaped(Text(name)),
             "</bdi></th>");
  }
  html.Add("</tr></thead>\n<tbody>\n");
  for (size_t i = 0; i < classes.size(); ++i) {
    int contacts = 0;
    for (const Json& count : confusion[i]) contacts += count.get<int>();
    html.Add("<tr><th scope=\"row\" class=\"t own\"><bdi>",
             Escaped(Text(classes[i])), "</bdi></th>");
    for (size_t k = 0; k < classes.size(); ++k) {
      const int count = confusion[i][k].get<int>();
      const double part = count / std::max<double>(contacts, 1);
      if (count == 0) {
        html.Add("<td></td>");
        continue;
      }
      // Right answers are blue, wrong ones red; the digits stay readable.
      html.Add(absl::StrFormat(
          "<td style=\"background:rgba(%s,%.2f)\">%d<br><small>%.1f %%"
          "</small></td>",
          i == k ? "60,120,216" : "216,60,60",
          i == k ? 0.1 + 0.5 * part : std::min(0.6, 0.1 + part), count,
          100 * part));
    }
    html.Add("</tr>\n");
  }
  html.Add("</tbody>\n</table>\n</div>\n");
}

void AddClasses(const Json& per_class, Html& html) {
  std::vector<std::vector<std::string>> rows;
  for (const Json& c : per_class) {
    rows.push_back(
        {Text(c["class"]), WithCommas(c["contacts"].get<int>()),
         WithCommas(c["right"].get<int>()), PercentOrDash(c["recall"]),
         IntervalText(c["recall_interval"]),
         WithCommas(c["answers"].get<int>()), PercentOrDash(c["precision"])});
  }
  html.Heading("Classes");
  html.Table({{"class", false},
              {"contacts"},
              {"right"},
              {"recall"},
              {"95 % interval of the recall"},
              {"answers"},
              {"precision"}},
             rows);
}

void AddConfusions(const Json& confusions, Html& html) {
  html.Heading("Most frequent confusions");
  if (confusions.empty()) {
    html.Paragraph("None: every answer is right.");
    return;
  }
  std::vector<std::vector<std::string>> rows;
  for (const Json& pair : confusions) {
    std::vector<std::string> names;
    if (pair.contains("trials")) {
      for (const Json& name : pair["trials"]) names.push_back(Text(name));
    }
    rows.push_back({Text(pair["label"]), Text(pair["answer"]),
                    WithCommas(pair["count"].get<int>()),
                    absl::StrJoin(names, ", ")});
  }
  html.Table({{"label", false},
              {"answer", false},
              {"contacts"},
              {"recordings", false}},
             rows);
}

void AddTimes(const Json& r, const std::string& png, Html& html) {
  html.Heading("Anytime accuracy");
  if (!png.empty()) html.Picture("Accuracy over the time since onset", png);
  std::vector<HtmlColumn> columns = {
      {"seconds since onset"}, {"accuracy"}, {"95 % interval"}};
  const bool with_error = r.contains("ece_at");
  const bool with_parts =
      r.contains("parts_accuracy_at") && !r["parts_accuracy_at"].is_null();
  if (with_error) columns.push_back({"calibration error"});
  if (with_parts) {
    columns.push_back({"HMMs alone"});
    columns.push_back({"LSTMs alone"});
  }
  std::vector<std::vector<std::string>> rows;
  for (const auto& [seconds, accuracy] : r["accuracy_at"].items()) {
    rows.push_back({seconds, Percent(accuracy.get<double>()),
                    IntervalText(r["accuracy_interval_at"][seconds])});
    if (with_error) {
      rows.back().push_back(
          absl::StrFormat("%.3f", r["ece_at"][seconds].get<double>()));
    }
    if (!with_parts) continue;
    for (const char* part : {"hmm", "lstm"}) {
      rows.back().push_back(
          Percent(r["parts_accuracy_at"][part][seconds].get<double>()));
    }
  }
  html.Table(columns, rows);
  html.Paragraph("A contact that ended earlier has its last answer.");
}

void AddReliability(const Json& r, const std::string& png, Html& html) {
  if (!r.contains("reliability")) return;
  html.Heading("Reliability");
  html.Paragraph(absl::StrFormat(
      "Of the contacts whose answer has probability 0.8, eight of ten should "
      "be right. Expected calibration error: %.3f.",
      r["ece"].get<double>()));
  if (!png.empty()) {
    html.Picture("Right answers over the probability of the answer", png);
  }
  std::vector<std::vector<std::string>> rows;
  for (const Json& bin : r["reliability"]) {
    const int right = bin["right"].get<int>();
    const int count = bin["contacts"].get<int>();
    rows.push_back(
        {absl::StrFormat("%.3f to %.3f", bin["low"].get<double>(),
                         bin["high"].get<double>()),
         absl::StrFormat("%.3f", bin["mean_probability"].get<double>()),
         WithCommas(count), WithCommas(right),
         Percent(static_cast<double>(right) / count),
         IntervalText(IntervalToJson(WilsonInterval(right, count)))});
  }
  html.Table({{"probability of the answer"},
              {"mean"},
              {"contacts"},
              {"right"},
              {"accuracy"},
              {"95 % interval"}},
             rows);
}

void AddDecisions(const Json& r, const std::string& png, Html& html) {
  if (!r.contains("decision")) return;
  html.Heading("Time to decision");
  const Json& d = r["decision"];
  if (d.is_null()) {
    html.Paragraph("No contact was decided before its end.");
    return;
  }
  const int decided = d["contacts"].get<int>();
  html.Paragraph(absl::StrCat(
      "Decided: ", WithCommas(decided), " of ",
      WithCommas(r["felt"].get<int>()), " felt contacts (",
      Percent(d["decided"].get<double>()), "). ",
      WithCommas(d["right"].get<int>()), " of these decisions are right: ",
      PercentOf(d["right"].get<int>(), decided), "."));
  html.Table(
      {{"seconds since onset", false}, {"seconds"}},
      {{"a tenth of the decisions within",
        absl::StrFormat("%.2f", d["tenth_seconds"].get<double>())},
       {"half within",
        absl::StrFormat("%.2f", d["median_seconds"].get<double>())},
       {"nine tenths within",
        absl::StrFormat("%.2f", d["nine_tenths_seconds"].get<double>())}});
  if (!png.empty()) html.Picture("Decided contacts over time", png);
}

void AddWorst(const Json& worst, const std::vector<std::string>& pictures,
              Html& html) {
  html.Heading("The worst trials");
  html.Paragraph("The true class got the lowest probability here.");
  std::vector<std::vector<std::string>> rows;
  for (const Json& w : worst) {
    rows.push_back(
        {Text(w["name"]), Text(w["label"]), Text(w["answer"]),
         absl::StrFormat("%.3f", w["probability"].get<double>()),
         absl::StrFormat("%.2g", w["probability_of_label"].get<double>())});
  }
  html.Table({{"trial", false},
              {"label", false},
              {"answer", false},
              {"probability of the answer"},
              {"probability of the label"}},
             rows);
  for (size_t i = 0; i < pictures.size(); ++i) {
    const std::string caption = absl::StrFormat(
        "Trial %s, label %s, answer %s (probability %.3f); probability of the "
        "label: %.2g",
        Text(worst[i]["name"]), Text(worst[i]["label"]),
        Text(worst[i]["answer"]), worst[i]["probability"].get<double>(),
        worst[i]["probability_of_label"].get<double>());
    html.Paragraph(caption);
    html.Picture(caption, pictures[i]);
  }
}

}  // namespace

Json WorstTrials(const Evaluation& result,
                 const std::vector<const LabelledContact*>& contacts) {
  constexpr size_t kMost = 12;
  const auto of_label = [&](size_t i) {
    return result.final[i].probability[result.final[i].label];
  };
  std::vector<size_t> order(result.final.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return of_label(a) < of_label(b);
  });
  order.resize(std::min(order.size(), kMost));
  Json worst = Json::array();
  for (const size_t i : order) {
    const int answer = result.final[i].answer();
    worst.push_back({{"trial", contacts[i]->id},
                     {"name", ContactName(*contacts[i])},
                     {"label", result.class_names[result.final[i].label]},
                     {"answer", result.class_names[answer]},
                     {"probability", result.final[i].probability[answer]},
                     {"probability_of_label", of_label(i)}});
  }
  return worst;
}

Json BaselinesToJson(const Baselines& baselines, const std::string& tested) {
  return {{"contacts", baselines.contacts},
          {"nearest_right", baselines.nearest_right},
          {"size_right", baselines.size_right},
          {"frequent_right", baselines.frequent_right},
          {"tested", tested}};
}

std::string EvaluationPage(const EvaluationPageParts& parts) {
  const Json& r = parts.evaluation;
  Html html(parts.title);
  AddHeadline(parts, html);
  AddBaselines(r, parts.baselines, html);
  AddMatrix(r["classes"], r["confusion"], html);
  AddClasses(r["per_class"], html);
  AddConfusions(r["confusions"], html);
  AddTimes(r, parts.pictures.anytime, html);
  AddReliability(r, parts.pictures.reliability, html);
  AddDecisions(r, parts.pictures.decisions, html);
  if (r.contains("questions")) AddQuestions(r["questions"], html);
  if (!parts.worst.empty()) AddWorst(parts.worst, parts.pictures.worst, html);
  return html.Finish();
}

}  // namespace tactus::internal::client
