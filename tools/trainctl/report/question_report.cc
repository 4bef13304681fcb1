#include "tools/trainctl/report/question_report.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "tools/trainctl/text.h"

namespace tactus::internal::client {
namespace {

Json Milliseconds(const std::optional<double>& seconds) {
  return seconds ? Json(1000 * *seconds) : Json(nullptr);
}

Json ToJson(const DelaySummary& delay) {
  return {{"median", Milliseconds(delay.median)},
          {"p90", Milliseconds(delay.p90)},
          {"p99", Milliseconds(delay.p99)},
          {"contacts", delay.count},
          {"missed", delay.missed}};
}

Json FractionOf(int part, int whole) {
  return whole == 0 ? Json(nullptr) : Json(static_cast<double>(part) / whole);
}

Json DecisionsToJson(const Question& question, const QuestionSummary& summary,
                     int contacts) {
  Json json = {
      {"contacts", contacts},
      {"made", summary.made},
      {"right", summary.right},
      {"fraction", FractionOf(summary.right, summary.made)},
      {"interval", IntervalToJson(WilsonInterval(summary.right, summary.made))},
      {"constant",
       {{"value", question.values[summary.constant_value]},
        {"right", summary.constant_right},
        {"fraction", FractionOf(summary.constant_right, summary.made)}}}};
  json[question.kind == Question::kProperty ? "revised" : "changed"] =
      summary.changed;
  return json;
}

Json ToJson(const Question& question,
            const std::vector<QuestionOutcome>& outcomes) {
  const QuestionSummary summary = Summarise(question, outcomes);
  const int contacts = static_cast<int>(outcomes.size());
  std::vector<Outcome> final;
  for (const QuestionOutcome& outcome : outcomes) {
    final.push_back(outcome.final);
  }
  const bool property = question.kind == Question::kProperty;
  Json json = {
      {"kind", property ? "property" : "state"},
      {"values", question.values},
      {"contacts", contacts},
      {"right", CountRight(final)},
      {"accuracy", Accuracy(final)},
      {"accuracy_interval",
       IntervalToJson(WilsonInterval(CountRight(final), contacts))},
      {"ece", ExpectedCalibrationError(final)},
      {"delay_ms", ToJson(summary.delay)},
      {"delay_ms_late", property ? Json(nullptr) : ToJson(summary.delay_late)},
      {"settled_ms", ToJson(summary.settled)},
      {"false_alarms", FractionOf(summary.false_alarms, summary.watched)},
      {"false_alarm_counts",
       {{"contacts", summary.watched}, {"alarms", summary.false_alarms}}},
      {"early", property ? Json(nullptr) : Json(summary.early)},
      {"decisions", DecisionsToJson(question, summary, contacts)}};
  for (int time = 0; time < kAnytimeCount; ++time) {
    const std::string key = absl::StrFormat("%g", kAnytimeSeconds[time]);
    std::vector<Outcome> at;
    for (const QuestionOutcome& outcome : outcomes) {
      at.push_back(outcome.anytime[time]);
    }
    json["accuracy_at"][key] = Accuracy(at);
    json["ece_at"][key] = ExpectedCalibrationError(at);
  }
  return json;
}

std::string MsText(const Json& ms) {
  return ms.is_null() ? "never" : absl::StrFormat("%.0f", ms.get<double>());
}

std::string DelayText(const Json& delay) {
  if (delay["contacts"] == 0) return "no contact";
  return absl::StrFormat("%s / %s / %s ms, %s of %s contacts never",
                         MsText(delay["median"]), MsText(delay["p90"]),
                         MsText(delay["p99"]),
                         WithCommas(delay["missed"].get<int>()),
                         WithCommas(delay["contacts"].get<int>()));
}

std::string FractionText(const Json& part, const Json& whole) {
  return whole == 0
             ? "no contact"
             : absl::StrCat(WithCommas(part.get<int>()), " of ",
                            WithCommas(whole.get<int>()), ", ",
                            PercentOf(part.get<int>(), whole.get<int>()));
}

// What to call a changed decision.
const char* ChangeKey(const Json& question) {
  return question["kind"] == "property" ? "revised" : "changed";
}

// Rows of a name and a text, for the terminal and the page.
std::vector<std::vector<std::string>> Rows(const Json& q) {
  const bool property = q["kind"] == "property";
  const Json& d = q["decisions"];
  const Json& alarms = q["false_alarm_counts"];
  std::vector<std::vector<std::string>> rows = {
      {"right after the last frame", FractionText(q["right"], q["contacts"])},
      {"decisions made", FractionText(d["made"], d["contacts"])},
      {"decisions right", FractionText(d["right"], d["made"])},
      {absl::StrCat("always ", d["constant"]["value"].get<std::string>()),
       FractionText(d["constant"]["right"], d["made"])},
      {absl::StrCat("decisions ", ChangeKey(q)),
       WithCommas(d[ChangeKey(q)].get<int>())},
      {"delay, median / p90 / p99", DelayText(q["delay_ms"])}};
  if (!property) {
    rows.push_back({"  of late changes", DelayText(q["delay_ms_late"])});
    rows.push_back(
        {"  sure before the change", WithCommas(q["early"].get<int>())});
  }
  rows.push_back({"settled, median / p90 / p99", DelayText(q["settled_ms"])});
  rows.push_back(
      {"false alarms", FractionText(alarms["alarms"], alarms["contacts"])});
  return rows;
}

// Three times a line.
std::string TimesText(const Json& q) {
  constexpr size_t kPerLine = 3;
  std::vector<std::string> times;
  for (const auto& [seconds, accuracy] : q["accuracy_at"].items()) {
    times.push_back(absl::StrFormat("%s s %s (%.3f)", seconds,
                                    Percent(accuracy.get<double>()),
                                    q["ece_at"][seconds].get<double>()));
  }
  std::string text = "  accuracy (calibration error) after";
  for (size_t i = 0; i < times.size(); ++i) {
    absl::StrAppend(&text, i % kPerLine == 0 ? "\n    " : ", ", times[i]);
  }
  return text;
}

}  // namespace

Json QuestionsToJson(const Evaluation& result) {
  if (result.questions.empty()) return nullptr;
  Json json = Json::object();
  for (size_t q = 0; q < result.questions.size(); ++q) {
    json[result.questions[q].name] =
        ToJson(result.questions[q], result.question_outcomes[q]);
  }
  return json;
}

std::string QuestionsText(const Json& questions) {
  std::string text;
  if (questions.is_null()) return text;
  for (const auto& [name, q] : questions.items()) {
    absl::StrAppendFormat(&text, "Question %s (%s):\n", name,
                          q["kind"].get<std::string>());
    for (const auto& row : Rows(q)) {
      absl::StrAppendFormat(&text, "  %-28s %s\n", row[0], row[1]);
    }
    absl::StrAppend(&text, TimesText(q), "\n");
  }
  return text;
}

void AddQuestions(const Json& questions, Html& html) {
  if (questions.is_null()) return;
  for (const auto& [name, q] : questions.items()) {
    const bool property = q["kind"] == "property";
    html.Heading(absl::StrCat("Question: ", name));
    html.Paragraph(absl::StrCat(
        property ? "A property, the same all through a contact. Delays are "
                   "counted from the onset"
                 : "A state, which may change during a contact. Delays are "
                   "counted from the change",
        " until the right answer has a probability above 0.9."));
    html.Table({{"figure", false}, {"value", false}}, Rows(q));
    std::vector<std::vector<std::string>> rows;
    for (const auto& [seconds, accuracy] : q["accuracy_at"].items()) {
      rows.push_back(
          {seconds, Percent(accuracy.get<double>()),
           absl::StrFormat("%.3f", q["ece_at"][seconds].get<double>())});
    }
    html.Table({{"seconds since onset"}, {"accuracy"}, {"calibration error"}},
               rows);
  }
}

}  // namespace tactus::internal::client
