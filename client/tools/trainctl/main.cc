// trainctl: simulate, import, fit, evaluate, inspect, classify and show trials,
// and exchange trials and models with other programs.
#include <cstdlib>
#include <iostream>

#include "client/tools/trainctl/command.h"
#include "core/base/arguments.h"
#include "core/base/errors.h"

int main(int argc, char** argv) {
  using namespace tactus::client;
  if (const absl::Status status = tactus::CheckArguments(argc, argv);
      !status.ok()) {
    std::cerr << "trainctl: " << status.message() << "\n";
    return EXIT_FAILURE;
  }
  SetCommandLine(argc, argv);
  CLI::App app(
      "Simulate, import, fit, evaluate, inspect, classify and show trials.");
  app.name("trainctl");
  app.require_subcommand(1);
  app.failure_message(CLI::FailureMessage::help);

  Command command;
  const SelectCommand select = [&](Command chosen) {
    command = std::move(chosen);
  };
  for (auto add : {AddSimulate, AddImport, AddFit, AddEvaluate, AddInspect,
                   AddClassify, AddShow, AddReproduce, AddExportModel,
                   AddImportModel, AddExportTrials}) {
    add(app, select);
  }
  CLI11_PARSE(app, argc, argv);

  const absl::Status status = command();
  if (!status.ok()) {
    const std::string reason = tactus::ReasonOf(status);
    std::cerr << "trainctl: " << status.message();
    if (!reason.empty()) std::cerr << " [" << reason << "]";
    std::cerr << "\n";
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
