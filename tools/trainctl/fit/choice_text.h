// File: choice_text.h
//
// Shows how a preset was chosen (core/eval/chosen_options.h).
//
//   std::cout << ChoiceText(chosen.choice);
//
// Thread-safe: free functions without state.
#pragma once

#include <optional>
#include <string>

#include "core/eval/auto_preset.h"
#include "tools/trainctl/command.h"

namespace tactus::internal::client {

// "HMMs", "ridge", "trees" or "1-NN".
std::string LearnerText(Learner learner);

// A candidate and how many of the contacts it answered rightly, without the end
// of the line.
std::string CandidateLine(const ChoiceCandidate& candidate, int contacts);

// Several lines; empty if nothing was chosen.
std::string ChoiceText(const std::optional<PresetChoice>& chosen);
// Null if nothing was chosen.
Json ChoiceToJson(const std::optional<PresetChoice>& chosen);
// Name, accuracy, its standard error, and whether it was chosen, of each
// candidate that was compared; an empty list if nothing was chosen.
Json CandidatesToJson(const std::optional<PresetChoice>& chosen);

}  // namespace tactus::internal::client
