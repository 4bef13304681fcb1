// What the examples of public headers need around them. They only have to
// compile. The build takes each .inc from the comment of the header it names.
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/base/status_macros.h"
#include "core/classify/model.h"
#include "core/questions/consensus.h"
#include "core/questions/decision_tracker.h"
#include "core/questions/question.h"
#include "core/questions/question_table.h"

namespace tactus::internal::examples {

void Report(int value);

static void ConsensusExample() {
#include "core/questions/consensus.h.inc"
}

static void QuestionExample() {
#include "core/questions/question.h.inc"
}

static absl::Status QuestionTableExample(const std::string& text,
                                         Model& model) {
#include "core/questions/question_table.h.inc"
  return absl::OkStatus();
}

static void DecisionTrackerExample(uint64_t frames, double unknown,
                                   std::span<const double> value_probability) {
#include "core/questions/decision_tracker.h.inc"
}

}  // namespace tactus::internal::examples
