#include "tools/trainctl/report/touch_report.h"

#include <map>
#include <utility>

#include "absl/strings/str_format.h"
#include "tools/trainctl/report/evaluate_figures.h"
#include "tools/trainctl/text.h"

namespace tactus::internal::client {

Json TouchesToJson(const TouchCounts& counts, const Evaluation& result,
                   const std::vector<const LabelledContact*>& contacts) {
  std::map<std::pair<std::string, size_t>, bool> is_right;
  for (size_t i = 0; i < contacts.size(); ++i) {
    if (!contacts[i]->touch) continue;
    const bool answer_is_right =
        result.final[i].answer() == result.final[i].label;
    bool& right =
        is_right.try_emplace({contacts[i]->id, *contacts[i]->touch}, true)
            .first->second;
    right = right && answer_is_right;
  }
  int right = 0;
  for (const auto& [touch, answer_is_right] : is_right) {
    right += answer_is_right;
  }
  const auto felt = static_cast<int>(counts.found + counts.merged);
  return {{"touches", counts.touches},
          {"found", counts.found},
          {"broken", counts.broken},
          {"merged", counts.merged},
          {"switched", counts.switched},
          {"spurious", counts.spurious},
          {"right", right},
          {"accuracy",
           felt == 0 ? Json(nullptr) : Json(right / static_cast<double>(felt))},
          {"accuracy_interval", IntervalToJson(WilsonInterval(right, felt))}};
}

std::string TouchesText(const Json& touches) {
  const auto count = [&](const char* name) {
    return WithCommas(touches[name].get<int>());
  };
  return absl::StrFormat(
      "Touches: %s of %s found, %s broken, %s merged, %s switched; "
      "%s contacts at none\n"
      "Of the touches felt, %s were answered rightly by all their contacts\n",
      count("found"), count("touches"), count("broken"), count("merged"),
      count("switched"), count("spurious"),
      PercentOf(touches["right"].get<int>(),
                touches["found"].get<int>() + touches["merged"].get<int>()));
}

}  // namespace tactus::internal::client
