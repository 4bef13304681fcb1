#include "tools/trainctl/app.h"

#include <iostream>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "core/base/arguments.h"
#include "core/base/errors.h"
#include "core/base/version.h"
#include "tools/common/vetted_servers.h"
#include "tools/trainctl/command.h"
#include "tools/trainctl/exit_code.h"
#include "tools/trainctl/live_commands.h"
#include "tools/trainctl/remote/flags.h"
#include "tools/trainctl/unknown_word.h"

namespace tactus::client {
namespace {

// What --help of groups, and of the commands without a server, ends with.
constexpr std::pair<const char*, const char*> kExamples[] = {
    {"simulate", "--protocol=paper --skin=good --out=sim.h5"},
    {"import", "my_recordings --out=mine.h5"},
    {"fit", "--data=mine.h5 --preset=tuned --out=mine.tactus"},
    {"inspect", "mine.h5"},
    {"classify", "--data=mine.h5 --model=mine.tactus"},
    {"show", "mine.h5 --trial=000000 --out=contact.png"},
    {"reproduce", "--figures=paper-tables"},
    {"skin", "estimate mine.h5"},
    {"record",
     "--driver=serial --port=/dev/ttyUSB0 --labels=HU,HM,SU,SM --out=mine.h5"},
    {"datasets", "upload arm --data=mine.h5"},
    {"jobs", "watch 7"},
    {"models", "promote arm@3"},
    {"bundle", "export mine.tactus --format=onnx --out=exported"},
    {"bundle export", "mine.tactus --format=onnx --out=exported"},
    {"bundle import", "net.onnx --into=mine.tactus --out=new.tactus"},
    {"trials", "export mine.h5 --format=npz --out=exported"},
    {"trials export", "mine.h5 --format=npz --out=exported"},
    {"tokens", "list --file=/etc/tactus/tokens"},
    {"tokens create",
     "--name=arm-7 --role=robot --file=/etc/tactus/tokens > arm-7.token"},
    {"tokens list", "--file=/etc/tactus/tokens"},
    {"tokens remove", "--name=arm-7 --file=/etc/tactus/tokens"},
};

// The command at the end of a path, e.g. "tokens create".
CLI::App* Find(CLI::App& app, absl::string_view path) {
  CLI::App* command = &app;
  for (const absl::string_view name : absl::StrSplit(path, ' ')) {
    command = command->get_subcommand(std::string(name));
  }
  return command;
}

void Report(const absl::Status& status) {
  const std::string reason = ReasonOf(status);
  std::cerr << "trainctl: " << status.message();
  if (!reason.empty()) std::cerr << " [" << reason << "]";
  std::cerr << "\n";
}

}  // namespace

void AddCommands(CLI::App& app, const SelectCommand& select) {
  app.name("trainctl");
  for (auto add :
       {AddSimulate,      AddImport,       AddFit,         AddRemoteEvaluate,
        AddInspect,       AddClassify,     AddShow,        AddSkin,
        AddSkinCalibrate, AddSkinFind,     AddRecord,      AddReproduce,
        AddDatasets,      AddDatasetEdits, AddTrain,       AddJobs,
        AddModels,        AddExportModel,  AddImportModel, AddExportTrials,
        AddServer,        AddDoctor,       AddTokens,      AddCompletion}) {
    add(app, select);
  }
}

int RunTrainctl(int argc, char** argv) {
  VetServers("trainctl");
  if (const absl::Status status = CheckArguments(argc, argv); !status.ok()) {
    Report(status);
    return kExitUsage;
  }
  SetCommandLine(argc, argv);
  CLI::App app(
      "Simulate, import and inspect labelled contacts; train, evaluate, serve "
      "and use models of them, on this machine or on a server.");
  app.set_version_flag("--version", std::string("trainctl ") + kVersion);
  app.require_subcommand(1);
  app.failure_message(CLI::FailureMessage::help);

  Command command;
  const SelectCommand select = [&](Command chosen) {
    command = std::move(chosen);
  };
  AddCommands(app, select);
  for (const auto& [name, arguments] : kExamples) {
    Find(app, name)->footer(
        absl::StrCat("Example:\n  trainctl ", name, " ", arguments));
  }
  app.footer(
      "Examples:\n"
      "  trainctl import my_recordings --out=mine.h5\n"
      "  trainctl fit --help");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const std::string unknown = UnknownWord(app, {argv + 1, argv + argc});
    if (error.get_exit_code() != 0 && !unknown.empty()) {
      std::cerr << "trainctl: " << unknown << "\n";
      return kExitUsage;
    }
    // Zero for --help and --version.
    return app.exit(error) == 0 ? kExitOk : kExitUsage;
  }

  const absl::Status status = command();
  if (!status.ok()) Report(status);
  return ExitCodeOf(status);
}

}  // namespace tactus::client
