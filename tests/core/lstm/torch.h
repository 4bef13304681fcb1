// File: torch.h
//
// Computes answers with PyTorch, through the scripts beside this file.
//
//   const auto answers = AskTorch("torch_reference.py", cases);
//   if (!answers) return;  // PyTorch is absent, and the test prints that
#pragma once

#include <optional>
#include <string>

#include "core/lstm/network.h"
#include "nlohmann/json.hpp"

namespace tactus::internal {

nlohmann::json ToJson(const LstmNetwork& network);

// What `script` makes of `cases`; nothing where torch cannot be imported. Any
// other failure fails the test.
std::optional<nlohmann::json> AskTorch(const std::string& script,
                                       const nlohmann::json& cases);

// The folder of the sources.
std::string SourceDir();

}  // namespace tactus::internal
