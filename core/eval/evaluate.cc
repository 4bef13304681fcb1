#include "core/eval/evaluate.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/classify/contact_classifier.h"
#include "core/classify/input_spec.h"
#include "core/contacts/class_counts.h"
#include "core/contacts/question_truth.h"
#include "core/eval/evaluate_nearest.h"
#include "core/features/contact_time.h"

namespace tactus::internal {
namespace {

Scorers ScorersOf(Algorithm algorithm) {
  if (algorithm == Algorithm::kHmm) return Scorers::kHmms;
  if (algorithm == Algorithm::kLstm) return Scorers::kLstms;
  return Scorers::kAll;
}

absl::StatusOr<int> LabelIndex(const std::vector<std::string>& class_names,
                               const LabelledContact& contact,
                               const std::string& label) {
  const auto found = std::ranges::find(class_names, label);
  if (found == class_names.end()) {
    return InvalidConfig(absl::StrCat("label of trial ", ContactName(contact)),
                         label, "one of the model's classes");
  }
  return static_cast<int>(found - class_names.begin());
}

// The classes so far at the anytime moments, where they can be known.
absl::Status AddLabelsSoFar(const std::vector<const LabelledContact*>& contacts,
                            Evaluation& result) {
  if (std::ranges::any_of(contacts, [](const LabelledContact* contact) {
        return contact->object_motion.empty();
      })) {
    return absl::OkStatus();
  }
  result.so_far.assign(kAnytimeCount, std::vector<int>(contacts.size()));
  for (size_t i = 0; i < contacts.size(); ++i) {
    const auto frames = AnytimeFrames(contacts[i]->sample_rate_hz);
    for (int time = 0; time < kAnytimeCount; ++time) {
      const size_t at =
          std::min<size_t>(frames[time], contacts[i]->frames.size()) - 1;
      TACTUS_ASSIGN_OR_RETURN(result.so_far[time][i],
                              LabelIndex(result.class_names, *contacts[i],
                                         LabelSoFar(*contacts[i], at)));
    }
  }
  return absl::OkStatus();
}

// An evaluation with room for all outcomes, and with their labels.
absl::StatusOr<Evaluation> PrepareEvaluation(
    const std::vector<const LabelledContact*>& contacts,
    std::vector<std::string> class_names, Algorithm algorithm) {
  Evaluation result;
  result.algorithm = algorithm;
  result.class_names = std::move(class_names);
  result.final.resize(contacts.size());
  for (size_t i = 0; i < contacts.size(); ++i) {
    TACTUS_ASSIGN_OR_RETURN(
        result.final[i].label,
        LabelIndex(result.class_names, *contacts[i], contacts[i]->label));
  }
  TACTUS_RETURN_IF_ERROR(AddLabelsSoFar(contacts, result));
  result.anytime.assign(kAnytimeCount, result.final);
  if (algorithm == Algorithm::kFused) {
    result.anytime_hmm = result.anytime;
    result.anytime_lstm = result.anytime;
  }
  result.final_estimates.resize(contacts.size());
  result.anytime_estimates.assign(kAnytimeCount, result.final_estimates);
  result.decisions.resize(contacts.size());
  result.unknown.resize(contacts.size());
  return result;
}

void Copy(std::span<const double> probability, Outcome& outcome) {
  outcome.probability.assign(probability.begin(), probability.end());
}

// Makes room for the answers to `questions`.
void PrepareQuestions(std::vector<Question> questions, size_t contacts,
                      Evaluation& result) {
  result.questions = std::move(questions);
  result.question_outcomes.assign(result.questions.size(),
                                  std::vector<QuestionOutcome>(contacts));
}

// The truths of all questions about a contact and the watches of the answers.
class WatchedQuestions {
 public:
  WatchedQuestions(const LabelledContact& contact, int index,
                   Evaluation& result)
      : contact_(contact), index_(index), result_(result) {
    // Watches refer to the truths.
    truths_.reserve(result.questions.size());
    for (const Question& question : result.questions) {
      watches_.emplace_back(
          truths_.emplace_back(question, result.class_names, contact),
          question.kind);
    }
  }

  void Step(size_t frame, const ContactClassifier& classifier) {
    for (size_t q = 0; q < watches_.size(); ++q) {
      watches_[q].Step(frame, classifier.value_probability(q));
      const QuestionDecision& decision = classifier.decisions()[q];
      if (EventAt(decision, classifier.frames()) != DecisionEvent::kDecided) {
        continue;
      }
      outcome(q).decision = {
          ContactSeconds(decision.frame, contact_.sample_rate_hz),
          decision.value, truths_[q].at(frame)};
    }
  }

  // At the next of kAnytimeSeconds.
  void RecordTime(const ContactClassifier& classifier) {
    for (size_t q = 0; q < watches_.size(); ++q) {
      outcome(q).anytime.push_back(AnswerOf(q, classifier));
    }
  }

  void Finish(const ContactClassifier& classifier) {
    for (size_t q = 0; q < watches_.size(); ++q) {
      outcome(q).final = AnswerOf(q, classifier);
      outcome(q).timing = watches_[q].Finish(contact_.sample_rate_hz);
      outcome(q).changes = classifier.decisions()[q].changes;
    }
  }

 private:
  QuestionOutcome& outcome(size_t q) {
    return result_.question_outcomes[q][index_];
  }
  Outcome AnswerOf(size_t q, const ContactClassifier& classifier) const {
    const auto probability = classifier.value_probability(q);
    return {truths_[q].at(classifier.frames() - 1),
            {probability.begin(), probability.end()}};
  }

  const LabelledContact& contact_;
  const int index_;
  Evaluation& result_;
  std::vector<QuestionTruth> truths_;
  std::vector<QuestionWatch> watches_;
};

// Classifies one contact and writes its outcomes at place `index`.
void EvaluateContact(const std::shared_ptr<const CompiledModel>& model,
                     const LabelledContact& contact, int index,
                     Evaluation& result) {
  ContactClassifier classifier(model, {.scorers = ScorersOf(result.algorithm)});
  const auto record = [&](Outcome& outcome,
                          std::optional<EstimateOutcome>& estimate) {
    Copy(classifier.probability(), outcome);
    if (classifier.object() && !contact.object_motion.empty()) {
      estimate = {*classifier.object(), std::log10(contact.stiffness),
                  contact.object_motion[classifier.frames() - 1]};
    }
  };
  WatchedQuestions questions(contact, index, result);
  WalkContact(
      contact, classifier,
      [&](int time) {
        record(result.anytime[time][index],
               result.anytime_estimates[time][index]);
        questions.RecordTime(classifier);
        if (result.algorithm != Algorithm::kFused) return;
        Copy(classifier.hmm_probability(), result.anytime_hmm[time][index]);
        Copy(classifier.lstm_probability(), result.anytime_lstm[time][index]);
      },
      [&](size_t frame) { questions.Step(frame, classifier); });
  questions.Finish(classifier);
  record(result.final[index], result.final_estimates[index]);
  if (const auto& decision = classifier.decision()) {
    const std::string label = result.truth == Truth::kSoFar
                                  ? LabelSoFar(contact, decision->frame - 1)
                                  : contact.label;
    result.decisions[index] = {
        ContactSeconds(decision->frame, contact.sample_rate_hz),
        result.class_names[decision->class_index] == label};
  }
  result.unknown[index] = classifier.unknown();
}

absl::Status EvaluateFold(const std::vector<const LabelledContact*>& contacts,
                          const std::vector<int>& fold,
                          const FitOptions& options, const Progress& progress,
                          Evaluation& result) {
  std::vector<const LabelledContact*> rest;
  for (int i : Complement(fold, static_cast<int>(contacts.size()))) {
    rest.push_back(contacts[i]);
  }
  TACTUS_ASSIGN_OR_RETURN(Model model,
                          FitModel(rest, options, RunSerially, progress));
  TACTUS_ASSIGN_OR_RETURN(auto compiled,
                          CompiledModel::Create(std::move(model)));
  for (int i : fold) {
    EvaluateContact(compiled, *contacts[i], i, result);
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<Evaluation> EvaluateModel(
    const std::shared_ptr<const CompiledModel>& model,
    const std::vector<const LabelledContact*>& contacts, Algorithm algorithm,
    const ParallelFor& parallel, const Progress& progress) {
  if (algorithm == Algorithm::kNearest) {
    return InvalidConfig("algorithm", "1nn",
                         "hmm, lstm or fused with a model bundle");
  }
  if (algorithm == Algorithm::kLstm && model->lstms().empty()) {
    return InvalidConfig("algorithm", "lstm",
                         "hmm or fused: the bundle holds no LSTM");
  }
  if (NeedsSkin(model->model()) &&
      std::any_of(
          contacts.begin(), contacts.end(),
          [](const LabelledContact* contact) { return IsIdeal(*contact); })) {
    return InvalidConfig("data", "ideal signals",
                         "taxels: the model sees the whole skin");
  }
  if (model->lstms().empty()) algorithm = Algorithm::kHmm;
  TACTUS_ASSIGN_OR_RETURN(
      Evaluation result,
      PrepareEvaluation(contacts, model->model().class_names, algorithm));
  result.truth = model->model().truth;
  PrepareQuestions(model->questions(), contacts.size(), result);
  const Progress walk = progress.Part("classify contacts", 1);
  parallel(static_cast<int>(contacts.size()), [&](int i) {
    EvaluateContact(model, *contacts[i], i, result);
    walk.Add(1 / static_cast<double>(contacts.size()));
  });
  return result;
}

absl::StatusOr<Evaluation> EvaluateProtocol(
    const std::vector<const LabelledContact*>& contacts, Protocol protocol,
    Algorithm algorithm, const FitOptions& options, const ParallelFor& parallel,
    const Progress& progress) {
  if (algorithm == Algorithm::kLstm && options.lstm.networks == 0) {
    return InvalidConfig("algorithm", "lstm",
                         "hmm or 1nn where no LSTM is trained");
  }
  if (algorithm == Algorithm::kFused) {
    algorithm = ServedAlgorithm(options.lstm.networks > 0);
  }
  FitOptions fit = options;
  if (algorithm == Algorithm::kHmm) fit.lstm.networks = 0;
  if (protocol.kind == Protocol::kLeaveOneMaterialOut &&
      fit.inner_folds == InnerFolds::kConditions) {
    fit.inner_folds = InnerFolds::kMaterials;
  }
  TACTUS_ASSIGN_OR_RETURN(const auto folds, MakeFolds(contacts, protocol));
  if (algorithm != Algorithm::kNearest) {
    // The folds ask for more contacts of a class than a fit does.
    TACTUS_RETURN_IF_ERROR(CheckFolds(contacts, folds, protocol));
    TACTUS_RETURN_IF_ERROR(CheckClasses(CountClasses(contacts), "contacts"));
  }
  TACTUS_ASSIGN_OR_RETURN(
      Evaluation result,
      PrepareEvaluation(contacts, ClassNames(contacts), algorithm));
  result.truth = options.truth;
  if (algorithm != Algorithm::kNearest) {
    TACTUS_ASSIGN_OR_RETURN(std::vector<Question> questions,
                            QuestionsOf(options, result.class_names));
    PrepareQuestions(std::move(questions), contacts.size(), result);
  }
  std::vector<absl::Status> failures(folds.size());
  const Progress fold_progress =
      progress.Part("fit and test folds", 1)
          .Part("", 1 / static_cast<double>(folds.size()));
  parallel(static_cast<int>(folds.size()), [&](int f) {
    if (algorithm == Algorithm::kNearest) {
      failures[f] =
          EvaluateNearestFold(contacts, folds[f], fit.features, result);
      fold_progress.Add(1);
    } else {
      failures[f] =
          EvaluateFold(contacts, folds[f], fit, fold_progress, result);
    }
  });
  for (const absl::Status& failure : failures) {
    TACTUS_RETURN_IF_ERROR(failure);
  }
  return result;
}

}  // namespace tactus::internal
