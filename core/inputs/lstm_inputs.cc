#include "core/inputs/lstm_inputs.h"

#include <algorithm>

#include "core/classify/input_spec.h"
#include "core/classify/object_estimate.h"
#include "core/inputs/inputs.h"

namespace tactus::internal {

// Makes sequences as batches ask for them.
class LstmInputs::MadeForEachBatch : public LstmSequenceSource {
 public:
  MadeForEachBatch(const LstmInputs& inputs, bool with_targets)
      : inputs_(inputs), with_targets_(with_targets) {}

  size_t size() const override { return inputs_.stepped_.size(); }
  void Get(std::span<const size_t> numbers,
           std::vector<LstmSequence>& batch) override {
    batch.clear();
    if (rows_.size() < numbers.size()) rows_.resize(numbers.size());
    for (size_t i = 0; i < numbers.size(); ++i) {
      const size_t contact = inputs_.stepped_[numbers[i]];
      inputs_.Make(inputs_.contacts_.Get(contact, made_), with_targets_,
                   rows_[i]);
      batch.push_back(inputs_.View(contact, rows_[i], with_targets_));
    }
  }

 private:
  const LstmInputs& inputs_;
  const bool with_targets_;
  LabelledContact made_;
  std::vector<Rows> rows_;
};

LstmInputs::LstmInputs(const VariedContacts& contacts,
                       const std::vector<std::string>& class_names,
                       const InputSpec& spec, const Options& options)
    : contacts_(contacts),
      class_names_(class_names),
      spec_(spec),
      truth_(options.truth) {
  LabelledContact made;
  for (size_t i = 0; i < contacts.size(); ++i) {
    const LabelledContact& contact = contacts.Get(i, made);
    if (CountSteps(contact, spec.lstm_steps) == 0) continue;
    stepped_.push_back(i);
    if (!options.keep) continue;
    Rows& rows = rows_.emplace_back();
    Make(contact, options.with_targets, rows);
    sequences_.push_back(View(i, rows, false));
    if (options.with_targets) with_targets_.push_back(View(i, rows, true));
  }
}

std::unique_ptr<LstmSequenceSource> LstmInputs::Source(
    bool with_targets) const {
  if (sequences_.empty()) {
    return std::make_unique<MadeForEachBatch>(*this, with_targets);
  }
  return std::make_unique<LstmSequencesInMemory>(with_targets ? with_targets_
                                                              : sequences_);
}

size_t LstmInputs::KeptBytes(const VariedContacts& contacts, size_t inputs,
                             const StepIntervals& steps) {
  size_t count = 0;
  for (const LabelledContact* contact : contacts.originals()) {
    count += CountSteps(*contact, steps);
  }
  // A copy has at most as many frames.
  const size_t each = contacts.size() / contacts.originals().size();
  return count * each * inputs * sizeof(float);
}

void LstmInputs::Make(const LabelledContact& contact, bool with_targets,
                      Rows& rows) const {
  const size_t steps = CountSteps(contact, spec_.lstm_steps);
  rows.inputs.clear();
  rows.inputs.reserve(steps * spec_.lstm.size());
  rows.targets.clear();
  rows.labels.clear();
  if (with_targets) rows.targets.reserve(steps * kEstimateRegressions);
  std::vector<double> row(spec_.lstm.size());
  WalkCues(contact, spec_.lstm_steps, GroupsOf(spec_.lstm), &spec_.embedding,
           [&](CueTracker& cues, size_t frame) {
             MakeInput(spec_.lstm, cues, row);
             for (const double value : row) {
               rows.inputs.push_back(static_cast<float>(value));
             }
             if (truth_ == Truth::kSoFar) {
               rows.labels.push_back(ClassOf(LabelSoFar(contact, frame)));
             }
             if (!with_targets) return;
             rows.targets.push_back(
                 static_cast<float>(EncodeStiffness(contact.stiffness)));
             rows.targets.push_back(static_cast<float>(EncodeMoved(
                 contact.object_motion[frame], cues.value(Cue::kMotion))));
           });
}

LstmSequence LstmInputs::View(size_t contact, const Rows& rows,
                              bool with_targets) const {
  LstmSequence sequence = {.inputs = rows.inputs,
                           .label = ClassOf(contacts_.Original(contact).label),
                           .step_labels = rows.labels};
  if (with_targets) sequence.targets = rows.targets;
  return sequence;
}

int16_t LstmInputs::ClassOf(absl::string_view label) const {
  const auto found = std::ranges::find(class_names_, label);
  return static_cast<int16_t>(found - class_names_.begin());
}

}  // namespace tactus::internal
