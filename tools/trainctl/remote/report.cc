#include "tools/trainctl/remote/report.h"

#include <filesystem>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/version.h"
#include "core/contacts/trained_on.h"
#include "core/files/draft_file.h"
#include "tools/trainctl/report/evaluate_page.h"
#include "tools/trainctl/report/evaluate_report.h"
#include "tools/trainctl/text.h"

namespace tactus::internal::client {
namespace {

double Fraction(const v1::Accuracy& accuracy) {
  return accuracy.contacts() == 0
             ? 0
             : static_cast<double>(accuracy.correct()) / accuracy.contacts();
}

Json IntervalOf(const v1::Accuracy& accuracy) {
  return IntervalToJson({accuracy.low(), accuracy.high()});
}

Json BinsToJson(const v1::EvaluationReport& report) {
  Json list = Json::array();
  for (const v1::ReliabilityBin& bin : report.reliability()) {
    // The page divides by the count.
    if (bin.accuracy().contacts() == 0) continue;
    list.push_back({{"low", bin.low()},
                    {"high", bin.high()},
                    {"mean_probability", bin.confidence()},
                    {"contacts", bin.accuracy().contacts()},
                    {"right", bin.accuracy().correct()}});
  }
  return list;
}

}  // namespace

Json ReportToJson(const v1::EvaluationReport& report) {
  const int felt = static_cast<int>(report.accuracy().contacts());
  const int never_felt = static_cast<int>(report.never_felt());
  Json accuracy_at = Json::object();
  Json interval_at = Json::object();
  for (int i = 0; i < std::min(report.anytime_size(), report.anytime_s_size());
       ++i) {
    const std::string key = absl::StrFormat("%g", report.anytime_s(i));
    accuracy_at[key] = Fraction(report.anytime(i));
    interval_at[key] = IntervalOf(report.anytime(i));
  }
  const size_t classes = report.class_names_size();
  Confusion confusion(classes, std::vector<int>(classes, 0));
  for (int i = 0; i < report.confusion_size(); ++i) {
    if (i / classes >= classes) break;
    confusion[i / classes][i % classes] = static_cast<int>(report.confusion(i));
  }
  Json json = {{"trials", felt + never_felt},
               {"undetectable", never_felt},
               {"felt", felt},
               {"right", report.accuracy().correct()},
               {"accuracy", Fraction(report.accuracy())},
               {"accuracy_interval", IntervalOf(report.accuracy())},
               {"accuracy_at", accuracy_at},
               {"accuracy_interval_at", interval_at},
               {"log_loss", report.log_loss()},
               {"ece", report.calibration_error()}};
  json.update(ConfusionToJson(
      {report.class_names().begin(), report.class_names().end()}, confusion));
  if (report.reliability_size() > 0) json["reliability"] = BinsToJson(report);
  std::vector<WrongAnswer> wrong;
  for (const v1::WrongAnswer& answer : report.wrong()) {
    wrong.push_back({answer.name(), answer.label(), answer.answer()});
  }
  NameConfusions(wrong, json);
  return json;
}

absl::Status WriteRemoteReport(const std::string& folder,
                               const v1::Operation& job) {
  const v1::EvaluateSpec& spec = job.evaluate();
  EvaluationPageParts parts;
  parts.title = absl::StrCat("Evaluation on ", spec.dataset_version());
  parts.facts = {{"dataset", spec.dataset_version()}};
  if (spec.model_version().empty()) {
    const v1::TrainSpec& train = spec.train();
    parts.facts.emplace_back("protocol", spec.protocol());
    parts.facts.emplace_back("preset",
                             train.preset().empty() ? "tuned" : train.preset());
    parts.facts.emplace_back("seed", absl::StrCat(train.seed()));
  } else {
    parts.facts.emplace_back("model", spec.model_version());
  }
  const v1::EvaluationReport& report = job.result().evaluation();
  parts.facts.emplace_back("log-loss",
                           absl::StrFormat("%.4f", report.log_loss()));
  parts.facts.emplace_back("calibration error",
                           absl::StrFormat("%.3f", report.calibration_error()));
  parts.facts.emplace_back("job", job.name());
  parts.facts.emplace_back("program", absl::StrCat("trainctl ", kVersion));
  if (!spec.model_version().empty()) {
    parts.warning = TrainedOnText(
        {.basis = static_cast<TrainingBasis>(report.training_basis()),
         .contacts = static_cast<int>(report.trained_on_contacts()),
         .tested = static_cast<int>(report.accuracy().contacts())});
  }
  parts.evaluation = ReportToJson(report);
  return WriteFileBytes((std::filesystem::path(folder) / "index.html").string(),
                        EvaluationPage(parts));
}

}  // namespace tactus::internal::client
