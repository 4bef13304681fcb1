#include "tools/trainctl/app.h"

#include <iostream>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/arguments.h"
#include "core/base/errors.h"
#include "core/base/version.h"
#include "tools/common/vetted_servers.h"
#include "tools/trainctl/command.h"
#include "tools/trainctl/exit_code.h"
#include "tools/trainctl/progress_display.h"
#include "tools/trainctl/unknown_word.h"
#include "tools/trainctl/verbs.h"

namespace tactus::internal::client {
namespace {

void Report(const absl::Status& status) {
  const std::string reason = ReasonOf(status);
  std::cerr << "trainctl: " << status.message();
  if (!reason.empty()) std::cerr << " [" << reason << "]";
  std::cerr << "\n";
}

}  // namespace

void AddCommands(CLI::App& app, const SelectCommand& select) {
  app.name("trainctl");
#define TACTUS_VERB(verb) Add##verb(app, select);
#define TACTUS_SERVER_VERB(verb) Add##verb(app, select);
#define TACTUS_STAND_IN_VERB(verb)
#include "tools/trainctl/verbs.inc"
#undef TACTUS_VERB
#undef TACTUS_SERVER_VERB
#undef TACTUS_STAND_IN_VERB
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
  app.add_flag_callback(
      "--quiet", [] { HideProgress(true); }, "Show no progress");
  app.require_subcommand(1);
  app.failure_message(CLI::FailureMessage::help);

  Command command;
  const SelectCommand select = [&](Command chosen) {
    command = std::move(chosen);
  };
  AddCommands(app, select);
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

}  // namespace tactus::internal::client
