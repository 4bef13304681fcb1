// File: completion.h
//
// Scripts that complete trainctl's command lines in a shell, made from the
// commands and options that the program has.
//
//   std::cout << CompletionScript(app, Shell::kBash);
//
// Thread-safe: free functions without state.
#pragma once

#include <string>

#include "CLI/CLI.hpp"

namespace tactus::internal::client {

enum class Shell { kBash, kZsh };

// `app` is the root of the commands.
std::string CompletionScript(const CLI::App& app, Shell shell);

}  // namespace tactus::internal::client
