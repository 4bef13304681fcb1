// File: command.h
//
// What the sub-commands of trainctl share: how one is registered, how results
// are printed, and threads for the parts of core that can use them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "CLI/CLI.hpp"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/classify/compiled_model.h"
#include "core/train/labelled_contact.h"
#include "core/train/work.h"
#include "nlohmann/json.hpp"

namespace tactus::client {

// JSON objects keep the order in which keys were set.
using Json = nlohmann::ordered_json;

// A sub-command's work, run after parsing.
using Command = std::function<absl::Status()>;

// Each adds its sub-command to `app` and calls `select` with its work if it is
// the one given.
using SelectCommand = std::function<void(Command)>;
void AddSimulate(CLI::App& app, const SelectCommand& select);
void AddImport(CLI::App& app, const SelectCommand& select);
void AddFit(CLI::App& app, const SelectCommand& select);
void AddEvaluate(CLI::App& app, const SelectCommand& select);
void AddInspect(CLI::App& app, const SelectCommand& select);
void AddClassify(CLI::App& app, const SelectCommand& select);
void AddReproduce(CLI::App& app, const SelectCommand& select);

// The command line, as it goes into a bundle's provenance.
void SetCommandLine(int argc, char** argv);
const std::string& CommandLine();

// Spreads work over all processors.
void RunOnThreads(int count, const std::function<void(int)>& body);

// Seconds since the process started.
double SecondsSinceStart();

// Contacts of a trial file, and how many trials were undetectable.
struct LoadedContacts {
  std::vector<LabelledContact> contacts;
  int trials = 0;
  int undetectable = 0;

  std::vector<const LabelledContact*> Pointers() const;
};

// Reads `path`; `layout_path`, if not empty, names a SensorGeometry in JSON
// for skins that are no preset.
absl::StatusOr<LoadedContacts> LoadContacts(const std::string& path,
                                            const std::string& layout_path,
                                            const Progress& progress);

// Reads the bundle at `path`.
absl::StatusOr<Model> LoadModel(const std::string& path);

// Writes beside the target and renames.
absl::Status WriteFile(const std::string& path, const std::string& bytes);

}  // namespace tactus::client
