#include "tools/trainctl/report/evaluate_report.h"

#include <algorithm>
#include <optional>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "core/base/text.h"
#include "core/eval/reliability.h"
#include "tools/trainctl/report/evaluate_figures.h"
#include "tools/trainctl/report/question_report.h"
#include "tools/trainctl/text.h"

namespace tactus::internal::client {
namespace {

Json ToJson(const EstimateErrors& errors) {
  return {{"contacts", errors.count},
          {"median_error", errors.median},
          {"rms_error", errors.root_mean_square},
          {"covered_by_deviation", errors.covered}};
}

// Null if nothing was estimated or the truth is unknown.
Json ToJson(const std::vector<std::optional<EstimateOutcome>>& outcomes) {
  std::vector<EstimateError> stiffness;
  std::vector<EstimateError> moved;
  for (const auto& o : outcomes) {
    if (!o) continue;
    stiffness.push_back({o->estimate.log10_stiffness - o->log10_stiffness,
                         o->estimate.log10_stiffness_deviation});
    moved.push_back(
        {o->estimate.moved_m - o->moved_m, o->estimate.moved_deviation_m});
  }
  if (stiffness.empty()) return nullptr;
  return {{"log10_stiffness", ToJson(SummariseErrors(stiffness))},
          {"moved_m", ToJson(SummariseErrors(moved))}};
}

// How many contacts were decided, how many of them rightly, and how soon.
Json ToJson(const std::vector<std::optional<DecisionOutcome>>& decisions) {
  std::vector<double> seconds;
  int right = 0;
  for (const auto& decision : decisions) {
    if (!decision) continue;
    seconds.push_back(decision->seconds);
    right += decision->right;
  }
  if (seconds.empty()) return nullptr;
  std::ranges::sort(seconds);
  const auto at = [&](size_t tenths) {
    return seconds[std::min(seconds.size() * tenths / 10, seconds.size() - 1)];
  };
  const int count = static_cast<int>(seconds.size());
  return {{"contacts", count},
          {"decided", count / static_cast<double>(decisions.size())},
          {"right", right},
          {"accuracy", right / static_cast<double>(count)},
          {"accuracy_interval", IntervalToJson(WilsonInterval(right, count))},
          {"tenth_seconds", at(1)},
          {"median_seconds", at(5)},
          {"nine_tenths_seconds", at(9)}};
}

Json ToJson(const std::vector<ReliabilityBin>& bins) {
  Json list = Json::array();
  for (const ReliabilityBin& bin : bins) {
    list.push_back({{"low", bin.low},
                    {"high", bin.high},
                    {"mean_probability", bin.mean_probability},
                    {"contacts", bin.count},
                    {"right", bin.right}});
  }
  return list;
}

// The outcomes at one of the anytime moments, judged by the class in the end
// or by the class so far.
std::vector<Outcome> Judged(std::vector<Outcome> outcomes,
                            const Evaluation& result, int time, bool so_far) {
  for (size_t i = 0; so_far && i < outcomes.size(); ++i) {
    outcomes[i].label = result.so_far[time][i];
  }
  return outcomes;
}

Json AnytimeToJson(const Evaluation& result, bool so_far) {
  Json json = {{"accuracy_at", Json::object()},
               {"accuracy_interval_at", Json::object()},
               {"ece_at", Json::object()},
               {"parts_accuracy_at", nullptr}};
  Json& parts = json["parts_accuracy_at"];
  for (int i = 0; i < kAnytimeCount; ++i) {
    const std::string key = absl::StrFormat("%g", kAnytimeSeconds[i]);
    const auto outcomes = Judged(result.anytime[i], result, i, so_far);
    json["accuracy_at"][key] = Accuracy(outcomes);
    json["accuracy_interval_at"][key] = IntervalToJson(WilsonInterval(
        CountRight(outcomes), static_cast<int>(outcomes.size())));
    json["ece_at"][key] = ExpectedCalibrationError(outcomes);
    if (result.anytime_hmm.empty()) continue;
    parts["hmm"][key] =
        Accuracy(Judged(result.anytime_hmm[i], result, i, so_far));
    parts["lstm"][key] =
        Accuracy(Judged(result.anytime_lstm[i], result, i, so_far));
  }
  return json;
}

// Answers of which the model is sure.
Json SelectiveToJson(const Evaluation& result) {
  constexpr double kLeast = 0.95;
  const SureAnswers sure = CountSure(result.final, result.unknown, kLeast);
  const auto right = TopProbabilities(result.final, true);
  const auto wrong = TopProbabilities(result.final, false);
  const bool both = !right.empty() && !wrong.empty();
  return {
      {"least_probability", kLeast},
      {"answered", sure.count},
      {"right", sure.right},
      {"coverage", result.final.empty()
                       ? 0.0
                       : static_cast<double>(sure.count) / result.final.size()},
      {"accuracy", sure.count == 0
                       ? Json(nullptr)
                       : Json(static_cast<double>(sure.right) / sure.count)},
      {"auroc", both ? Json(AreaUnderRoc(right, wrong)) : Json(nullptr)}};
}

std::string SelectiveLines(const Json& selective, int felt) {
  const int answered = selective["answered"].get<int>();
  std::string text = "No answer in the end has a probability of at least 0.95";
  if (answered > 0) {
    text = absl::StrFormat(
        "Of %s answers in the end, %s have a probability of at least 0.95, and "
        "%s of these are right: %s",
        WithCommas(felt), WithCommas(answered),
        WithCommas(selective["right"].get<int>()),
        PercentOf(selective["right"].get<int>(), answered));
  }
  if (const Json& area = selective["auroc"]; !area.is_null()) {
    absl::StrAppendFormat(
        &text, "\nA right answer is surer than a wrong one in %s of all pairs",
        Percent(area));
  }
  return text + "\n";
}

std::string ErrorLine(absl::string_view what, const Json& errors,
                      double scale) {
  return absl::StrFormat(
      "Error of %s: median %.3f, rms %.3f; %s of %s contacts within one "
      "estimated deviation\n",
      what, scale * errors["median_error"].get<double>(),
      scale * errors["rms_error"].get<double>(),
      Percent(errors["covered_by_deviation"]),
      WithCommas(errors["contacts"].get<int>()));
}

// `r` has accuracies of one truth.
std::string AnytimeLines(const Json& r) {
  std::string text;
  const Json& parts = r["parts_accuracy_at"];
  for (const auto& [seconds, accuracy] : r["accuracy_at"].items()) {
    const Json& interval = r["accuracy_interval_at"][seconds];
    absl::StrAppendFormat(
        &text,
        "  after %4s s  %s (%.2f to %.2f %%)  calibration "
        "error %.3f",
        seconds, Percent(accuracy), 100 * interval[0].get<double>(),
        100 * interval[1].get<double>(), r["ece_at"][seconds].get<double>());
    if (!parts.is_null()) {
      absl::StrAppendFormat(&text, "  (HMM alone %s, LSTM alone %s)",
                            Percent(parts["hmm"][seconds]),
                            Percent(parts["lstm"][seconds]));
    }
    text += "\n";
  }
  return text;
}

std::string DecisionLine(const Json& d, int felt) {
  return absl::StrFormat(
      "Decided %s of %s felt contacts (%s), %s of them rightly: %s; after "
      "%.2f s (median)\n",
      WithCommas(d["contacts"].get<int>()), WithCommas(felt),
      Percent(d["decided"]), WithCommas(d["right"].get<int>()),
      PercentOf(d["right"].get<int>(), d["contacts"].get<int>()),
      d["median_seconds"].get<double>());
}

// One object a class: how many of its contacts were right, and how many of the
// answers that named it.
Json PerClass(const std::vector<std::string>& names,
              const Confusion& confusion) {
  Json classes = Json::array();
  for (size_t k = 0; k < names.size(); ++k) {
    int contacts = 0;
    int answers = 0;
    for (size_t i = 0; i < names.size(); ++i) {
      contacts += confusion[k][i];
      answers += confusion[i][k];
    }
    const int right = confusion[k][k];
    const auto fraction = [right](int of) {
      return of == 0 ? Json(nullptr) : Json(static_cast<double>(right) / of);
    };
    classes.push_back(
        {{"class", names[k]},
         {"contacts", contacts},
         {"right", right},
         {"recall", fraction(contacts)},
         {"recall_interval", IntervalToJson(WilsonInterval(right, contacts))},
         {"answers", answers},
         {"precision", fraction(answers)}});
  }
  return classes;
}

// Pairs of label and wrong answer, the most frequent first.
Json TopConfusions(const std::vector<std::string>& names,
                   const Confusion& confusion) {
  constexpr size_t kMost = 10;
  struct Pair {
    size_t label;
    size_t answer;
    int count;
  };
  std::vector<Pair> pairs;
  for (size_t i = 0; i < names.size(); ++i) {
    for (size_t k = 0; k < names.size(); ++k) {
      if (i != k && confusion[i][k] > 0)
        pairs.push_back({i, k, confusion[i][k]});
    }
  }
  std::stable_sort(
      pairs.begin(), pairs.end(),
      [](const Pair& a, const Pair& b) { return a.count > b.count; });
  pairs.resize(std::min(pairs.size(), kMost));
  Json list = Json::array();
  for (const Pair& pair : pairs) {
    list.push_back({{"label", names[pair.label]},
                    {"answer", names[pair.answer]},
                    {"count", pair.count}});
  }
  return list;
}

std::string RecallLines(const Json& per_class) {
  size_t width = 0;
  std::vector<Json> classes(per_class.begin(), per_class.end());
  for (const Json& c : classes) {
    width = std::max(width, c["class"].get<std::string>().size());
  }
  std::stable_sort(
      classes.begin(), classes.end(), [](const Json& a, const Json& b) {
        // No recall is no worst recall.
        return a["recall"].is_number() &&
               (!b["recall"].is_number() ||
                a["recall"].get<double>() < b["recall"].get<double>());
      });
  std::string text = "Recall per class, the worst first:\n";
  for (const Json& c : classes) {
    absl::StrAppendFormat(
        &text, "  %-*s  %s of %d\n", static_cast<int>(width),
        c["class"].get<std::string>(),
        PercentOf(c["right"].get<int>(), c["contacts"].get<int>()),
        c["contacts"].get<int>());
  }
  return text;
}

// The names of the trials of a confusion in parentheses, if they are known.
std::string TrialsText(const Json& pair) {
  constexpr size_t kShown = 5;
  if (!pair.contains("trials")) return "";
  std::vector<std::string> names;
  for (const Json& name : pair["trials"]) {
    if (names.size() == kShown) break;
    names.push_back(Printable(name.get<std::string>()));
  }
  if (pair["count"].get<size_t>() > names.size()) names.push_back("...");
  return absl::StrCat(" (", absl::StrJoin(names, ", "), ")");
}

std::string ConfusionLines(const Json& confusions) {
  if (confusions.empty()) return "";
  constexpr size_t kShown = 5;
  std::string text = "Most frequent confusions:\n";
  for (size_t i = 0; i < std::min(confusions.size(), kShown); ++i) {
    const Json& pair = confusions[i];
    absl::StrAppendFormat(&text, "  %s taken for %s: %d%s\n",
                          pair["label"].get<std::string>(),
                          pair["answer"].get<std::string>(),
                          pair["count"].get<int>(), TrialsText(pair));
  }
  return text;
}

std::string ConfusionTable(const Json& classes, const Json& confusion) {
  constexpr size_t kMinWidth = 8;
  size_t width = kMinWidth;
  for (const auto& name : classes) {
    width = std::max(width, name.get<std::string>().size() + 1);
  }
  constexpr size_t kMaxWidth = 100;
  const size_t total = width * (classes.size() + 1);
  if (total > kMaxWidth) {
    return absl::StrFormat(
        "The confusion matrix is %d characters wide; --report=FOLDER writes "
        "it.\n",
        total);
  }
  const int columns = static_cast<int>(width);
  std::string text = "Rows are labels, columns are answers:\n";
  absl::StrAppendFormat(&text, "%*s", columns, "");
  for (const auto& name : classes) {
    absl::StrAppendFormat(&text, "%*s", columns, name.get<std::string>());
  }
  text += "\n";
  for (size_t i = 0; i < classes.size(); ++i) {
    absl::StrAppendFormat(&text, "%*s", columns, classes[i].get<std::string>());
    for (const auto& count : confusion[i]) {
      absl::StrAppendFormat(&text, "%*d", columns, count.get<int>());
    }
    text += "\n";
  }
  return text;
}

}  // namespace

Json ConfusionToJson(const std::vector<std::string>& class_names,
                     const Confusion& confusion) {
  return {{"classes", class_names},
          {"confusion", confusion},
          {"per_class", PerClass(class_names, confusion)},
          {"confusions", TopConfusions(class_names, confusion)}};
}

std::vector<WrongAnswer> WrongAnswers(
    const Evaluation& result,
    const std::vector<const LabelledContact*>& contacts) {
  std::vector<WrongAnswer> wrong;
  for (size_t i = 0; i < contacts.size(); ++i) {
    const Outcome& outcome = result.final[i];
    if (outcome.answer() == outcome.label) continue;
    wrong.push_back({ContactName(*contacts[i]),
                     result.class_names[outcome.label],
                     result.class_names[outcome.answer()]});
  }
  return wrong;
}

void NameConfusions(const std::vector<WrongAnswer>& wrong, Json& evaluation) {
  for (Json& pair : evaluation["confusions"]) {
    for (const WrongAnswer& w : wrong) {
      if (pair["label"] == w.label && pair["answer"] == w.answer) {
        pair["trials"].push_back(w.name);
      }
    }
  }
}

Json EvaluationToJson(const Evaluation& result, int trials) {
  const int felt = static_cast<int>(result.final.size());
  const int right = CountRight(result.final);
  const Confusion confusion =
      CountConfusion(result.final, static_cast<int>(result.class_names.size()));
  Json json = {
      {"algorithm", std::string(AlgorithmName(result.algorithm))},
      {"trials", trials},
      {"undetectable", trials - felt},
      {"felt", felt},
      {"right", right},
      {"accuracy", Accuracy(result.final)},
      {"accuracy_interval", IntervalToJson(WilsonInterval(right, felt))},
      {"log_loss", MeanLogLoss(result.final)},
      {"brier_score", BrierScore(result.final)},
      {"truth", result.truth == Truth::kSoFar ? "so-far" : "final"}};
  json.update(AnytimeToJson(result, /*so_far=*/false));
  json["so_far"] = result.so_far.empty()
                       ? Json(nullptr)
                       : AnytimeToJson(result, /*so_far=*/true);
  json.update(ConfusionToJson(result.class_names, confusion));
  json.update(Json{{"ece", ExpectedCalibrationError(result.final)},
                   {"reliability", ToJson(ReliabilityBins(result.final))},
                   {"selective", SelectiveToJson(result)},
                   {"decision", ToJson(result.decisions)},
                   {"questions", QuestionsToJson(result)},
                   {"estimate", ToJson(result.final_estimates)},
                   {"estimate_at_1.2", ToJson(result.anytime_estimates[3])}});
  return json;
}

std::string EvaluationText(const Json& r) {
  const int felt = r["felt"].get<int>();
  std::string text =
      absl::StrFormat("%s of %s\n", PercentOf(r["right"].get<int>(), felt),
                      FeltContacts(felt, r["trials"].get<int>()));
  const Json& so_far = r["so_far"];
  if (!so_far.is_null()) text += "By the class in the end:\n";
  text += AnytimeLines(r);
  if (!so_far.is_null()) {
    text += absl::StrCat("By the class so far:\n", AnytimeLines(so_far));
  }
  absl::StrAppendFormat(
      &text,
      "Answers are about the class %s\n"
      "Expected calibration error %.3f, log loss %.3f, Brier score %.3f\n",
      r["truth"] == "so-far" ? "so far" : "in the end", r["ece"].get<double>(),
      r["log_loss"].get<double>(), r["brier_score"].get<double>());
  text += SelectiveLines(r["selective"], felt);
  if (const Json& d = r["decision"]; !d.is_null()) {
    text += DecisionLine(d, felt);
  }
  if (const Json& e = r["estimate"]; !e.is_null()) {
    text += ErrorLine("log10 of stiffness (N/m)", e["log10_stiffness"], 1);
    text += ErrorLine("distance moved (mm)", e["moved_m"], 1000);
  }
  text += QuestionsText(r["questions"]);
  return absl::StrCat(text, RecallLines(r["per_class"]),
                      ConfusionLines(r["confusions"]),
                      ConfusionTable(r["classes"], r["confusion"]));
}

Json UnknownToJson(const std::vector<UnknownResult>& results) {
  Json categories = Json::array();
  for (const UnknownResult& r : results) {
    categories.push_back({{"category", r.left_out},
                          {"contacts", r.contacts},
                          {"detected", r.detected},
                          {"other_contacts", r.other_contacts},
                          {"false_alarms", r.false_alarms},
                          {"area_under_roc", r.area_under_roc},
                          {"area_interval", IntervalToJson(r.area_interval)}});
  }
  return categories;
}

std::string UnknownText(const std::vector<UnknownResult>& results) {
  std::string text;
  for (const UnknownResult& r : results) {
    absl::StrAppendFormat(
        &text,
        "without %s: unknown are %s of its %s contacts and %s of the %s "
        "others; area under the ROC curve %.3f (95 %% interval %.3f to %.3f)\n",
        r.left_out, Percent(r.detected), WithCommas(r.contacts),
        Percent(r.false_alarms), WithCommas(r.other_contacts), r.area_under_roc,
        r.area_interval.low, r.area_interval.high);
  }
  return text;
}

}  // namespace tactus::internal::client
