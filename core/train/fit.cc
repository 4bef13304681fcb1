#include "core/train/fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/classify/contact_classifier.h"
#include "core/train/calibrate.h"
#include "core/train/fit_models.h"
#include "core/train/folds.h"

namespace tactus {
namespace {

constexpr int kMinContactsPerClass = 2;
// With more conditions than this, the contacts of a condition are too few to be
// left out together.
constexpr size_t kMaxConditions = 8;
// The models of the inner folds miss more materials than the model that is
// calibrated. The more they miss, the more they err, and the lower its
// probabilities become. Six groups leave out few materials at once.
constexpr size_t kMaterialGroups = 6;
// Fraction of a fit's time that the HMMs take where there are LSTMs too, for
// the progress.
constexpr double kHmmWeight = 0.3;

absl::Status CheckUniform(const std::vector<const LabelledContact*>& contacts) {
  const LabelledContact& first = *contacts.front();
  for (const LabelledContact* contact : contacts) {
    if (contact->layout.name != first.layout.name ||
        contact->layout.rows != first.layout.rows ||
        contact->layout.columns != first.layout.columns) {
      return InvalidTrainingData(absl::StrCat(
          "contact ", contact->id, " is from layout \"", contact->layout.name,
          "\" but contact ", first.id, " from \"", first.layout.name,
          "\"; a model is fitted to one"));
    }
    if (contact->sample_rate_hz != first.sample_rate_hz) {
      return InvalidTrainingData(absl::StrCat(
          "contact ", contact->id, " has ", contact->sample_rate_hz,
          " frames per second but contact ", first.id, " has ",
          first.sample_rate_hz, "; a model is fitted to one rate"));
    }
  }
  return absl::OkStatus();
}

absl::Status CheckContacts(const std::vector<const LabelledContact*>& contacts,
                           const std::vector<std::string>& class_names) {
  if (class_names.size() < 2 || class_names.size() > limits::kMaxClasses) {
    return InvalidTrainingData(
        absl::StrCat("the contacts have ", class_names.size(),
                     " classes; it takes 2 to ", limits::kMaxClasses));
  }
  for (const std::string& name : class_names) {
    const auto count = std::count_if(
        contacts.begin(), contacts.end(),
        [&](const LabelledContact* c) { return c->label == name; });
    if (count < kMinContactsPerClass) {
      return InvalidTrainingData(absl::StrCat("class ", name, " has ", count,
                                              " contacts; it takes ",
                                              kMinContactsPerClass));
    }
  }
  return CheckUniform(contacts);
}

// Ideal signals have no place on a skin, so they have no load profile.
absl::Status CheckCues(const std::vector<const LabelledContact*>& contacts,
                       const std::vector<Cue>& wanted,
                       const std::vector<Feature>& features) {
  const std::vector<Cue> cues = CuesFor(wanted, features);
  if (cues.empty()) {
    return InvalidConfig("features", FeaturesToString(features),
                         "some that the cues are computed from");
  }
  if (std::none_of(cues.begin(), cues.end(), IsProfileCue)) {
    return absl::OkStatus();
  }
  for (const LabelledContact* contact : contacts) {
    if (IsIdeal(*contact)) {
      return InvalidTrainingData(absl::StrCat(
          "contact ", contact->id,
          " is of ideal signals, but the load profile takes taxels of a skin"));
    }
  }
  return absl::OkStatus();
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
  auto by_condition = MakeFolds(contacts, Protocol::kLeaveOneConditionOut);
  if (by_condition.ok() && by_condition->size() <= kMaxConditions) {
    return *std::move(by_condition);
  }
  return StratifiedFolds(contacts, options.calibration_folds);
}

std::vector<const LabelledContact*> Select(
    const std::vector<const LabelledContact*>& contacts,
    const std::vector<int>& indices) {
  std::vector<const LabelledContact*> selected;
  selected.reserve(indices.size());
  for (int i : indices) selected.push_back(contacts[i]);
  return selected;
}

// Contacts and their copies, which `all` points to.
struct Varied {
  std::vector<LabelledContact> copies;
  std::vector<const LabelledContact*> all;
};

Varied WithVariations(const std::vector<const LabelledContact*>& contacts,
                      const VariationRange& range, uint64_t seed) {
  Varied varied = {DrawVariations(contacts, range, seed), contacts};
  for (const LabelledContact& copy : varied.copies) varied.all.push_back(&copy);
  return varied;
}

// The HMMs are trained without other stiffnesses. Their few components would
// have to cover them too and would fit known materials less well.
absl::StatusOr<Model> FitUncalibrated(
    const std::vector<const LabelledContact*>& contacts,
    const std::vector<std::string>& class_names, const FitOptions& options,
    const ParallelFor& parallel, const Progress& progress) {
  const int networks = options.lstm.networks;
  VariationRange range = options.variations;
  range.stiffness = 1;
  TACTUS_ASSIGN_OR_RETURN(
      Model model,
      FitHmms(WithVariations(contacts, range, options.seed).all, class_names,
              options,
              progress.Part("fit HMMs", networks > 0 ? kHmmWeight : 1)));
  if (networks > 0) {
    TACTUS_RETURN_IF_ERROR(
        FitLstms(WithVariations(contacts, options.variations, options.seed).all,
                 options, networks, parallel,
                 progress.Part("train LSTMs", 1 - kHmmWeight), model));
  }
  return model;
}

// Fits the calibration to the scores that each inner fold gets from a model of
// the other folds. A fold is not used if the others lack a class.
absl::Status Calibrate(const std::vector<const LabelledContact*>& contacts,
                       const std::vector<std::vector<int>>& folds,
                       const FitOptions& options, const ParallelFor& parallel,
                       const Progress& progress, Model& model) {
  std::vector<std::vector<ScoredContact>> scored(folds.size());
  std::vector<absl::Status> failures(folds.size());
  parallel(static_cast<int>(folds.size()), [&](int f) {
    const auto rest = Select(
        contacts, Complement(folds[f], static_cast<int>(contacts.size())));
    if (ClassNames(rest) != model.class_names) return;
    auto fitted = FitUncalibrated(
        rest, model.class_names, options, RunSerially,
        progress.Part("", 1 / static_cast<double>(folds.size())));
    if (!fitted.ok()) {
      failures[f] = fitted.status();
      return;
    }
    auto compiled = CompiledModel::Create(*std::move(fitted));
    if (!compiled.ok()) {
      failures[f] = compiled.status();
      return;
    }
    for (int i : folds[f]) {
      const auto label =
          std::find(model.class_names.begin(), model.class_names.end(),
                    contacts[i]->label) -
          model.class_names.begin();
      scored[f].push_back(
          ScoreContact(*compiled, *contacts[i], static_cast<int>(label)));
    }
  });
  std::vector<ScoredContact> all;
  for (size_t f = 0; f < folds.size(); ++f) {
    TACTUS_RETURN_IF_ERROR(failures[f]);
    std::move(scored[f].begin(), scored[f].end(), std::back_inserter(all));
  }
  if (all.empty()) {
    return InvalidTrainingData(
        "no inner fold leaves contacts of every class to calibrate with");
  }
  FitCalibration(all, contacts.front()->sample_rate_hz, model.calibration);
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
    if (frame.touched) model.warm_up.samples.push_back(frame.sample);
  }
  model.warm_up.probability.assign(model.class_names.size(), 0);
  model.warm_up.log_likelihood = model.warm_up.probability;
  TACTUS_ASSIGN_OR_RETURN(auto compiled, CompiledModel::Create(model));
  ContactClassifier classifier(compiled, {});
  for (const ContactSample& sample : model.warm_up.samples) {
    classifier.Step(sample, 0);
  }
  const auto probability = classifier.probability();
  const auto scores = classifier.log_likelihood();
  model.warm_up.probability.assign(probability.begin(), probability.end());
  model.warm_up.log_likelihood.assign(scores.begin(), scores.end());
  return absl::OkStatus();
}

}  // namespace

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
    const FitOptions& options, const ParallelFor& parallel,
    const Progress& progress) {
  if (contacts.empty()) {
    return InvalidTrainingData("there is no contact to fit to");
  }
  const std::vector<std::string> class_names = ClassNames(contacts);
  TACTUS_RETURN_IF_ERROR(CheckContacts(contacts, class_names));
  TACTUS_RETURN_IF_ERROR(
      CheckCues(contacts, options.hmm_cues, options.features));
  if (options.lstm.networks > 0) {
    TACTUS_RETURN_IF_ERROR(
        CheckCues(contacts, options.lstm.cues, options.features));
  }
  std::vector<std::vector<int>> folds;
  if (options.calibrate) folds = MakeInnerFolds(contacts, options);
  // The fits to n - 1 of n inner folds take as long as n - 1 fits to all.
  const double weight = 1 / std::max(1.0, static_cast<double>(folds.size()));
  TACTUS_ASSIGN_OR_RETURN(
      Model model, FitUncalibrated(contacts, class_names, options, parallel,
                                   progress.Part("", weight)));
  if (options.calibrate) {
    TACTUS_RETURN_IF_ERROR(Calibrate(
        contacts, folds, options, parallel,
        progress.Part("calibrate on left-out folds", 1 - weight), model));
  }
  TACTUS_RETURN_IF_ERROR(AddWarmUp(contacts, model));
  model.provenance.trials = static_cast<uint32_t>(contacts.size());
  model.provenance.seed = options.seed;
  return model;
}

}  // namespace tactus
