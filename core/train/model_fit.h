// File: model_fit.h
//
// ModelFit: one uncalibrated model of some contacts, as tasks that threads may
// share out.
//
//   ModelFit fit(run, "fold/2/", {.lstms = 1}, contacts);
//   TACTUS_RETURN_IF_ERROR(fit.FitHmmInputs(RunOnThreads));
//   TACTUS_RETURN_IF_ERROR(fit.FitLstmInputs(/*keep=*/true));
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

#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "core/base/work.h"
#include "core/classify/model.h"
#include "core/contacts/varied_contacts.h"
#include "core/train/archive.h"
#include "core/train/fit_models.h"
#include "core/train/fit_run.h"

namespace tactus::internal {

class ModelFit {
 public:
  // Which networks to train: LSTMs that classify, and an estimator of the
  // object if the options ask for one and the truth is known.
  struct Networks {
    int lstms = 0;
    bool estimator = true;
  };

  // `prefix` goes before the names of all parts.
  ModelFit(const FitRun& run, std::string prefix, const Networks& networks,
           std::vector<const LabelledContact*> contacts);

  const std::string& prefix() const { return prefix_; }

  // Bytes that the LSTMs' inputs take if they are kept.
  size_t InputBytes() const;
  // Fits the scaling of the HMMs' inputs. After it come the tasks of HMMs.
  absl::Status FitHmmInputs(const ParallelFor& parallel);
  // Fits the scaling of the LSTMs' inputs and makes them, or makes them for
  // each batch if they are not kept. Comes after FitHmmInputs and before the
  // other tasks. `put`: this rank puts the scalings into the journal.
  absl::Status FitLstmInputs(bool keep, bool put = true);
  // Drops the inputs. Comes after the tasks.
  void DropInputs() {
    hmm_cues_ = CueTable();
    lstm_inputs_.reset();
  }

  // Tasks: the first network, the HMMs of each class or the ridge, then further
  // networks.
  int tasks() const { return networks_ + FirstTasks(); }
  // The task that comes first to an iteration: the HMMs of the class with the
  // fewest contacts.
  int QuickestTask() const;
  // Work of a task, relative to that of other models' tasks.
  double Weight(int task) const;
  // `parallel` lends threads to the part of the work that can use them.
  absl::Status FitTask(int task, const Progress& progress,
                       const ParallelFor& parallel = RunSerially);

  // Whether the task trains a network whose batches are cut into shards, as all
  // ranks do together.
  bool IsShardedNetwork(int task) const {
    return NetworkOf(task) >= 0 && run_.options.lstm.training.shards > 1;
  }
  // Writes what this rank has made of the inputs or of a task, for another rank
  // that reads it.
  void GiveInputs(ByteWriter& writer) const { writer(model_.inputs); }
  void GiveTask(int task, ByteWriter& writer) const;
  void TakeInputs(ByteReader& reader) { reader(model_.inputs); }
  void TakeTask(int task, ByteReader& reader);

  // The model, once all tasks are done, with a uniform prior and with
  // temperatures that leave the scores unchanged.
  Model TakeModel();

 private:
  // Tasks that are not networks.
  int FirstTasks() const {
    return run_.options.learner != Learner::kHmms
               ? 1
               : static_cast<int>(run_.class_names.size());
  }
  // The number of the network that a task trains; -1 for HMMs.
  int NetworkOf(int task) const;
  int ClassOf(int task) const;
  // The name of the part that a task makes.
  std::string PartOf(int task) const;
  absl::Status FitNetwork(int task, const Progress& progress);

  const FitRun& run_;
  const std::string prefix_;
  VariedContacts hmm_contacts_;
  VariedContacts lstm_contacts_;
  const int lstms_;
  const bool estimates_;
  const int networks_;  // with the estimator
  Model model_;
  std::vector<LstmNetwork> trained_;
  CueTable hmm_cues_;
  std::optional<LstmInputs> lstm_inputs_;
};

}  // namespace tactus::internal
