// File: foreign_model.h
//
// ForeignModel: what a file of another program holds of a model, and what it
// states about the inputs. The readers of this room return one, and
// ReplaceModels (replace_models.h) puts it into a model.
//
//   TACTUS_ASSIGN_OR_RETURN(ForeignModel foreign, ReadModelFile("net.onnx"));
//   TACTUS_RETURN_IF_ERROR(ReplaceModels(foreign, model));
//
// Plain data, copyable.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/classify/model.h"

namespace tactus::internal {

// The HMMs of one class.
struct NamedMixture {
  // Empty if the file does not name the class.
  std::string class_name;
  HmmMixture mixture;
};

struct ForeignModel {
  // Any number; empty in a file of networks.
  std::vector<NamedMixture> hmms;
  // Networks of one shape; empty in a file of HMMs.
  std::vector<LstmNetwork> lstms;

  // What follows is empty, or 0, if the file does not state it.
  // The order of the networks' outputs.
  std::vector<std::string> class_names;
  // How the inputs of the HMMs or of the networks are made.
  std::vector<ModelInput> inputs;
  std::optional<StepIntervals> steps;
  std::optional<Score> hmm_score;
  double sample_rate_hz = 0;
};

}  // namespace tactus::internal
