// File: command.h
//
// The common parts of trainctl's sub-commands: registration, and loading and
// writing of files.
//
//   TACTUS_ASSIGN_OR_RETURN(Model model, LoadModel(path));
//
// Thread-safe except for SetCommandLine(), which main() calls once.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "CLI/CLI.hpp"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/base/work.h"
#include "core/classify/compiled_model.h"
#include "core/contacts/labelled_contact.h"
#include "core/contacts/touch_contacts.h"
#include "core/import/odd_rates.h"
#include "tools/common/json.h"

namespace tactus::internal::client {

// The work of a sub-command. It runs after the command line is parsed.
using Command = std::function<absl::Status()>;

// A verb of trainctl is one file and one line of verbs.inc. The file defines
//   void AddX(CLI::App& app, const SelectCommand& select);
// which adds the verb to `app`. When the verb was typed, parsing calls `select`
// with its work.
using SelectCommand = std::function<void(Command)>;

// Adds a verb to `group`, which may be the program itself. --help ends with
// `example`: what follows "trainctl" and the group's name, as in "list arm".
CLI::App& AddVerb(CLI::App& group, const std::string& verb,
                  const std::string& description, const std::string& example);

// The group of verbs that begin with `name`, e.g. "models"; made by the first
// caller, so that several files can add verbs to it. `example` as for AddVerb.
CLI::App& CommandGroup(CLI::App& app, const std::string& name,
                       const std::string& description,
                       const std::string& example);

// The command line, on one line, for the provenance of a bundle.
void SetCommandLine(int argc, char** argv);
const std::string& CommandLine();

// Seconds since the process started.
double SecondsSinceStart();

// The contacts of a trial file. Undetectable trials have none.
struct LoadedContacts {
  std::vector<LabelledContact> contacts;
  int trials = 0;
  int never_felt = 0;
  // Some trial comes from taxels without poses.
  bool without_poses = false;
  // SHA-256 of the data as a whole, for Provenance::data_sha256.
  std::string data_sha256;
  // Counts of trials whose contacts were followed; `never_felt` then counts
  // touches that no contact was at.
  std::optional<TouchCounts> touches;

  std::vector<const LabelledContact*> Pointers() const;
};

// What --where takes.
inline constexpr char kWhereHelp[] =
    "Which trials: an expression over trial, source, label, condition, object, "
    "group, stiffness and velocity, like \"condition != 'day 2' and label in "
    "(a, b)\"; default: all";

// Trials of a file.
struct TrialSource {
  std::string path;
  // If not empty, a JSON file with the skin of trials that carry none.
  std::string layout = {};
  // If not empty, which of the trials (trial_filter.h).
  std::string where = {};
};

// Reads trials. `extract` holds the other options of ExtractContact(). With
// `max_contacts` above 0, trials that have touches are followed as a server
// with so many contacts does (ExtractContacts). INVALID_TRAINING_DATA if the
// trials have several skins or rates; INVALID_CONFIG if none is selected.
absl::StatusOr<LoadedContacts> LoadContacts(const TrialSource& source,
                                            const Progress& progress,
                                            ExtractOptions extract = {},
                                            int max_contacts = 0);

// Names contacts that have the frames of an earlier one, on standard error.
void RemarkCopies(const std::vector<const LabelledContact*>& contacts);

// Names trials of the file `path` whose times have another rate than they
// state, on standard error.
void RemarkRates(const OddRates& rates, const std::string& path);

// Makes the folder `path`, and those above it, if they are not there. IO if
// that fails.
absl::Status MakeFolder(const std::string& path);

// The model in the bundle at `path`.
absl::StatusOr<std::shared_ptr<const CompiledModel>> LoadModel(
    const std::string& path);

}  // namespace tactus::internal::client
