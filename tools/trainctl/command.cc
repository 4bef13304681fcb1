#include "tools/trainctl/command.h"

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <numeric>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/run_on_threads.h"
#include "core/base/sha256.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/bundle/bundle.h"
#include "core/contacts/contact_set.h"
#include "core/contacts/copies.h"
#include "core/contacts/trained_on.h"
#include "core/contacts/world_contacts.h"
#include "core/data/frame_fingerprint.h"
#include "core/data/trial_fields.h"
#include "core/data/trial_file.h"
#include "core/data/trial_filter.h"
#include "core/data/trial_layout.h"
#include "core/files/file_bytes.h"

namespace tactus::internal::client {
namespace {

std::string& MutableCommandLine() {
  static std::string line;
  return line;
}

const auto kStart = std::chrono::steady_clock::now();

}  // namespace

void SetCommandLine(int argc, char** argv) {
  std::string& line = MutableCommandLine();
  // The program's name without its folder, as a user types it.
  line = std::filesystem::path(argv[0]).filename().string();
  for (int i = 1; i < argc; ++i) {
    absl::StrAppend(&line, " ", Printable(argv[i]));
  }
}

const std::string& CommandLine() { return MutableCommandLine(); }

double SecondsSinceStart() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() -
                                       kStart)
      .count();
}

CLI::App& AddVerb(CLI::App& group, const std::string& verb,
                  const std::string& description, const std::string& example) {
  CLI::App* command = group.add_subcommand(verb, description);
  // The program itself has no parent.
  const std::string path =
      group.get_parent() == nullptr ? "" : absl::StrCat(group.get_name(), " ");
  command->footer(absl::StrCat("Example:\n  trainctl ", path, example));
  return *command;
}

CLI::App& CommandGroup(CLI::App& app, const std::string& name,
                       const std::string& description,
                       const std::string& example) {
  const auto existing = app.get_subcommands(
      [&](const CLI::App* command) { return command->get_name() == name; });
  if (!existing.empty()) return *existing.front();
  CLI::App* group = app.add_subcommand(name, description);
  group->require_subcommand(1);
  group->footer(absl::StrCat("Example:\n  trainctl ", name, " ", example));
  return *group;
}

std::vector<const LabelledContact*> LoadedContacts::Pointers() const {
  std::vector<const LabelledContact*> pointers;
  pointers.reserve(contacts.size());
  for (const LabelledContact& contact : contacts) pointers.push_back(&contact);
  return pointers;
}

namespace {

absl::StatusOr<LoadedContacts> LoadWorld(const std::string& text,
                                         const Progress& progress) {
  TACTUS_ASSIGN_OR_RETURN(const WorldRecipe recipe, ParseWorldRecipe(text));
  TACTUS_ASSIGN_OR_RETURN(WorldContacts world,
                          MakeWorldContacts(recipe, RunOnThreads, progress));
  LoadedContacts loaded;
  loaded.trials = recipe.contacts;
  loaded.never_felt = std::accumulate(world.never_felt.begin(),
                                      world.never_felt.end(), uint64_t{0});
  loaded.without_poses = !recipe.poses;
  loaded.contacts = std::move(world.contacts);
  loaded.data_sha256 = Sha256Hex(text);
  return loaded;
}

// The contacts of a trial with touches, which are counted.
absl::StatusOr<std::vector<LabelledContact>> FollowTrial(
    const Trial& trial, const ExtractOptions& extract, int max_contacts,
    LoadedContacts& loaded) {
  TACTUS_ASSIGN_OR_RETURN(
      TouchContacts found,
      ExtractContacts(trial, {.layout = extract.layout,
                              .release_after_s = extract.release_after_s,
                              .max_contacts = max_contacts,
                              .whole_skin = extract.whole_skin}));
  const TouchCounts& counts = found.counts;
  if (!loaded.touches) loaded.touches.emplace();
  *loaded.touches += counts;
  loaded.never_felt +=
      static_cast<int>(counts.touches - counts.found - counts.merged);
  return std::move(found.contacts);
}

// The trials that `source` selects.
absl::StatusOr<TrialFilter> WantedTrials(const TrialSource& source) {
  if (IsWorldRecipe(source.path)) {
    return InvalidConfig("--where", "given with a recipe of contacts",
                         "absent: a recipe says which");
  }
  TACTUS_ASSIGN_OR_RETURN(TrialFilter filter, TrialFilter::Parse(source.where));
  TACTUS_RETURN_IF_ERROR(CheckTrialFields(filter.fields()));
  return filter;
}

}  // namespace

absl::StatusOr<LoadedContacts> LoadContacts(const TrialSource& source,
                                            const Progress& progress,
                                            ExtractOptions extract,
                                            int max_contacts) {
  std::optional<TrialFilter> wanted;
  if (!source.where.empty()) {
    TACTUS_ASSIGN_OR_RETURN(wanted, WantedTrials(source));
  }
  if (IsWorldRecipe(source.path)) return LoadWorld(source.path, progress);
  SkinLayout layout;
  if (!source.layout.empty()) {
    TACTUS_ASSIGN_OR_RETURN(layout, ReadLayoutFile(source.layout));
  }
  extract.layout = &layout;
  TACTUS_ASSIGN_OR_RETURN(auto reader, TrialFileReader::Open(source.path));
  LoadedContacts loaded;
  OddRates rates;
  const Progress reading = progress.Part("read trials", 1);
  for (size_t i = 0; i < reader.size(); ++i) {
    reading.Add(1 / static_cast<double>(reader.size()));
    TACTUS_ASSIGN_OR_RETURN(const Trial trial, reader.Read(i));
    if (wanted && !wanted->Matches([&](const std::string& field) {
          return TrialField(trial, field);
        })) {
      continue;
    }
    rates.Add(trial);
    std::vector<LabelledContact> contacts;
    if (max_contacts > 0 && !trial.touches.empty()) {
      TACTUS_ASSIGN_OR_RETURN(
          contacts, FollowTrial(trial, extract, max_contacts, loaded));
    } else {
      TACTUS_ASSIGN_OR_RETURN(auto contact, ExtractContact(trial, extract));
      loaded.never_felt += !contact;
      if (contact) contacts.push_back(*std::move(contact));
    }
    ++loaded.trials;
    loaded.without_poses |= !trial.taxels.empty() && trial.poses.empty();
    const std::string fingerprint =
        contacts.empty() ? "" : FrameFingerprint(trial);
    for (size_t n = 0; n < contacts.size(); ++n) {
      LabelledContact& contact = contacts[n];
      // Contacts of one trial are no copies of each other.
      contact.fingerprint =
          n == 0 ? fingerprint : absl::StrCat(fingerprint, "/", n);
      if (!loaded.contacts.empty()) {
        TACTUS_RETURN_IF_ERROR(CheckOneSkin(loaded.contacts.front(), contact));
      }
      loaded.contacts.push_back(std::move(contact));
    }
  }
  if (wanted && loaded.trials == 0) {
    return InvalidConfig("--where", source.where,
                         absl::StrCat("one that selects some of the ",
                                      reader.size(), " trials"));
  }
  loaded.data_sha256 = DataSha256(loaded.Pointers());
  RemarkRates(rates, source.path);
  return loaded;
}

void RemarkCopies(const std::vector<const LabelledContact*>& contacts) {
  const std::vector<Copy> copies = FindCopies(contacts);
  if (copies.empty()) return;
  std::cerr << absl::StrFormat(
      "trainctl: %d of the trials %s frames that an earlier one has\n",
      copies.size(), copies.size() == 1 ? "has" : "have");
  for (size_t i = 0; i < copies.size() && i < limits::kMaxNamedTrials; ++i) {
    std::cerr << "  " << CopyText(contacts, copies[i]) << "\n";
  }
}

void RemarkRates(const OddRates& rates, const std::string& path) {
  if (rates.empty()) return;
  std::cerr << "trainctl: " << path << ": " << rates.Remark() << "\n";
}

absl::Status MakeFolder(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) return IoError(path, error.message());
  return absl::OkStatus();
}

absl::StatusOr<std::shared_ptr<const CompiledModel>> LoadModel(
    const std::string& path) {
  const auto bytes = ReadFileBytes(path, limits::kMaxBundleBytes);
  if (!bytes.ok() && absl::StrContains(path, '@')) {
    // "arm@3" is a version of a server's model.
    return Advise(
        bytes.status(),
        absl::StrCat("--model takes a bundle file: to use a model of a server, "
                     "write it to one with trainctl models export ",
                     path, " --out=FILE"));
  }
  TACTUS_RETURN_IF_ERROR(bytes.status());
  auto model = DecodeBundle(*bytes);
  if (!model.ok()) return Annotate(model.status(), path);
  return model;
}

}  // namespace tactus::internal::client
