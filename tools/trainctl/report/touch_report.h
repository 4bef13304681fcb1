// File: touch_report.h
//
// How the contacts of trials with touches were followed, as JSON and as text.
//
//   evaluation["contacts"] = TouchesToJson(counts, result, contacts);
//   std::cout << TouchesText(evaluation["contacts"]);
//
// The JSON has `touches`, `found`, `broken`, `merged`, `switched` and
// `spurious` (TouchCounts); `right`, the touches whose contacts' last answers
// are all right; `accuracy`, these of all that were felt, which are those found
// or merged; and its 95 % interval. Thread-safe: free functions without state.
#pragma once

#include <string>
#include <vector>

#include "core/contacts/touch_contacts.h"
#include "core/eval/evaluation.h"
#include "tools/common/json.h"

namespace tactus::internal::client {

// `contacts` in the order of the outcomes of `result`.
Json TouchesToJson(const TouchCounts& counts, const Evaluation& result,
                   const std::vector<const LabelledContact*>& contacts);

// Two lines.
std::string TouchesText(const Json& touches);

}  // namespace tactus::internal::client
