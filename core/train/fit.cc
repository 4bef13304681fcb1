#include "core/train/fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <memory>
#include <span>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/classify/warm_up.h"
#include "core/contacts/choice_folds.h"
#include "core/contacts/class_counts.h"
#include "core/contacts/folds.h"
#include "core/contacts/trained_on.h"
#include "core/train/calibrate.h"
#include "core/train/fit_all.h"
#include "core/train/fit_decisions.h"
#include "core/train/measure_skin_range.h"
#include "core/train/model_fit.h"
#include "core/train/share_work.h"
#include "core/train/usable.h"

namespace tactus::internal {
namespace {

// With more conditions than this, the contacts of a condition are too few to be
// left out together.
constexpr size_t kMaxConditions = 8;
// The models of the inner folds miss more materials than the model that is
// calibrated. The more they miss, the more they err, and the lower its
// probabilities become. Six groups leave out few materials at once.
constexpr size_t kMaterialGroups = 6;
// Fraction of a fit's time, for the progress.
constexpr double kScoringWeight = 0.03;

absl::Status CheckUniform(const std::vector<const LabelledContact*>& contacts) {
  const LabelledContact& first = *contacts.front();
  for (const LabelledContact* contact : contacts) {
    if (contact->layout.name != first.layout.name ||
        contact->layout.rows != first.layout.rows ||
        contact->layout.columns != first.layout.columns) {
      return InvalidTrainingData(absl::StrCat(
          "contact ", ContactName(*contact), " is from layout \"",
          contact->layout.name, "\" but contact ", ContactName(first),
          " from \"", first.layout.name, "\"; a model is fitted to one"));
    }
    if (contact->sample_rate_hz != first.sample_rate_hz) {
      return InvalidTrainingData(absl::StrCat(
          "contact ", ContactName(*contact), " has ", contact->sample_rate_hz,
          " frames per second but contact ", ContactName(first), " has ",
          first.sample_rate_hz, "; a model is fitted to one rate"));
    }
  }
  return absl::OkStatus();
}

absl::Status CheckContacts(
    const std::vector<const LabelledContact*>& contacts) {
  TACTUS_RETURN_IF_ERROR(CheckClasses(CountClasses(contacts), "contacts"));
  return CheckUniform(contacts);
}

// Motion from poses and motion of a centroid are two things.
absl::Status CheckPoses(const std::vector<const LabelledContact*>& contacts,
                        const std::vector<Feature>& features) {
  if (std::ranges::count(features, Feature::kMotion) == 0) {
    return absl::OkStatus();
  }
  const LabelledContact& first = *contacts.front();
  for (const LabelledContact* contact : contacts) {
    if (contact->with_poses == first.with_poses) continue;
    return InvalidTrainingData(absl::StrCat(
        "contact ", ContactName(*contact), " has ",
        contact->with_poses ? "" : "no ", "poses but contact ",
        ContactName(first), first.with_poses ? " has some" : " has none",
        "; a model that uses the motion is fitted to one or the other"));
  }
  return absl::OkStatus();
}

// What the model demands of the skins that it will serve.
void SetRequirements(const std::vector<const LabelledContact*>& contacts,
                     const std::vector<Feature>& features, Model& model) {
  for (const LabelledContact* contact : contacts) {
    const bool known =
        contact->layout == model.layout ||
        std::ranges::count(model.more_layouts, contact->layout) > 0;
    if (!known) model.more_layouts.push_back(contact->layout);
  }
  if (std::ranges::count(features, Feature::kMotion) == 0) return;
  model.poses =
      contacts.front()->with_poses ? PoseNeed::kNeeded : PoseNeed::kIgnored;
}

// Learners without cues see taxels alone.
absl::Status CheckTaxels(const std::vector<const LabelledContact*>& contacts,
                         const FitOptions& options) {
  if (options.variations.copies > 0) {
    return InvalidConfig("copies", options.variations.copies,
                         "0 with a learner that sees taxels");
  }
  for (const LabelledContact* contact : contacts) {
    if (IsIdeal(*contact)) {
      return InvalidTrainingData(absl::StrCat(
          "contact ", ContactName(*contact),
          " is of ideal signals, but the learner takes taxels of a skin"));
    }
  }
  return absl::OkStatus();
}

// Ideal signals have no taxels, so they have no load profile. Copies of
// contacts have none either.
absl::Status CheckCues(const std::vector<const LabelledContact*>& contacts,
                       const std::vector<Cue>& wanted,
                       const FitOptions& options) {
  const std::vector<Cue> cues = CuesFor(wanted, options.features);
  if (cues.empty()) {
    return InvalidConfig("features", FeaturesToString(options.features),
                         "some that the cues are computed from");
  }
  const bool taxels = std::ranges::any_of(
      cues, [](Cue cue) { return (SourcesOf(cue) & kFromTaxels) != 0; });
  if (taxels && options.variations.copies > 0) {
    return InvalidConfig("copies", options.variations.copies,
                         "0 with cues that are made from taxels");
  }
  const auto of_skin = [](Cue cue) { return SourcesOf(cue) != 0; };
  if (std::ranges::none_of(cues, of_skin)) return absl::OkStatus();
  for (const LabelledContact* contact : contacts) {
    if (IsIdeal(*contact)) {
      return InvalidTrainingData(absl::StrCat(
          "contact ", ContactName(*contact),
          " is of ideal signals, but the cues take taxels of a skin"));
    }
  }
  return absl::OkStatus();
}

std::vector<const LabelledContact*> Select(
    const std::vector<const LabelledContact*>& contacts,
    const std::vector<int>& indices) {
  std::vector<const LabelledContact*> selected;
  selected.reserve(indices.size());
  for (int i : indices) selected.push_back(contacts[i]);
  return selected;
}

// True if some fold leaves contacts of every class.
bool AnyLeavesEveryClass(const std::vector<const LabelledContact*>& contacts,
                         const std::vector<std::vector<int>>& folds) {
  const size_t classes = CountClasses(contacts).size();
  return std::ranges::any_of(folds, [&](const std::vector<int>& fold) {
    const auto rest =
        Select(contacts, Complement(fold, static_cast<int>(contacts.size())));
    return CountClasses(rest).size() == classes;
  });
}

// Folds by robot condition or by material if there are several but not too
// many, so that the calibration includes the cost of a new one; else stratified
// folds.
std::vector<std::vector<int>> MakeInnerFolds(
    const std::vector<const LabelledContact*>& contacts,
    const FitOptions& options) {
  if (options.inner_folds == InnerFolds::kMaterials) {
    auto by_material = MakeFolds(contacts, Protocol::kLeaveOneMaterialOut);
    if (by_material.ok()) {
      std::vector<std::vector<int>> groups(
          std::min(by_material->size(), kMaterialGroups));
      for (size_t f = 0; f < by_material->size(); ++f) {
        auto& group = groups[f % groups.size()];
        group.insert(group.end(), (*by_material)[f].begin(),
                     (*by_material)[f].end());
      }
      return groups;
    }
  }
  if (options.inner_folds == InnerFolds::kChoice) {
    ChoiceFolds folds = FoldsForChoice(contacts);
    if (folds.by != FoldsBy::kClasses) return std::move(folds.folds);
    return StratifiedFolds(contacts, options.calibration_folds);
  }
  auto by_condition = MakeFolds(contacts, Protocol::kLeaveOneConditionOut);
  if (by_condition.ok() && by_condition->size() <= kMaxConditions &&
      AnyLeavesEveryClass(contacts, *by_condition)) {
    return *std::move(by_condition);
  }
  return StratifiedFolds(contacts, options.calibration_folds);
}

// An inner fold: the models of the other contacts, and the scores that they
// give to its contacts.
struct Fold {
  std::string prefix;
  std::vector<int> contacts;
  // Empty if a class has no contact outside of the fold.
  std::unique_ptr<ModelFit> fit;
  std::shared_ptr<const CompiledModel> model;
  std::vector<ScoredContact> scores;
};

// The contacts that a model is fitted to, and those it is calibrated with.
struct HeldOut {
  std::vector<int> fitted;
  std::vector<int> left_out;  // empty: inner folds
};

HeldOut HoldOut(const std::vector<const LabelledContact*>& contacts,
                const FitOptions& options) {
  const int count = static_cast<int>(contacts.size());
  HeldOut held;
  if (options.calibrate && options.held_out > 0) {
    const int parts =
        std::max(2, static_cast<int>(std::lround(1 / options.held_out)));
    held.left_out = StratifiedFolds(contacts, parts).front();
  }
  held.fitted = Complement(held.left_out, count);
  return held;
}

// Half of the folds have enough estimates for the calibration if all materials
// are in each of them. With four folds, one for each pair of two stiffnesses
// and two speeds of the arm, each stiffness and each speed is in one of the
// folds 0 and 3. Folds by material need all estimates, because the softest
// material is in one of them.
ModelFit::Networks FoldNetworks(const FitOptions& options, size_t fold) {
  const bool in_half = fold % 4 == 0 || fold % 4 == 3;
  return {
      .lstms = options.lstm.networks,
      .estimator = in_half || options.inner_folds == InnerFolds::kMaterials};
}

absl::StatusOr<std::vector<Fold>> MakeFoldFits(
    const std::vector<const LabelledContact*>& contacts, const FitRun& run) {
  std::vector<Fold> folds;
  for (std::vector<int>& fold : MakeInnerFolds(contacts, run.options)) {
    const std::vector<const LabelledContact*> rest =
        Select(contacts, Complement(fold, static_cast<int>(contacts.size())));
    const bool whole = ClassNames(rest) == run.class_names;
    Fold& made = folds.emplace_back();
    made.prefix = absl::StrCat("fold/", folds.size() - 1, "/");
    made.contacts = std::move(fold);
    if (!whole) continue;
    TACTUS_ASSIGN_OR_RETURN(auto scores,
                            run.saved.Find<std::vector<ScoredContact>>(
                                absl::StrCat(made.prefix, "scores")));
    if (scores) made.scores = *std::move(scores);
    made.fit = std::make_unique<ModelFit>(
        run, made.prefix, FoldNetworks(run.options, folds.size() - 1), rest);
  }
  return folds;
}

// How well a fold's models do at the end of the contacts, before calibration.
LearningPoint PointOf(const Fold& fold, int number, size_t folds) {
  LearningPoint point = {.phase = "calibrate on left-out folds",
                         .part = absl::StrCat("fold/", number),
                         .iteration = number + 1,
                         .max_iterations = static_cast<int>(folds)};
  const HeldOutSkill skill = SkillOf(fold.scores);
  point.validation_loss = skill.loss;
  point.validation_accuracy = skill.accuracy;
  return point;
}

// Compiles the models of all folds, and scores the contacts of those that have
// no scores yet.
absl::Status ScoreFolds(const std::vector<const LabelledContact*>& contacts,
                        const std::vector<double>& frames,
                        const ParallelFor& parallel, const Progress& progress,
                        const FitRun& run, std::vector<Fold>& folds) {
  std::vector<std::pair<Fold*, int>> tasks;
  std::vector<bool> had_scores;
  for (Fold& fold : folds) {
    had_scores.push_back(!fold.scores.empty());
    if (fold.fit != nullptr) {
      TACTUS_ASSIGN_OR_RETURN(fold.model,
                              CompiledModel::Create(fold.fit->TakeModel()));
    }
    if (fold.model == nullptr || had_scores.back()) continue;
    for (size_t i = 0; i < fold.contacts.size(); ++i) {
      tasks.emplace_back(&fold, static_cast<int>(i));
    }
  }
  const Progress scoring =
      progress.Part("calibrate on left-out folds", kScoringWeight);
  std::vector<ScoredContact> scores(tasks.size());
  TACTUS_RETURN_IF_ERROR(ShareWork(run, parallel, scores, [&](int t) {
    TACTUS_RETURN_IF_ERROR(run.GoOn());
    const auto [fold, i] = tasks[t];
    scores[t] = ScoreContact(fold->model, *contacts[fold->contacts[i]], frames);
    scoring.Add(1 / static_cast<double>(tasks.size()));
    return absl::OkStatus();
  }));
  for (size_t t = 0; t < tasks.size(); ++t) {
    tasks[t].first->scores.push_back(std::move(scores[t]));
  }
  for (size_t f = 0; f < folds.size(); ++f) {
    if (folds[f].model == nullptr || had_scores[f] || !run.IsFirst()) {
      continue;
    }
    TACTUS_RETURN_IF_ERROR(run.saved.Put(
        absl::StrCat(folds[f].prefix, "scores"), folds[f].scores));
    run.Report(PointOf(folds[f], static_cast<int>(f), folds.size()));
  }
  return absl::OkStatus();
}

// A fold's model with the calibration of the whole one, which may have an
// estimator where the fold's has none.
absl::StatusOr<std::shared_ptr<const CompiledModel>> Calibrated(
    const Fold& fold, const Calibration& calibration) {
  Model model = fold.model->model();
  model.calibration = calibration;
  if (!model.estimator) model.calibration.softest.clear();
  return CompiledModel::Create(std::move(model));
}

// Fits the thresholds of decisions to those that the calibrated models of the
// folds make on the contacts that they were not fitted to.
absl::Status FitQuestions(const std::vector<const LabelledContact*>& contacts,
                          const ParallelFor& parallel, const FitRun& run,
                          const std::vector<Fold>& folds, Model& model) {
  std::vector<
      std::pair<std::shared_ptr<const CompiledModel>, const LabelledContact*>>
      tasks;
  for (const Fold& fold : folds) {
    if (fold.model == nullptr) continue;
    TACTUS_ASSIGN_OR_RETURN(const auto calibrated,
                            Calibrated(fold, model.calibration));
    for (const int i : fold.contacts) {
      tasks.emplace_back(calibrated, contacts[i]);
    }
  }
  std::vector<TriedDecisions> tried(tasks.size());
  TACTUS_RETURN_IF_ERROR(ShareWork(run, parallel, tried, [&](int t) {
    TACTUS_RETURN_IF_ERROR(run.GoOn());
    tried[t] = TryDecisions(tasks[t].first, *tasks[t].second);
    return absl::OkStatus();
  }));
  FitDecisions(tried, model.calibration);
  return absl::OkStatus();
}

// Fits the calibration to the scores that each inner fold gets from the models
// of the other folds.
absl::Status Calibrate(const FitOptions& options,
                       const std::vector<double>& frames,
                       std::vector<Fold>& folds, Model& model) {
  std::vector<ScoredContact> all;
  for (Fold& fold : folds) {
    std::ranges::move(fold.scores, std::back_inserter(all));
  }
  if (all.empty()) {
    return InvalidTrainingData(
        "no inner fold leaves contacts of every class to calibrate with; "
        "record each class in several conditions, or of several materials");
  }
  // The contacts of a fold may all have a known stiffness when others do not.
  if (!model.estimator) {
    for (ScoredContact& contact : all) contact.log10_stiffness.clear();
  }
  FitCalibration(all, frames, model.calibration);
  if (options.inner_folds == InnerFolds::kChoice) {
    HoldTheBestAnswer(all, model.calibration);
  }
  if (options.shares == ClassShares::kEven) {
    PresumeEvenShares(all, model.calibration);
  }
  return absl::OkStatus();
}

// Adds the self-test: the contact of median length and its answers.
absl::Status AddWarmUp(const std::vector<const LabelledContact*>& contacts,
                       Model& model) {
  std::vector<const LabelledContact*> sorted = contacts;
  std::stable_sort(sorted.begin(), sorted.end(), [](auto* a, auto* b) {
    return a->frames.size() < b->frames.size();
  });
  constexpr size_t kMaxFrames = 120;
  for (const ContactFrame& frame : sorted[sorted.size() / 2]->frames) {
    if (model.warm_up.samples.size() == kMaxFrames) break;
    if (!frame.touched) continue;
    WarmUpTrial& trial = model.warm_up;
    trial.samples.push_back(frame.sample);
    trial.samples.back().loads = {};
    if (TaxelsNeeded(model) == 0) continue;
    std::span<const TaxelLoad> loads = frame.sample.loads;
    if (!NeedsComponents(model)) {
      loads = WithoutComponents(loads, TaxelsNeeded(model));
    }
    trial.loads.insert(trial.loads.end(), loads.begin(), loads.end());
    trial.load_ends.push_back(static_cast<uint32_t>(trial.loads.size()));
  }
  return AnswerWarmUp(model);
}

}  // namespace

std::vector<double> FramesToCalibrate(
    const std::vector<const LabelledContact*>& contacts,
    const FitOptions& options, const InputSpec& inputs) {
  size_t longest = 0;
  if (options.inner_folds == InnerFolds::kChoice) {
    for (const LabelledContact* contact : contacts) {
      longest = std::max(longest, contact->frames.size());
    }
  }
  return CalibrationFrames(inputs.sample_rate_hz, inputs.lstm_steps, longest);
}

std::vector<std::string> ClassNames(
    const std::vector<const LabelledContact*>& contacts) {
  constexpr std::array<const char*, 4> kFirst = {"HU", "HM", "SU", "SM"};
  std::map<std::string, bool> seen;
  for (const LabelledContact* contact : contacts) seen[contact->label] = true;
  std::vector<std::string> names;
  for (const char* name : kFirst) {
    if (seen.erase(name) > 0) names.emplace_back(name);
  }
  for (const auto& [name, present] : seen) names.push_back(name);
  return names;
}

absl::StatusOr<Model> FitModel(
    const std::vector<const LabelledContact*>& contacts,
    const FitOptions& given, const ParallelFor& parallel,
    const Progress& progress, FitJournal* journal, const ParallelFor& start,
    Ranks* ranks) {
  TACTUS_RETURN_IF_ERROR(CheckContacts(contacts));
  const FitOptions options = SuitedToAxes(given, contacts);
  const std::vector<std::string> class_names = ClassNames(contacts);
  TACTUS_RETURN_IF_ERROR(options.learner != Learner::kHmms
                             ? CheckTaxels(contacts, options)
                             : CheckCues(contacts, options.hmm_cues, options));
  if (options.lstm.networks > 0) {
    TACTUS_RETURN_IF_ERROR(CheckCues(contacts, options.lstm.cues, options));
  }
  TACTUS_RETURN_IF_ERROR(CheckPoses(contacts, options.features));
  TACTUS_RETURN_IF_ERROR(CheckUsable(contacts, options));
  TACTUS_ASSIGN_OR_RETURN(const std::vector<Question> questions,
                          QuestionsOf(options, class_names));
  const SavedParts saved(journal, contacts, options);
  OneRank alone;
  const FitRun run = {.options = options,
                      .class_names = class_names,
                      .questions = questions,
                      .journal = journal,
                      .saved = saved,
                      .ranks = ranks == nullptr ? alone : *ranks};
  const HeldOut held = HoldOut(contacts, options);
  const auto fitted = Select(contacts, held.fitted);
  if (ClassNames(fitted) != class_names) {
    return InvalidTrainingData(
        "the contacts that are not held out lack a class; record more of each, "
        "or fit with --preset=tuned, which holds none out");
  }
  ModelFit whole(run, "", {.lstms = options.lstm.networks}, fitted);
  std::vector<Fold> folds;
  if (options.calibrate && held.left_out.empty()) {
    TACTUS_ASSIGN_OR_RETURN(folds, MakeFoldFits(contacts, run));
  }
  std::vector<ModelFit*> fits = {&whole};
  for (const Fold& fold : folds) {
    if (fold.fit != nullptr) fits.push_back(fold.fit.get());
  }
  TACTUS_RETURN_IF_ERROR(FitAll(run, contacts, fits, start ? start : parallel,
                                parallel, progress));
  Model model = whole.TakeModel();
  if (!held.left_out.empty()) {
    TACTUS_ASSIGN_OR_RETURN(auto compiled, CompiledModel::Create(model));
    Fold& left_out = folds.emplace_back();
    left_out.prefix = "held-out/";
    left_out.contacts = held.left_out;
    left_out.model = std::move(compiled);
  }
  const std::vector<double> frames =
      FramesToCalibrate(contacts, options, model.inputs);
  TACTUS_RETURN_IF_ERROR(
      ScoreFolds(contacts, frames, parallel, progress, run, folds));
  if (options.calibrate) {
    TACTUS_RETURN_IF_ERROR(Calibrate(options, frames, folds, model));
    TACTUS_RETURN_IF_ERROR(FitQuestions(contacts, parallel, run, folds, model));
  }
  SetRequirements(contacts, options.features, model);
  if (NeedsSkin(model)) model.skin_range = MeasureSkinRange(contacts);
  TACTUS_RETURN_IF_ERROR(AddWarmUp(contacts, model));
  model.provenance.trials = static_cast<uint32_t>(contacts.size());
  model.provenance.seed = options.seed;
  SetTrainedOn(contacts, model.provenance);
  return model;
}

}  // namespace tactus::internal
