// File: model_fit.h
//
// ModelFit: one uncalibrated model of some contacts, as tasks that threads may
// share out.
//
//   ModelFit fit(run, "fold/2/", contacts);
//   TACTUS_RETURN_IF_ERROR(fit.FitInputs());
//   for (int task = 0; task < fit.tasks(); ++task) {
//     TACTUS_RETURN_IF_ERROR(fit.FitTask(task, Progress()));
//   }
//   const Model model = fit.TakeModel();
//
// HMMs are trained on copies of the same stiffness: their few components would
// have to cover the others too and would fit known materials less well.
//
// Refers to the run and the contacts. FitTask may run on several threads at
// once, with different tasks.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "core/classify/model.h"
#include "core/train/fit_models.h"
#include "core/train/fit_run.h"
#include "core/train/varied_contacts.h"
#include "core/train/work.h"

namespace tactus {

class ModelFit {
 public:
  // `prefix` goes before the names of all parts.
  ModelFit(const FitRun& run, std::string prefix,
           std::vector<const LabelledContact*> contacts);

  const std::string& prefix() const { return prefix_; }

  // Fits the scaling of the inputs. Comes first.
  absl::Status FitInputs();

  // Tasks: the first network, the HMMs of each class, then further networks.
  int tasks() const { return networks_ + run_.class_names.size(); }
  // Work of a task, relative to that of other models' tasks.
  double Weight(int task) const;
  absl::Status FitTask(int task, const Progress& progress);

  // The model, once all tasks are done, with a uniform prior and with
  // temperatures that leave the scores unchanged.
  Model TakeModel();

 private:
  // The number of the network that a task trains; -1 for HMMs.
  int NetworkOf(int task) const;
  int ClassOf(int task) const;
  absl::Status FitNetwork(int n, const Progress& progress);

  const FitRun& run_;
  const std::string prefix_;
  const VariedContacts hmm_contacts_;
  const VariedContacts lstm_contacts_;
  // An estimator is trained where the truth is known.
  bool estimates_ = false;
  int networks_ = 0;  // with the estimator
  Model model_;
  std::vector<LstmNetwork> trained_;
  LstmInputs lstm_inputs_;
};

}  // namespace tactus
