#include "core/train/lstm_work.h"

#include <set>
#include <string>

#include "core/inputs/inputs.h"

namespace tactus::internal {

double LstmWork(const std::vector<const LabelledContact*>& contacts,
                const FitOptions& given) {
  const FitOptions options = SuitedToAxes(given, contacts);
  const LstmFit& lstm = options.lstm;
  double steps = 0;
  std::set<std::string> classes;
  for (const LabelledContact* contact : contacts) {
    steps += static_cast<double>(CountSteps(*contact, lstm.steps));
    classes.insert(contact->label);
  }
  double inputs =
      static_cast<double>(CuesFor(lstm.cues, options.features).size() +
                          lstm.stretched_cues.size() * lstm.stretches);
  double weights = 0;
  for (const int cells : lstm.cells) {
    weights += 4.0 * cells * (inputs + cells);
    inputs = cells;
  }
  weights += inputs * static_cast<double>(classes.size());
  return 3 * weights * steps * (1 + options.variations.copies) *
         lstm.training.epochs * lstm.networks;
}

}  // namespace tactus::internal
