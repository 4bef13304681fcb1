// File: lstm_inputs.h
//
// LstmInputs: what the LSTMs of a model are trained on. The scaled inputs of
// all contacts and copies are kept, or made for each batch. Both give the same
// sequences.
//
//   const LstmInputs inputs(contacts, class_names, spec,
//                           {.keep = true, .with_targets = true});
//   const auto source = inputs.Source(/*with_targets=*/false);
//   TrainLstm(checkpoint, *source, {}, options);
//
// A kept step of one contact takes 4 bytes an input. Making a sequence takes
// about as long as training on it.
//
// Refers to the contacts, names and spec. Thread-safe once made; each source
// belongs to one thread.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/string_view.h"
#include "core/classify/model.h"
#include "core/contacts/varied_contacts.h"
#include "core/lstm/sequence_source.h"

namespace tactus::internal {

class LstmInputs {
 public:
  struct Options {
    bool keep = true;
    // What object_estimate.h asks for, at every step.
    bool with_targets = false;
    Truth truth = Truth::kFinal;
  };

  LstmInputs(const VariedContacts& contacts,
             const std::vector<std::string>& class_names, const InputSpec& spec,
             const Options& options);

  // Contacts and copies without a step are left out. Refers to *this.
  std::unique_ptr<LstmSequenceSource> Source(bool with_targets) const;

  // Bytes that kept inputs take at most.
  static size_t KeptBytes(const VariedContacts& contacts, size_t inputs,
                          const StepIntervals& steps);

 private:
  class MadeForEachBatch;
  struct Rows {
    std::vector<float> inputs;
    std::vector<float> targets;
    // Empty if the label does not change.
    std::vector<int16_t> labels;
  };

  // Makes the rows of a contact.
  void Make(const LabelledContact& contact, bool with_targets,
            Rows& rows) const;
  LstmSequence View(size_t contact, const Rows& rows, bool with_targets) const;
  int16_t ClassOf(absl::string_view label) const;

  const VariedContacts& contacts_;
  const std::vector<std::string>& class_names_;
  const InputSpec& spec_;
  const Truth truth_;
  // The contacts and copies with a step.
  std::vector<size_t> stepped_;
  // If kept: their rows, and views of them with and without targets.
  std::vector<Rows> rows_;
  std::vector<LstmSequence> sequences_;
  std::vector<LstmSequence> with_targets_;
};

}  // namespace tactus::internal
