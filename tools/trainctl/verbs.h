// File: verbs.h
//
// The verbs of trainctl, one function for each line of verbs.inc.
//
//   AddInspect(app, [&](Command chosen) { command = std::move(chosen); });
//
// Not thread-safe.
#pragma once

#include "CLI/CLI.hpp"
#include "tools/trainctl/command.h"

namespace tactus::internal::client {

#define TACTUS_VERB(verb) \
  void Add##verb(CLI::App& app, const SelectCommand& select);
#define TACTUS_SERVER_VERB TACTUS_VERB
#define TACTUS_STAND_IN_VERB TACTUS_VERB
#include "tools/trainctl/verbs.inc"
#undef TACTUS_VERB
#undef TACTUS_SERVER_VERB
#undef TACTUS_STAND_IN_VERB

}  // namespace tactus::internal::client
