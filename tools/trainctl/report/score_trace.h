// File: score_trace.h
//
// ScoreTrace: what a classifier takes and gives at each step of a contact, raw
// and calibrated, so that exported models can be checked outside.
//
//   ScoreTrace trace;
//   classifier.Step(sample, 0);
//   trace.Add(classifier, /*contact_id=*/1);
//   Json steps = trace.Take();
//
// Not thread-safe.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "core/classify/contact_classifier.h"
#include "tools/common/json.h"

namespace tactus::internal::client {

class ScoreTrace {
 public:
  // Call it after each frame of the contact; frames without a step add nothing.
  void Add(const ContactClassifier& classifier, uint64_t contact_id);
  // A list of the steps so far, which are forgotten. Each has
  //   contact, frame         the frame since onset, from 1
  //   lstm_inputs            scaled, as lstm.onnx takes them
  //   lstm_raw               mean probability of the networks, as it gives it
  //   lstm_calibrated        one probability per class
  //   hmm_inputs             scaled, as the HMMs take them
  //   hmm_raw                log-likelihood per class
  //   hmm_calibrated         one probability per class
  //   probability            the answer
  // without the keys of models that the bundle does not have or that took no
  // step at this frame.
  Json Take();

 private:
  Json steps_ = Json::array();
  // Steps of a contact so far.
  struct Steps {
    uint64_t hmm = 0;
    uint64_t lstm = 0;
  };
  // By contact.
  std::map<uint64_t, Steps> taken_;
};

// For people: one line per step and model.
std::string ScoreText(const Json& steps);

}  // namespace tactus::internal::client
