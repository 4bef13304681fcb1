// File: question_outcome.h
//
// QuestionOutcome: how one contact's answers to one question went, frame by
// frame. A probability above kSure counts as an answer that a robot acts on.
//
//   const QuestionTruth truth(question, class_names, contact);
//   QuestionWatch watch(truth, question.kind);
//   WalkFrames(contact, classifier, [&](size_t frame) {
//     watch.Step(frame, classifier.value_probability(0));
//   });
//   outcome.timing = watch.Finish(contact.sample_rate_hz);
//   const QuestionSummary summary = Summarise(question, outcomes);
//
// A watch refers to the truth, which must outlive it. Not thread-safe; the rest
// is plain data and free functions without state.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/contacts/question_truth.h"
#include "core/eval/metrics.h"
#include "core/questions/question.h"

namespace tactus::internal {

inline constexpr double kSure = 0.9;
// A change that comes later than this after the onset is a late one, s. The
// more is known of a contact, the more evidence a change needs.
inline constexpr double kLateS = 1;

// When one contact's answers to one question were right. Delays are 0 for an
// answer at the very frame from which they are counted; nothing for one that
// never comes.
struct QuestionTiming {
  // The time from which delays are counted, s since onset: 0 for a property,
  // the change for a state, 0 if it came before the onset. Nothing for a state
  // that does not change, or whose history is unknown.
  std::optional<double> from_s = {};
  // Until the right value has a probability above kSure for the first time.
  std::optional<double> delay_s = {};
  // Until the most probable value stays the right one to the end.
  std::optional<double> settled_s = {};
  // A wrong value had a probability above kSure at some frame. Nothing for a
  // state that changes, or whose history is unknown.
  std::optional<bool> false_alarm = {};
  // The value after the change had it at some frame before the change.
  bool early = false;
};

class QuestionWatch {
 public:
  QuestionWatch(const QuestionTruth& truth, Question::Kind kind);

  // Takes the probabilities of the values after each frame, from 0.
  void Step(size_t frame, std::span<const double> value_probability);
  QuestionTiming Finish(double sample_rate_hz) const;

 private:
  const QuestionTruth& truth_;
  // The frame from which delays are counted.
  std::optional<size_t> from_;
  bool watched_ = false;
  std::optional<size_t> sure_;
  std::optional<size_t> settled_;
  bool alarm_ = false;
  bool early_ = false;
};

struct QuestionOutcome {
  // The right value and the probabilities, after the last frame and at each of
  // kAnytimeSeconds.
  Outcome final;
  std::vector<Outcome> anytime;
  QuestionTiming timing;
  // The first decision, and the right value at its frame.
  struct Decision {
    double seconds = 0;  // since onset
    int value = 0;
    int truth = 0;
  };
  std::optional<Decision> decision;
  // Changes of the decision; those of a property are revisions.
  uint32_t changes = 0;
};

// Quantiles of delays by nearest rank, s. A delay that is missing is longer
// than all others, so a quantile may be missing too.
struct DelaySummary {
  int count = 0;
  int missed = 0;
  std::optional<double> median;
  std::optional<double> p90;
  std::optional<double> p99;
};
DelaySummary SummariseDelays(std::vector<std::optional<double>> delays);

struct QuestionSummary {
  DelaySummary delay;
  // The same for changes later than kLateS.
  DelaySummary delay_late;
  DelaySummary settled;
  // Contacts in which an alarm would be false, and those that had one.
  int watched = 0;
  int false_alarms = 0;
  // Contacts in which the value after a change was sure before it.
  int early = 0;
  // First decisions, and those that were right at their frame.
  int made = 0;
  int right = 0;
  // Contacts whose decision was changed.
  int changed = 0;
  // The constant decision with most right ones at the same frames.
  int constant_value = 0;
  int constant_right = 0;
};
QuestionSummary Summarise(const Question& question,
                          std::span<const QuestionOutcome> outcomes);

}  // namespace tactus::internal
