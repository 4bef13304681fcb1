// File: next_recordings.h
//
// What to record next: the groups and conditions in which answers are wrong,
// the pairs of classes that are confused, and how the accuracy grows with the
// number of recordings.
//
//   evaluation["groups"] = GroupsToJson(result, tested);
//   evaluation["learning_curve"] = CurveToJson(curve);
//   std::cout << NextRecordingsText(evaluation);
//
// Thread-safe: free functions without state.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/contacts/labelled_contact.h"
#include "core/eval/evaluation.h"
#include "core/eval/learning_curve.h"
#include "tools/trainctl/command.h"

namespace tactus::internal::client {

// The accuracy in each group (LabelledContact::material), the worst first;
// without groups in each condition. Empty if there is one of them at most.
Json GroupsToJson(const Evaluation& result,
                  const std::vector<const LabelledContact*>& contacts);

// Null without a curve.
Json CurveToJson(const std::optional<LearningCurve>& curve);

// Several lines, each ending with a newline; empty if all answers are right and
// there is no curve.
std::string NextRecordingsText(const Json& evaluation);

}  // namespace tactus::internal::client
