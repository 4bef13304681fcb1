// trainctl bundle import: puts models of other programs into a bundle.
#include <algorithm>
#include <filesystem>
#include <iostream>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/base/version.h"
#include "core/bundle/bundle.h"
#include "core/classify/warm_up.h"
#include "core/files/draft_file.h"
#include "core/interchange/read_model_file.h"
#include "core/interchange/replace_models.h"
#include "core/train/calibrate.h"
#include "tools/trainctl/command.h"
#include "tools/trainctl/progress_display.h"

namespace tactus::internal::client {
namespace {

struct ImportModelFlags {
  std::vector<std::string> files;
  std::string into;
  std::string out;
  std::string class_name;
  std::string activation = "tanh";
  std::string gate_activation = "sigmoid";
  std::string dense_activation;
  std::string calibrate;
  std::string layout;
  bool json = false;
};

absl::StatusOr<KerasOptions> KerasOptionsOf(const ImportModelFlags& flags) {
  KerasOptions options;
  if (flags.activation == "softsign") {
    options.activation = Activation::kSoftsign;
  } else if (flags.activation != "tanh") {
    return InvalidConfig("--activation", flags.activation, "tanh or softsign");
  }
  if (flags.gate_activation == "hard-sigmoid") {
    options.gate_activation = GateActivation::kHardSigmoid;
  } else if (flags.gate_activation != "sigmoid") {
    return InvalidConfig("--gate-activation", flags.gate_activation,
                         "sigmoid or hard-sigmoid");
  }
  if (flags.dense_activation == "relu") {
    options.dense_activation = HiddenActivation::kRelu;
  } else if (flags.dense_activation == "tanh") {
    options.dense_activation = HiddenActivation::kTanh;
  } else if (flags.dense_activation == "sigmoid") {
    options.dense_activation = HiddenActivation::kSigmoid;
  } else if (flags.dense_activation == "linear") {
    options.dense_activation = HiddenActivation::kLinear;
  } else if (!flags.dense_activation.empty()) {
    return InvalidConfig("--dense-activation", flags.dense_activation,
                         "relu, tanh, sigmoid or linear");
  }
  return options;
}

// All files as one: several files of one network each become the networks whose
// mean is the answer.
absl::StatusOr<std::vector<ForeignModel>> ReadFiles(
    const ImportModelFlags& flags) {
  TACTUS_ASSIGN_OR_RETURN(const KerasOptions keras, KerasOptionsOf(flags));
  std::vector<ForeignModel> models;
  // The index of the file whose networks those of later files join.
  size_t networks = flags.files.size();
  for (const std::string& file : flags.files) {
    TACTUS_ASSIGN_OR_RETURN(ForeignModel model, ReadModelFile(file, keras));
    for (NamedMixture& named : model.hmms) {
      if (named.class_name.empty()) named.class_name = flags.class_name;
    }
    if (model.lstms.empty() || networks == flags.files.size()) {
      if (!model.lstms.empty()) networks = models.size();
      models.push_back(std::move(model));
      continue;
    }
    ForeignModel& first = models[networks];
    if (model.class_names != first.class_names) {
      return InvalidModel(absl::StrCat(file, ": classes"),
                          absl::StrJoin(model.class_names, ", "),
                          "those of the files before");
    }
    first.lstms.insert(first.lstms.end(), model.lstms.begin(),
                       model.lstms.end());
  }
  return models;
}

// Fits the calibration to contacts that the imported models have not seen.
absl::Status Calibrate(const ImportModelFlags& flags, Model& model) {
  ProgressDisplay display;
  TACTUS_ASSIGN_OR_RETURN(
      const LoadedContacts loaded,
      LoadContacts({flags.calibrate, flags.layout}, display.progress()));
  TACTUS_ASSIGN_OR_RETURN(const auto compiled, CompiledModel::Create(model));
  const std::vector<double> frames =
      CalibrationFrames(model.inputs.sample_rate_hz, model.inputs.lstm_steps);
  std::vector<ScoredContact> scored;
  for (const LabelledContact& contact : loaded.contacts) {
    if (std::ranges::find(model.class_names, contact.label) ==
        model.class_names.end()) {
      return InvalidTrainingData(
          absl::StrCat("contact ", contact.id, " has the label \"",
                       contact.label, "\"; the bundle's classes are ",
                       absl::StrJoin(model.class_names, ", ")));
    }
    if (contact.sample_rate_hz != model.inputs.sample_rate_hz) {
      return InvalidTrainingData(absl::StrCat(
          "contact ", contact.id, " has ", contact.sample_rate_hz,
          " frames per second; the bundle has ", model.inputs.sample_rate_hz));
    }
    scored.push_back(ScoreContact(compiled, contact, frames));
  }
  if (scored.empty()) {
    return InvalidTrainingData(
        absl::StrCat(flags.calibrate, " has no contact to calibrate with"));
  }
  FitCalibration(scored, frames, model.calibration);
  return absl::OkStatus();
}

absl::Status RunImportModel(const ImportModelFlags& flags) {
  TACTUS_ASSIGN_OR_RETURN(const auto compiled, LoadModel(flags.into));
  TACTUS_ASSIGN_OR_RETURN(const std::vector<ForeignModel> foreign,
                          ReadFiles(flags));
  Model model = compiled->model();
  const bool had_estimator = model.estimator.has_value();
  int classes = 0;
  for (const ForeignModel& part : foreign) {
    TACTUS_RETURN_IF_ERROR(ReplaceModels(part, model));
    classes += static_cast<int>(part.hmms.size());
  }
  if (!flags.calibrate.empty()) {
    TACTUS_RETURN_IF_ERROR(Calibrate(flags, model));
  }
  TACTUS_RETURN_IF_ERROR(AnswerWarmUp(model));
  const bool lost_estimator = had_estimator && !model.estimator;
  const bool has_networks = std::ranges::any_of(
      foreign, [](const ForeignModel& part) { return !part.lstms.empty(); });
  const int networks = has_networks ? static_cast<int>(model.lstms.size()) : 0;
  model.provenance.command = CommandLine();
  model.provenance.version = kVersion;
  TACTUS_ASSIGN_OR_RETURN(const std::string bytes, EncodeBundle(model));
  TACTUS_RETURN_IF_ERROR(WriteFileBytes(flags.out, bytes));
  if (flags.json) {
    std::cout << JsonText(Json{{"bundle", flags.out},
                               {"sha256", BundleSha256(bytes)},
                               {"bytes", bytes.size()},
                               {"classes_of_hmms", classes},
                               {"networks", networks},
                               {"calibrated", !flags.calibrate.empty()},
                               {"estimator_removed", lost_estimator}})
              << "\n";
    return absl::OkStatus();
  }
  std::cout << absl::StrFormat(
      "%s: %d bytes, HMMs of %d classes and %d networks replaced\nsha256 %s\n",
      flags.out, bytes.size(), classes, networks, BundleSha256(bytes));
  if (lost_estimator) {
    std::cout << "The estimator of stiffness and motion was removed: its "
                 "inputs have changed.\n";
  }
  if (flags.calibrate.empty()) {
    std::cout << "The calibration is that of the old models. Fit it with "
                 "--calibrate=TRIALS, contacts that the models have not "
                 "seen.\n";
  }
  return absl::OkStatus();
}

}  // namespace

void AddImportModel(CLI::App& app, const SelectCommand& select) {
  auto flags = std::make_shared<ImportModelFlags>();
  CLI::App& group = CommandGroup(
      app, "bundle", "Models of a bundle as files of other programs",
      "export mine.tactus --format=onnx --out=exported");
  CLI::App* command =
      &AddVerb(group, "import",
               "Replace HMMs or LSTMs of a bundle by those of other programs",
               "import net.onnx --into=mine.tactus --out=new.tactus");
  command
      ->add_option("files", flags->files,
                   "ONNX (.onnx), Keras weights (.h5), HMMs (.json, .npz); "
                   "several files of networks are averaged")
      ->required();
  command
      ->add_option("--into", flags->into,
                   "Bundle that gives classes, inputs and layout")
      ->required();
  command->add_option("--out", flags->out, "Bundle to write")->required();
  command->add_option("--class", flags->class_name,
                      "Class of a file with one HMM");
  command->add_option("--activation", flags->activation,
                      "Of Keras weights: tanh (default) or softsign");
  command->add_option("--gate-activation", flags->gate_activation,
                      "Of Keras weights: sigmoid (default) or hard-sigmoid");
  command->add_option("--dense-activation", flags->dense_activation,
                      "Of hidden Dense layers of Keras weights: relu, tanh, "
                      "sigmoid or linear");
  command->add_option("--calibrate", flags->calibrate,
                      "Trial file with contacts that the models have not seen");
  command->add_option("--layout", flags->layout,
                      "JSON file with a skin that is no preset");
  command->add_flag("--json", flags->json, "Print one JSON object on stdout");
  command->callback([=] { select([=] { return RunImportModel(*flags); }); });
}

}  // namespace tactus::internal::client
