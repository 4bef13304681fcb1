// trainctl inspect: prints the contents of a trial file or a bundle.
#include <fstream>
#include <iostream>
#include <map>

#include "absl/strings/str_format.h"
#include "client/tools/trainctl/command.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/bundle/bundle.h"
#include "core/classify/input_spec.h"
#include "core/data/file_bytes.h"
#include "core/data/trial_file.h"

namespace tactus::client {
namespace {

struct Flags {
  std::string path;
  bool json = false;
};

bool IsBundle(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  char magic[8] = {};
  file.read(magic, sizeof magic);
  return absl::string_view(magic, sizeof magic) == "TACTUSMB";
}

absl::StatusOr<Json> InspectBundle(const std::string& path) {
  TACTUS_ASSIGN_OR_RETURN(const std::string bytes,
                          ReadFileBytes(path, limits::kMaxBundleBytes));
  TACTUS_ASSIGN_OR_RETURN(const auto compiled, LoadModel(path));
  TACTUS_RETURN_IF_ERROR(RunWarmUp(*compiled));
  const Model& model = compiled->model();
  Json hmms = Json::object();
  for (int k = 0; k < model.classes(); ++k) {
    hmms[model.class_names[k]] = {
        {"components", model.hmms[k].components.size()},
        {"states", model.hmms[k].components.front().states}};
  }
  return Json{{"kind", "bundle"},
              {"format_version", kBundleFormatVersion},
              {"bytes", bytes.size()},
              {"sha256", BundleSha256(bytes)},
              {"classes", model.class_names},
              {"features", FeaturesToString(FeaturesUsed(model.inputs))},
              {"sample_rate_hz", model.inputs.sample_rate_hz},
              {"hmms", hmms},
              {"lstms", model.lstms.size()},
              {"lstm_parameters", model.lstms.empty()
                                      ? Json(nullptr)
                                      : Json(model.lstms[0].parameter_count())},
              {"layout", model.layout.name},
              {"decision",
               {{"threshold", model.calibration.decision_threshold},
                {"frames", model.calibration.decision_frames}}},
              {"provenance",
               {{"command", model.provenance.command},
                {"version", model.provenance.version},
                {"trials", model.provenance.trials},
                {"seed", model.provenance.seed},
                {"data", model.provenance.data},
                {"note", model.provenance.note}}},
              {"warm_up", "passed"}};
}

absl::StatusOr<Json> InspectTrials(const std::string& path) {
  TACTUS_ASSIGN_OR_RETURN(auto reader, TrialFileReader::Open(path));
  std::map<std::string, int> labels;
  std::map<std::string, int> conditions;
  std::map<std::string, int> materials;
  std::map<std::string, int> layouts;
  size_t frames = 0;
  for (size_t i = 0; i < reader.size(); ++i) {
    TACTUS_ASSIGN_OR_RETURN(const Trial trial, reader.Read(i));
    ++labels[trial.label];
    ++conditions[trial.condition];
    ++materials[trial.material];
    ++layouts[trial.layout];
    frames += trial.time.size();
  }
  return Json{{"kind", "trials"},      {"trials", reader.size()},
              {"frames", frames},      {"counts", labels},
              {"layouts", layouts},    {"conditions", conditions},
              {"materials", materials}};
}

absl::Status Run(const Flags& flags) {
  Json json;
  if (IsBundle(flags.path)) {
    TACTUS_ASSIGN_OR_RETURN(json, InspectBundle(flags.path));
  } else {
    TACTUS_ASSIGN_OR_RETURN(json, InspectTrials(flags.path));
  }
  std::cout << JsonText(json, flags.json ? -1 : 2) << "\n";
  return absl::OkStatus();
}

}  // namespace

void AddInspect(CLI::App& app, const SelectCommand& select) {
  auto flags = std::make_shared<Flags>();
  CLI::App* command =
      app.add_subcommand("inspect", "Tell what a trial file or bundle holds");
  command->add_option("file", flags->path, "Trial file or bundle")->required();
  command->add_flag("--json", flags->json, "Print one JSON object on stdout");
  command->callback([=] { select([=] { return Run(*flags); }); });
}

}  // namespace tactus::client
