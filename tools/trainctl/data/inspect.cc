// trainctl inspect: prints the contents of a trial file or a bundle.
#include <algorithm>
#include <fstream>
#include <iostream>
#include <map>

#include "absl/strings/str_cat.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/bundle/bundle.h"
#include "core/classify/input_spec.h"
#include "core/data/trial_file.h"
#include "core/data/trial_layout.h"
#include "core/files/file_bytes.h"
#include "core/skin/layout_json.h"
#include "tools/trainctl/command.h"
#include "tools/trainctl/data/contact_summary.h"

namespace tactus::internal::client {
namespace {

struct InspectFlags {
  std::string path;
  std::string layout;
  bool json = false;
};

bool IsBundle(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  char magic[8] = {};
  file.read(magic, sizeof magic);
  return absl::string_view(magic, sizeof magic) == "TACTUSMB";
}

// Each cue once, in the order of the inputs.
std::vector<std::string> CueNames(const std::vector<ModelInput>& inputs) {
  std::vector<std::string> names;
  for (const ModelInput& input : inputs) {
    std::string name(CueName(input.cue));
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      names.push_back(std::move(name));
    }
  }
  return names;
}

absl::StatusOr<Json> InspectBundle(const std::string& path) {
  TACTUS_ASSIGN_OR_RETURN(const std::string bytes,
                          ReadFileBytes(path, limits::kMaxBundleBytes));
  TACTUS_ASSIGN_OR_RETURN(const auto compiled, LoadModel(path));
  TACTUS_RETURN_IF_ERROR(RunWarmUp(*compiled));
  const Model& model = compiled->model();
  Json hmms = Json::object();
  for (size_t k = 0; k < model.hmms.size(); ++k) {
    hmms[model.class_names[k]] = {
        {"components", model.hmms[k].components.size()},
        {"states", model.hmms[k].components.front().states}};
  }
  return Json{
      {"kind", "bundle"},
      {"format_version", BundleFormatVersion(model)},
      {"bytes", bytes.size()},
      {"sha256", BundleSha256(bytes)},
      {"classes", model.class_names},
      {"features", FeaturesToString(FeaturesUsed(model.inputs))},
      {"hmm_cues", CueNames(model.inputs.hmm)},
      {"lstm_cues", CueNames(model.inputs.lstm)},
      {"sample_rate_hz", model.inputs.sample_rate_hz},
      {"hmms", hmms},
      {"ridge_numbers",
       model.ridge ? Json(model.ridge->offset.size()) : Json(nullptr)},
      {"nearest_samples",
       model.nearest ? Json(model.nearest->label.size()) : Json(nullptr)},
      {"tree_nodes",
       model.trees ? Json(model.trees->number.size()) : Json(nullptr)},
      {"lstms", model.lstms.size()},
      {"lstm_parameters", model.lstms.empty()
                              ? Json(nullptr)
                              : Json(model.lstms[0].parameter_count())},
      {"layout", model.layout.name},
      {"skin", model.layout.name.empty()
                   ? Json("any")
                   : Json::parse(LayoutToJson(model.layout))},
      {"release_after_s", model.release_after_s},
      {"decision",
       {{"threshold", model.calibration.decision_threshold},
        {"frames", model.calibration.decision_frames}}},
      {"provenance",
       {{"command", model.provenance.command},
        {"version", model.provenance.version},
        {"trials", model.provenance.trials},
        {"seed", model.provenance.seed},
        {"data", model.provenance.data},
        {"groups", model.provenance.groups},
        {"conditions", model.provenance.conditions},
        {"note", model.provenance.note}}},
      {"warm_up", "passed"}};
}

absl::StatusOr<Json> InspectTrials(const std::string& path,
                                   const std::string& layout_path) {
  SkinLayout given;
  if (!layout_path.empty()) {
    TACTUS_ASSIGN_OR_RETURN(given, ReadLayoutFile(layout_path));
  }
  TACTUS_ASSIGN_OR_RETURN(auto reader, TrialFileReader::Open(path));
  std::map<std::string, int> labels;
  std::map<std::string, int> conditions;
  std::map<std::string, int> materials;
  std::map<std::string, int> layouts;
  std::map<std::string, int> rates;
  // The trials of each skin, as JSON; "unknown" without one.
  std::map<std::string, int> skins;
  ContactSummary contacts;
  size_t frames = 0;
  size_t touches = 0;
  int with_poses = 0;
  for (size_t i = 0; i < reader.size(); ++i) {
    TACTUS_ASSIGN_OR_RETURN(const Trial trial, reader.Read(i));
    if (trial.touches.empty()) ++labels[trial.label];
    for (const Touch& touch : trial.touches) ++labels[touch.label];
    touches += trial.touches.size();
    ++conditions[trial.condition];
    ++materials[trial.material];
    ++layouts[trial.layout];
    ++rates[absl::StrCat(trial.sample_rate_hz)];
    with_poses += !trial.poses.empty();
    frames += trial.time.size();
    if (trial.taxels.empty()) continue;
    const auto layout = LayoutOfTrial(trial, &given);
    ++skins[layout.ok() ? LayoutToJson(*layout) : "unknown"];
    if (layout.ok()) TACTUS_RETURN_IF_ERROR(contacts.Add(trial, *layout));
  }
  Json skin_list = Json::array();
  for (const auto& [text, count] : skins) {
    const Json skin = Json::parse(text, nullptr, /*allow_exceptions=*/false);
    skin_list.push_back(
        {{"trials", count},
         {"skin", skin.is_discarded()
                      ? Json("unknown: no preset has this name; give --layout")
                      : skin}});
  }
  return Json{{"kind", "trials"},
              {"trials", reader.size()},
              {"frames", frames},
              {"touches", touches},
              {"counts", labels},
              {"layouts", layouts},
              {"skins", skin_list},
              {"sample_rates_hz", rates},
              {"with_poses", with_poses},
              {"conditions", conditions},
              {"materials", materials},
              {"contacts", skins.empty() ? Json(nullptr) : contacts.ToJson()}};
}

absl::Status RunInspect(const InspectFlags& flags) {
  Json json;
  if (IsBundle(flags.path)) {
    TACTUS_ASSIGN_OR_RETURN(json, InspectBundle(flags.path));
  } else {
    TACTUS_ASSIGN_OR_RETURN(json, InspectTrials(flags.path, flags.layout));
  }
  std::cout << JsonText(json, flags.json ? -1 : 2) << "\n";
  return absl::OkStatus();
}

}  // namespace

void AddInspect(CLI::App& app, const SelectCommand& select) {
  auto flags = std::make_shared<InspectFlags>();
  CLI::App* command =
      &AddVerb(app, "inspect", "Print what a trial file or bundle holds",
               "inspect mine.h5");
  command->add_option("file", flags->path, "Trial file or bundle")->required();
  command->add_option("--layout", flags->layout,
                      "JSON file with the skin of trials that carry none");
  command->add_flag("--json", flags->json, "Print one JSON object on stdout");
  command->callback([=] { select([=] { return RunInspect(*flags); }); });
}

}  // namespace tactus::internal::client
