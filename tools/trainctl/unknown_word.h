// File: unknown_word.h
//
// Names the first word of a command line that no command or flag of the program
// has, and what was probably meant.
//
//   const std::string text = UnknownWord(app, {"evalute", "--data=x.h5"});
//   // "evalute" is not a command of trainctl; did you mean trainctl evaluate?
//
// Thread-safe: free functions without state.
#pragma once

#include <string>
#include <vector>

#include "CLI/CLI.hpp"

namespace tactus::internal::client {

// Empty if all commands and flags are known. `app` is the root of the commands.
std::string UnknownWord(const CLI::App& app,
                        const std::vector<std::string>& words);

// Every command of the program as users write it, e.g. "trainctl jobs list".
std::vector<std::string> CommandPaths(const CLI::App& app);

}  // namespace tactus::internal::client
