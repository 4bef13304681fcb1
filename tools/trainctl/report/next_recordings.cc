#include "tools/trainctl/report/next_recordings.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/wilson_interval.h"
#include "tools/trainctl/text.h"

namespace tactus::internal::client {
namespace {

struct Counts {
  int contacts = 0;
  int right = 0;
};

using Groups = std::map<std::string, Counts>;

Groups CountBy(const Evaluation& result,
               const std::vector<const LabelledContact*>& contacts,
               std::string LabelledContact::*name) {
  Groups groups;
  for (size_t i = 0; i < contacts.size(); ++i) {
    Counts& counts = groups[contacts[i]->*name];
    ++counts.contacts;
    counts.right += result.final[i].answer() == result.final[i].label;
  }
  return groups;
}

// The groups that are clearly worse than all contacts together.
std::string WorseGroups(const Json& groups, double accuracy) {
  constexpr size_t kShown = 5;
  std::string text;
  size_t shown = 0;
  for (const Json& group : groups["worst_first"]) {
    if (shown == kShown || !(group["accuracy_interval"][1] < accuracy)) break;
    ++shown;
    absl::StrAppendFormat(
        &text, "  %s %s: %d of %d right\n", groups["by"].get<std::string>(),
        group["name"].get<std::string>(), group["right"].get<int>(),
        group["contacts"].get<int>());
  }
  return text;
}

// The pair of classes that are taken for each other most often, with its share
// of the errors.
std::string WorstPair(const Json& evaluation, int errors) {
  std::map<std::pair<std::string, std::string>, int> pairs;
  for (const Json& confusion : evaluation["confusions"]) {
    auto pair = std::pair(confusion["label"].get<std::string>(),
                          confusion["answer"].get<std::string>());
    if (pair.second < pair.first) std::swap(pair.first, pair.second);
    pairs[pair] += confusion["count"].get<int>();
  }
  const auto worst = std::ranges::max_element(
      pairs, {}, [](const auto& pair) { return pair.second; });
  if (worst == pairs.end()) return "";
  return absl::StrFormat("  %d of the %d errors are between %s and %s\n",
                         worst->second, errors, worst->first.first,
                         worst->first.second);
}

std::string CurveText(const Json& curve) {
  std::string text = "Accuracy by recordings of a class:\n";
  for (const Json& point : curve["points"]) {
    absl::StrAppendFormat(
        &text, "  %4d  %s\n", point["per_class"].get<int>(),
        PercentOf(point["right"].get<int>(), curve["tested"].get<int>()));
  }
  if (curve["expected_with_twice"].is_null()) {
    return absl::StrCat(text,
                        "The accuracy does not grow with their number: record "
                        "other objects, sessions or forces, not more of the "
                        "same.\n");
  }
  absl::StrAppendFormat(&text,
                        "With twice as many, some %s are to be expected.\n",
                        Percent(curve["expected_with_twice"].get<double>()));
  return text;
}

}  // namespace

Json GroupsToJson(const Evaluation& result,
                  const std::vector<const LabelledContact*>& contacts) {
  std::string by = "group";
  Groups groups = CountBy(result, contacts, &LabelledContact::material);
  if (groups.size() < 2) {
    by = "condition";
    groups = CountBy(result, contacts, &LabelledContact::condition);
  }
  Json list = Json::array();
  if (groups.size() < 2) return {{"by", by}, {"worst_first", list}};
  std::vector<std::pair<std::string, Counts>> sorted(groups.begin(),
                                                     groups.end());
  const auto accuracy = [](const Counts& counts) {
    return static_cast<double>(counts.right) / counts.contacts;
  };
  std::ranges::stable_sort(
      sorted, {}, [&](const auto& group) { return accuracy(group.second); });
  for (const auto& [name, counts] : sorted) {
    list.push_back(
        {{"name", name},
         {"contacts", counts.contacts},
         {"right", counts.right},
         {"accuracy", accuracy(counts)},
         {"accuracy_interval",
          IntervalToJson(WilsonInterval(counts.right, counts.contacts))}});
  }
  return {{"by", by}, {"worst_first", list}};
}

Json CurveToJson(const std::optional<LearningCurve>& curve) {
  if (!curve) return nullptr;
  Json points = Json::array();
  for (const CurvePoint& point : curve->points) {
    points.push_back(
        {{"per_class", point.per_class},
         {"right", point.right},
         {"accuracy", static_cast<double>(point.right) / curve->tested},
         {"accuracy_interval",
          IntervalToJson(WilsonInterval(point.right, curve->tested))}});
  }
  const auto twice =
      ExpectedAccuracy(*curve, 2.0 * curve->points.back().per_class);
  return {{"tested", curve->tested},
          {"points", points},
          {"expected_with_twice", twice ? Json(*twice) : Json(nullptr)}};
}

std::string NextRecordingsText(const Json& evaluation) {
  const int errors =
      evaluation["felt"].get<int>() - evaluation["right"].get<int>();
  std::string text;
  if (errors > 0) {
    text =
        absl::StrCat(WorstPair(evaluation, errors),
                     WorseGroups(evaluation["groups"], evaluation["accuracy"]));
    if (!text.empty()) {
      text = absl::StrCat("Record more where it errs:\n", text);
    }
  }
  const Json& curve = evaluation["learning_curve"];
  return curve.is_null() ? text : absl::StrCat(text, CurveText(curve));
}

}  // namespace tactus::internal::client
