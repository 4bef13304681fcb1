// trainctl import: writes recordings of other programs to a trial file.
#include "core/data/import.h"

#include <iostream>
#include <map>

#include "absl/strings/str_format.h"
#include "client/tools/trainctl/command.h"
#include "client/tools/trainctl/progress_display.h"
#include "core/base/status_macros.h"
#include "core/data/trial_file.h"

namespace tactus::client {
namespace {

struct Flags {
  std::string path;
  std::string out;
  bool json = false;
};

absl::Status Run(const Flags& flags) {
  TACTUS_ASSIGN_OR_RETURN(
      auto writer, TrialFileWriter::Create(flags.out, {.overwrite = true}));
  ProgressDisplay display;
  std::map<std::string, int> counts;
  int64_t imported = 0;
  size_t frames = 0;
  TACTUS_ASSIGN_OR_RETURN(const size_t trials,
                          ImportTrials(flags.path, [&](Trial trial) {
                            ++counts[trial.label];
                            frames += trial.time.size();
                            display.Count("import trials", ++imported);
                            return writer.Append(trial);
                          }));
  TACTUS_RETURN_IF_ERROR(writer.Close());
  display.Clear();
  if (flags.json) {
    std::cout << JsonText(Json{{"trials", trials},
                               {"frames", frames},
                               {"counts", counts},
                               {"seconds", SecondsSinceStart()}})
              << "\n";
    return absl::OkStatus();
  }
  std::cout << absl::StrFormat("%s: %d trials, %d frames\n", flags.out, trials,
                               frames);
  for (const auto& [label, count] : counts) {
    std::cout << absl::StrFormat("%6d  %s\n", count, label);
  }
  return absl::OkStatus();
}

}  // namespace

void AddImport(CLI::App& app, const SelectCommand& select) {
  auto flags = std::make_shared<Flags>();
  CLI::App* command = app.add_subcommand(
      "import", "Read recordings (folder of .npy or .csv, or one .csv)");
  command->add_option("source", flags->path, "Folder or CSV file")->required();
  command->add_option("--out", flags->out, "Trial file to write")->required();
  command->add_flag("--json", flags->json, "Print one JSON object on stdout");
  command->callback([=] { select([=] { return Run(*flags); }); });
}

}  // namespace tactus::client
