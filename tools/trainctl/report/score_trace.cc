#include "tools/trainctl/report/score_trace.h"

#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"

namespace tactus::internal::client {
namespace {

std::vector<double> ToVector(std::span<const double> values) {
  return {values.begin(), values.end()};
}

std::string Numbers(const Json& values) {
  return absl::StrJoin(values.get<std::vector<double>>(), " ",
                       [](std::string* out, double value) {
                         absl::StrAppendFormat(out, "%.6g", value);
                       });
}

}  // namespace

void ScoreTrace::Add(const ContactClassifier& classifier, uint64_t contact_id) {
  Steps& taken = taken_[contact_id];
  const bool hmms = classifier.hmm_steps() != taken.hmm;
  const bool lstms = classifier.lstm_steps() != taken.lstm;
  if (!hmms && !lstms) return;
  taken = {classifier.hmm_steps(), classifier.lstm_steps()};
  Json step = {{"contact", contact_id}, {"frame", classifier.frames()}};
  if (lstms) {
    std::vector<double> raw;
    for (const double score : classifier.lstm_score()) {
      raw.push_back(std::exp(score));
    }
    step["lstm_inputs"] = ToVector(classifier.lstm_input());
    step["lstm_raw"] = raw;
    step["lstm_calibrated"] = ToVector(classifier.lstm_probability());
  }
  if (hmms) {
    step["hmm_inputs"] = ToVector(classifier.hmm_input());
    step["hmm_raw"] = ToVector(classifier.log_likelihood());
    step["hmm_calibrated"] = ToVector(classifier.hmm_probability());
  }
  step["probability"] = ToVector(classifier.probability());
  steps_.push_back(std::move(step));
}

Json ScoreTrace::Take() {
  taken_.clear();
  return std::exchange(steps_, Json::array());
}

std::string ScoreText(const Json& steps) {
  std::string text;
  for (const Json& step : steps) {
    absl::StrAppendFormat(&text, "  contact %d, frame %d: answer %s\n",
                          step["contact"].get<uint64_t>(),
                          step["frame"].get<uint64_t>(),
                          Numbers(step["probability"]));
    for (const char* model : {"lstm", "hmm"}) {
      const std::string name = model;
      if (!step.contains(name + "_inputs")) continue;
      absl::StrAppendFormat(&text,
                            "    %s inputs %s\n    %s raw %s\n"
                            "    %s calibrated %s\n",
                            name, Numbers(step[name + "_inputs"]), name,
                            Numbers(step[name + "_raw"]), name,
                            Numbers(step[name + "_calibrated"]));
    }
  }
  return text;
}

}  // namespace tactus::internal::client
