// File: fit_models.h
//
// The parts of one uncalibrated model: the scaling of its inputs, the HMMs of
// each class, each network. ModelFit (model_fit.h) puts them together.
//
//   TACTUS_ASSIGN_OR_RETURN(HmmMixture mixture,
//                           FitClassHmms(run, name, contacts, spec, table, c,
//                                        RunSerially, Progress()));
//
// `part` is the name of the part in the journal (fit_journal.h). Each function
// returns a part that the journal has, and puts one that it made. Thread-safe:
// free functions without state.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/work.h"
#include "core/classify/model.h"
#include "core/contacts/varied_contacts.h"
#include "core/inputs/cue_table.h"
#include "core/inputs/lstm_inputs.h"
#include "core/train/fit_run.h"

namespace tactus::internal {

// The inputs of HMMs. The journal may have those of LSTMs too; the part is put
// by FitLstmInputs. Writes the HMMs' cues to `table` if they were made and are
// few enough to keep.
absl::StatusOr<InputSpec> FitHmmInputs(const FitRun& run,
                                       const std::string& part,
                                       const VariedContacts& contacts,
                                       const ParallelFor& parallel,
                                       CueTable* table);

// Adds the inputs of LSTMs to those of HMMs, if there are networks. `put`: puts
// them into the journal, as one of several ranks does that make them.
absl::Status FitLstmInputs(const FitRun& run, const std::string& part,
                           const VariedContacts& contacts, bool put,
                           InputSpec* spec);

// The HMMs of the class number `label`, which must have a contact. `table` is
// that of FitHmmInputs.
absl::StatusOr<HmmMixture> FitClassHmms(
    const FitRun& run, const std::string& part, const VariedContacts& contacts,
    const InputSpec& spec, const CueTable& table, int label,
    const ParallelFor& parallel, const Progress& progress);

// What stands in place of HMMs, of all contacts, which must be of one skin.
absl::StatusOr<Ridge> FitContactRidge(
    const FitRun& run, const std::string& part,
    const std::vector<const LabelledContact*>& contacts,
    const Progress& progress);
absl::StatusOr<Trees> FitContactTrees(
    const FitRun& run, const std::string& part,
    const std::vector<const LabelledContact*>& contacts,
    const Progress& progress);
absl::StatusOr<Nearest> FitContactNearest(
    const FitRun& run, const std::string& part,
    const std::vector<const LabelledContact*>& contacts,
    const Progress& progress);

// Trains the network number `n`. One that estimates the object needs inputs
// with targets.
absl::StatusOr<LstmNetwork> FitLstm(const FitRun& run, const std::string& part,
                                    const LstmInputs& inputs,
                                    const InputSpec& spec, int n,
                                    bool estimates, const Progress& progress);

}  // namespace tactus::internal
