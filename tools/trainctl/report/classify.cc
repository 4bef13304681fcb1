// trainctl classify: prints the answer of a bundle to every trial of a file.
#include <algorithm>
#include <iostream>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/classify/contact_pipeline.h"
#include "core/classify/input_spec.h"
#include "core/contacts/contact_set.h"
#include "core/data/trial_file.h"
#include "core/data/trial_id.h"
#include "core/data/trial_layout.h"
#include "core/features/contact_time.h"
#include "tools/trainctl/command.h"
#include "tools/trainctl/report/score_trace.h"

namespace tactus::internal::client {
namespace {

struct ClassifyFlags {
  std::string data;
  std::string model;
  std::string layout;
  std::string trial;
  bool scores = false;
  bool json = false;
};

// Makes the answer from the classifier at the end of a trial.
Json Answer(const Trial& trial, const Model& model,
            const ContactClassifier& classifier, bool detected) {
  Json json = {
      {"trial", trial.id}, {"source", trial.source}, {"label", trial.label}};
  json["detected"] = detected;
  const auto probability = classifier.probability();
  json["answer"] =
      detected ? Json(model.class_names[std::max_element(probability.begin(),
                                                         probability.end()) -
                                        probability.begin()])
               : Json(nullptr);
  json["probability"] = probability;
  json["log_likelihood"] = classifier.log_likelihood();
  json["unknown"] = classifier.unknown();
  json["decision_s"] = classifier.decision()
                           ? Json(ContactSeconds(classifier.decision()->frame,
                                                 trial.sample_rate_hz))
                           : Json(nullptr);
  return json;
}

absl::StatusOr<Json> ClassifyTaxels(
    const Trial& trial, const SkinLayout& given,
    const std::shared_ptr<const CompiledModel>& model, ScoreTrace* trace) {
  TACTUS_ASSIGN_OR_RETURN(const SkinLayout layout,
                          LayoutOfTrial(trial, &given));
  TACTUS_RETURN_IF_ERROR(CheckSkinOf(trial, layout, model->model()));
  // Contacts end as the model says, and so they do in a server.
  ContactPipeline::Options options;
  options.sample_rate_hz = trial.sample_rate_hz;
  options.with_poses = !trial.poses.empty();
  TACTUS_ASSIGN_OR_RETURN(auto pipeline,
                          ContactPipeline::Create(layout, model, options));
  std::vector<float> taxels(layout.values());
  for (size_t t = 0; t < trial.taxels.frames(); ++t) {
    trial.taxels.Decode(t, taxels.data());
    FrameView frame{.taxels = taxels};
    if (!trial.poses.empty()) frame.pose = &trial.poses[t];
    for (const ContactReport& contact : pipeline->Step(frame)) {
      if (trace != nullptr) trace->Add(*contact.classifier, contact.id);
    }
  }
  const ContactReport* contact = pipeline->main_contact();
  if (contact != nullptr) {
    return Answer(trial, model->model(), *contact->classifier, true);
  }
  return Answer(trial, model->model(), ContactClassifier(model, {}), false);
}

absl::StatusOr<Json> ClassifySignals(
    const Trial& trial, const std::shared_ptr<const CompiledModel>& model,
    ScoreTrace* trace) {
  if (NeedsSkin(model->model())) {
    return InvalidConfig(absl::StrCat("trial ", trial.id), "ideal signals",
                         "taxels: the model sees the whole skin");
  }
  ContactClassifier classifier(model, {});
  for (const FeatureVector& signals : trial.signals) {
    classifier.Step(IdealSample(signals), 0);
    if (trace != nullptr) trace->Add(classifier, /*contact_id=*/1);
  }
  return Answer(trial, model->model(), classifier, !trial.signals.empty());
}

std::vector<std::string> CueNamesOf(const std::vector<ModelInput>& inputs) {
  std::vector<std::string> names;
  for (const ModelInput& input : inputs) {
    names.emplace_back(CueName(input.cue));
  }
  return names;
}

// The probabilities of more classes would not fit on a line.
constexpr size_t kMostShown = 8;

std::string HeadText(const std::vector<std::string>& classes) {
  std::string text = "trial  label -> answer";
  if (classes.size() > kMostShown) {
    return absl::StrCat(text, "  probability of the answer\n");
  }
  for (const std::string& name : classes) absl::StrAppend(&text, "  ", name);
  return absl::StrCat(text, "\n");
}

// One line; its columns are as wide as those of the head.
std::string AnswerText(const Trial& trial, const Json& answer,
                       const std::vector<std::string>& classes) {
  std::string text = absl::StrFormat(
      "%s  %-4s -> %-4s", TrialName(trial.id, trial.source), trial.label,
      answer["detected"] ? answer["answer"].get<std::string>() : "-");
  const std::vector<double> probability = answer["probability"];
  if (probability.size() > kMostShown) {
    absl::StrAppendFormat(&text, "  %.3f",
                          *std::ranges::max_element(probability));
  } else {
    for (size_t c = 0; c < probability.size(); ++c) {
      absl::StrAppendFormat(&text, "  %*.3f",
                            static_cast<int>(classes[c].size()),
                            probability[c]);
    }
  }
  return text + "\n";
}

absl::Status RunClassify(const ClassifyFlags& flags) {
  SkinLayout layout;
  if (!flags.layout.empty()) {
    TACTUS_ASSIGN_OR_RETURN(layout, ReadLayoutFile(flags.layout));
  }
  TACTUS_ASSIGN_OR_RETURN(const auto model, LoadModel(flags.model));
  TACTUS_ASSIGN_OR_RETURN(auto reader, TrialFileReader::Open(flags.data));
  Json trials = Json::array();
  OddRates rates;
  ScoreTrace trace;
  ScoreTrace* const traced = flags.scores ? &trace : nullptr;
  for (size_t i = 0; i < reader.size(); ++i) {
    TACTUS_ASSIGN_OR_RETURN(const Trial trial, reader.Read(i));
    if (!flags.trial.empty() && trial.id != flags.trial &&
        trial.source != flags.trial) {
      continue;
    }
    rates.Add(trial);
    Json answer;
    if (trial.taxels.empty()) {
      TACTUS_ASSIGN_OR_RETURN(answer, ClassifySignals(trial, model, traced));
    } else {
      TACTUS_ASSIGN_OR_RETURN(answer,
                              ClassifyTaxels(trial, layout, model, traced));
    }
    if (!flags.json) {
      if (trials.empty()) std::cout << HeadText(model->model().class_names);
      std::cout << AnswerText(trial, answer, model->model().class_names);
    }
    if (flags.scores) {
      Json steps = trace.Take();
      if (!flags.json) std::cout << ScoreText(steps);
      answer["steps"] = std::move(steps);
    }
    trials.push_back(std::move(answer));
  }
  RemarkRates(rates, flags.data);
  if (!flags.trial.empty() && trials.empty()) {
    return InvalidConfig(
        "--trial", flags.trial,
        absl::StrCat("the id or the source of a trial of ", flags.data));
  }
  if (flags.json) {
    Json all = {{"classes", model->model().class_names}};
    if (flags.scores) {
      all["lstm_inputs"] = CueNamesOf(model->model().inputs.lstm);
      all["hmm_inputs"] = CueNamesOf(model->model().inputs.hmm);
    }
    all["trials"] = std::move(trials);
    std::cout << JsonText(all) << "\n";
  }
  return absl::OkStatus();
}

}  // namespace

void AddClassify(CLI::App& app, const SelectCommand& select) {
  auto flags = std::make_shared<ClassifyFlags>();
  CLI::App* command =
      &AddVerb(app, "classify", "Classify every trial of a file with a bundle",
               "classify --data=mine.h5 --model=mine.tactus");
  command->add_option("--model", flags->model, "Bundle")->required();
  command->add_option("--data", flags->data, "Trial file")->required();
  command->add_option("--layout", flags->layout,
                      "JSON file with the skin of trials that carry none");
  command->add_option("--trial", flags->trial,
                      "Only the trial with this id or source");
  command->add_flag("--scores", flags->scores,
                    "Print at each step the scaled inputs, the raw scores of "
                    "networks and HMMs, and the calibrated ones");
  command->add_flag("--json", flags->json, "Print one JSON object on stdout");
  command->callback([=] { select([=] { return RunClassify(*flags); }); });
}

}  // namespace tactus::internal::client
