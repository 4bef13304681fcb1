// File: live_commands.h
//
// The commands of trainctl that read a skin.
//
//   AddSkinCalibrate(app, select);
//
// Not thread-safe.
#pragma once

#include "CLI/CLI.hpp"
#include "client/tools/trainctl/command.h"

namespace tactus::client {

// `skin calibrate`.
void AddSkinCalibrate(CLI::App& app, const SelectCommand& select);

// `record`.
void AddRecord(CLI::App& app, const SelectCommand& select);

}  // namespace tactus::client
