// trainctl import: writes recordings of other programs to a trial file.
#include "core/import/import.h"

#include <iostream>
#include <map>
#include <optional>
#include <set>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/data/frame_fingerprint.h"
#include "core/data/trial_file.h"
#include "core/data/trial_id.h"
#include "core/data/trial_loads.h"
#include "core/skin/layout_json.h"
#include "tools/trainctl/command.h"
#include "tools/trainctl/data/bag_list.h"
#include "tools/trainctl/data/resting_load.h"
#include "tools/trainctl/progress_display.h"
#include "tools/trainctl/text.h"

namespace tactus::internal::client {
namespace {

struct ImportFlags {
  std::string path;
  std::string out;
  ImportOptions options;
  bool list = false;
  bool json = false;
};

// True if some taxel reaches the onset threshold.
bool IsFelt(const Trial& trial, const SkinLayout& skin) {
  TrialLoads loads(trial.taxels, skin);
  for (size_t t = 0; t < trial.taxels.frames(); ++t) {
    const std::span<const float> taxels = loads.Frame(t);
    for (size_t i = 0; i < taxels.size(); ++i) {
      const bool valid = skin.mask.empty() || skin.mask[i] != 0;
      if (valid && taxels[i] >= skin.onset_threshold) return true;
    }
  }
  return false;
}

// Notices trials with the frames of an earlier one.
class Duplicates {
 public:
  void Add(const Trial& trial) {
    const std::string fingerprint = FrameFingerprint(trial);
    if (!IdentifiesRecording(fingerprint)) return;
    const Named named = {TrialName(trial.id, trial.source), trial.label};
    const auto [first, added] = first_.emplace(fingerprint, named);
    if (added) return;
    ++count_;
    if (lines_.size() == limits::kMaxNamedTrials) return;
    lines_.push_back(absl::StrFormat(
        "  %s (%s) has the frames of %s (%s)\n", Printable(named.name),
        Printable(named.label), Printable(first->second.name),
        Printable(first->second.label)));
  }

  int count() const { return count_; }
  // Several lines; empty if there are none.
  std::string Text() const {
    if (count_ == 0) return "";
    return absl::StrCat("trainctl: ", count_,
                        " of the trials have frames that an earlier one has; "
                        "a dataset takes each recording once\n",
                        absl::StrJoin(lines_, ""));
  }

 private:
  struct Named {
    std::string name;
    std::string label;
  };
  std::map<std::string, Named> first_;
  std::vector<std::string> lines_;
  int count_ = 0;
};

absl::Status RunImport(const ImportFlags& flags) {
  if (flags.list) return ListBag(flags.path, flags.json);
  TACTUS_ASSIGN_OR_RETURN(
      auto writer, TrialFileWriter::Create(flags.out, {.overwrite = true}));
  ProgressDisplay display;
  std::map<std::string, int> counts;
  std::set<std::string> conditions;
  std::set<std::string> groups;
  Duplicates duplicates;
  RestingLoad resting;
  std::optional<SkinLayout> skin;
  int64_t imported = 0;
  size_t frames = 0;
  size_t with_poses = 0;
  int never_felt = 0;
  ImportOptions options = flags.options;
  options.remark = [&](const std::string& remark) {
    display.Clear();
    std::cerr << "trainctl: " << remark << "\n";
  };
  TACTUS_ASSIGN_OR_RETURN(const size_t trials,
                          ImportTrials(
                              flags.path,
                              [&](Trial trial) {
                                ++counts[trial.label];
                                duplicates.Add(trial);
                                resting.Add(trial);
                                if (!trial.condition.empty())
                                  conditions.insert(trial.condition);
                                if (!trial.material.empty())
                                  groups.insert(trial.material);
                                with_poses += !trial.poses.empty();
                                if (!skin) skin = trial.skin;
                                never_felt +=
                                    trial.skin && !IsFelt(trial, *trial.skin);
                                frames += trial.time.size();
                                display.Count("import trials", ++imported);
                                return writer.Append(trial);
                              },
                              options));
  TACTUS_RETURN_IF_ERROR(writer.Close());
  display.Clear();
  std::cerr << duplicates.Text() << resting.Text();
  if (flags.json) {
    std::cout << JsonText(Json{{"trials", trials},
                               {"frames", frames},
                               {"counts", counts},
                               {"conditions", conditions.size()},
                               {"groups", groups.size()},
                               {"with_poses", with_poses},
                               {"never_felt", never_felt},
                               {"duplicates", duplicates.count()},
                               {"skin", skin ? Json::parse(LayoutToJson(*skin))
                                             : Json(nullptr)},
                               {"seconds", SecondsSinceStart()}})
              << "\n";
    return absl::OkStatus();
  }
  std::cout << absl::StrFormat("%s: %d trials, %d frames\n", flags.out, trials,
                               frames);
  if (skin) std::cout << SkinText(*skin);
  std::cout << absl::StrFormat(
      "conditions: %d, groups: %d, trials with poses: %d, never felt: %d\n",
      conditions.size(), groups.size(), with_poses, never_felt);
  for (const auto& [label, count] : counts) {
    std::cout << absl::StrFormat("%6d  %s\n", count, label);
  }
  return absl::OkStatus();
}

}  // namespace

void AddImport(CLI::App& app, const SelectCommand& select) {
  auto flags = std::make_shared<ImportFlags>();
  CLI::App* command = &AddVerb(
      app, "import",
      "Read recordings: a folder with a skin.json (docs/your-own-skin.md), CSV "
      "files of signals, a trial file, a recording of tactus-stream, or a bag "
      "of ROS 2 (docs/your-own-skin.md, \"Bags of ROS 2\")",
      "import my_recordings --out=mine.h5");
  command->add_option("source", flags->path, "Folder or file")->required();
  command->add_option("--skin", flags->options.skin,
                      "skin.json of a folder that has none, or a new skin for "
                      "a trial file or a recording");
  command->add_option("--mapping", flags->options.mapping,
                      "skin.json of a bag of ROS 2, or of a folder of bags: "
                      "which topic has the taxels, and what they are");
  command->add_flag("--list", flags->list,
                    "Print what a bag of ROS 2 holds and a mapping to start "
                    "from; imports nothing");
  command->add_option("--table", flags->options.table,
                      "Table of the folder's trials, instead of the one that "
                      "skin.json names; or of a recording's contacts");
  command->add_option("--file-names", flags->options.file_names,
                      "Take labels, conditions and groups from the names of "
                      "the folder's files: {label}_{group}.csv, or a regular "
                      "expression with named groups");
  command->add_option("--label", flags->options.label,
                      "Label of trials that have none");
  command->add_option("--condition", flags->options.condition,
                      "Condition of trials that have none");
  command->add_option("--out", flags->out, "Trial file to write");
  command->add_flag("--json", flags->json, "Print one JSON object on stdout");
  command->callback([=] {
    if (!flags->list && flags->out.empty()) throw CLI::RequiredError("--out");
    select([=] { return RunImport(*flags); });
  });
}

}  // namespace tactus::internal::client
