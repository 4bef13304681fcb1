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

// Several lines; empty if nothing was chosen.
std::string ChoiceText(const std::optional<PresetChoice>& chosen);
// Null if nothing was chosen.
Json ChoiceToJson(const std::optional<PresetChoice>& chosen);

}  // namespace tactus::internal::client
