// File: live_commands.h
//
// The commands of trainctl that read a skin.
//
//   AddSkinCalibrate(app, select);
//
// Not thread-safe.
#pragma once

#include "CLI/CLI.hpp"
#include "tools/common/skin_source.h"
#include "tools/trainctl/command.h"

namespace tactus::client {

// `skin calibrate`.
void AddSkinCalibrate(CLI::App& app, const SelectCommand& select);

// `skin find`.
void AddSkinFind(CLI::App& app, const SelectCommand& select);

// FindPort, which prints on standard error what it found.
absl::Status FindPortAloud(SkinSourceOptions& options);

// `record`.
void AddRecord(CLI::App& app, const SelectCommand& select);

}  // namespace tactus::client
