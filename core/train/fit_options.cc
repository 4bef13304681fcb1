#include "core/train/fit_options.h"

#include <algorithm>
#include <vector>

#include "core/base/errors.h"

namespace tactus::internal {
namespace {

// Section "Algorithm Parameters".
FitOptions PaperPreset() {
  FitOptions options;
  options.log_features = false;
  options.score = Score::kViterbi;
  LstmFit& lstm = options.lstm;
  lstm.networks = 1;
  lstm.scaling = Scaling::kMinMax;
  lstm.activation = Activation::kSoftsign;
  lstm.gate_activation = GateActivation::kHardSigmoid;
  return options;
}

// The cues, and those of shear.
std::vector<Cue> WithShear(std::vector<Cue> cues) {
  const std::vector<Cue> shear = CuesOfGroup("shear");
  cues.insert(cues.end(), shear.begin(), shear.end());
  return cues;
}

FitOptions TunedPreset() {
  FitOptions options;
  options.hmm_cues =
      WithShear({NamedCue("log_drag"), NamedCue("log_motion"),
                 NamedCue("log_area"), NamedCue("log_slope"),
                 NamedCue("log_slope_misfit"), NamedCue("force_ripple_long"),
                 NamedCue("motion_ripple_long"), NamedCue("log_spring"),
                 NamedCue("log_spring_misfit"), NamedCue("force_drop")});
  options.hmm_steps = {5, 20};
  options.hmms_per_class = 20;
  options.states = 6;
  options.covariance_floor = 0.1;
  options.variations = {.copies = 4, .pace = 3, .load = 2, .stiffness = 5};
  LstmFit& lstm = options.lstm;
  lstm.networks = 1;
  lstm.cues = WithShear(StandardCues());
  lstm.limit = 5;
  lstm.stretched_cues = {NamedCue("log_spring"),
                         NamedCue("log_stiffest_spring"), NamedCue("log_slope"),
                         NamedCue("log_stiffness"), NamedCue("log_drag")};
  lstm.stretches = 8;
  lstm.steps = {5, 20};
  lstm.estimates = true;
  LstmTrainOptions& training = lstm.training;
  training.epochs = 10;
  training.batch_size = 16;
  training.optimizer.optimizer = Optimizer::kAdam;
  training.optimizer.learning_rate = 3e-3;
  training.optimizer.weight_decay = 1e-3;
  training.optimizer.gradient_clip = 1;
  training.cosine_decay = true;
  training.loss.steps = LstmLoss::kEveryStep;
  training.loss.regression_weight = 1;
  training.noise = {.dropout = 0.2, .input = 0.05};
  return options;
}

FitOptions WorldPreset() {
  FitOptions options = TunedPreset();
  options.variations = {};
  options.truth = Truth::kSoFar;
  options.held_out = 0.1;
  options.hmms_per_class = 4;
  options.hmm_steps = {10, 40};
  options.lstm.steps = {.min = 5, .max = 50, .first = 1, .divisor = 8};
  options.lstm.estimator_cells = {24, 24};
  options.lstm.training.epochs = 12;
  options.lstm.training.batch_size = 32;
  return options;
}

// Where on the skin the load is, by HMMs alone (research/recordings.md).
FitOptions ProfilePreset() {
  FitOptions options;
  options.hmm_cues = WithShear(CuesOfGroup("load_profile"));
  options.log_features = false;
  options.states = 3;
  options.hmms_per_class = 8;
  options.max_iterations = 10;
  options.covariance_floor = 0.03;
  return options;
}

// LSTMs for recordings of a skin. None by default: with a few hundred contacts
// the HMMs alone did better.
LstmFit RecordingsLstm(std::vector<Cue> cues) {
  LstmFit lstm = TunedPreset().lstm;
  lstm.networks = 0;
  lstm.cues = std::move(cues);
  lstm.stretched_cues.clear();
  lstm.stretches = 0;
  lstm.estimates = false;
  lstm.training.epochs = 60;
  lstm.training.noise = {.dropout = 0.3, .input = 0.3};
  return lstm;
}

// Which taxels are loaded, and how that changes.
FitOptions PatternPreset() {
  FitOptions options = ProfilePreset();
  options.hmm_cues = WithShear(CuesOfGroup("embedding"));
  options.lstm = RecordingsLstm(WithShear(CuesOfGroup("embedding")));
  return options;
}

// The whole skin, wherever it is touched.
FitOptions WholeSkinPreset() {
  FitOptions options = ProfilePreset();
  options.hmm_cues =
      WithShear({NamedCue("skin_force"), NamedCue("skin_taxels"),
                 NamedCue("skin_peak_share"), NamedCue("skin_spread"),
                 NamedCue("skin_change_short"), NamedCue("skin_change_long"),
                 NamedCue("skin_travel")});
  options.lstm = RecordingsLstm(WithShear(CuesOfGroup("whole_skin")));
  return options;
}

// Few recordings of one skin. It leaves the motion out, so that streams may
// have poses or not.
FitOptions RidgePreset() {
  FitOptions options;
  options.learner = Learner::kRidge;
  options.features = {Feature::kForce};
  options.hmm_steps = {.min = 5, .max = 50, .first = 1, .divisor = 8};
  options.inner_folds = InnerFolds::kChoice;
  options.lstm = RecordingsLstm(WithShear(CuesOfGroup("whole_skin")));
  return options;
}

// As the ridge, by another learner of all taxels.
FitOptions TaxelsPreset(Learner learner) {
  FitOptions options = RidgePreset();
  options.learner = learner;
  return options;
}

}  // namespace

Learner LearnerOf(const Model& model) {
  if (model.ridge) return Learner::kRidge;
  if (model.trees) return Learner::kTrees;
  return model.nearest ? Learner::kNearest : Learner::kHmms;
}

absl::StatusOr<FitOptions> FitPreset(absl::string_view name) {
  if (name == "tuned") return TunedPreset();
  if (name == "paper") return PaperPreset();
  if (name == "world") return WorldPreset();
  if (name == "profile") return ProfilePreset();
  if (name == "ridge") return RidgePreset();
  if (name == "trees") return TaxelsPreset(Learner::kTrees);
  if (name == "nearest") return TaxelsPreset(Learner::kNearest);
  if (name == "pattern") return PatternPreset();
  if (name == "whole-skin") return WholeSkinPreset();
  return InvalidConfig("preset", name,
                       "tuned, world, paper, ridge, trees, nearest, pattern, "
                       "whole-skin or profile");
}

std::vector<Cue> CuesFor(const std::vector<Cue>& cues,
                         const std::vector<Feature>& features) {
  std::vector<Cue> usable;
  if (cues.empty()) {
    for (Feature feature : features) usable.push_back(RawCue(feature));
    return usable;
  }
  auto known = [&](Cue cue) {
    for (int f = 0; f < kFeatureCount; ++f) {
      const Feature feature = static_cast<Feature>(f);
      if (NeedsFeature(cue, feature) &&
          std::find(features.begin(), features.end(), feature) ==
              features.end()) {
        return false;
      }
    }
    return true;
  };
  std::copy_if(cues.begin(), cues.end(), std::back_inserter(usable), known);
  return usable;
}

FitOptions SuitedToAxes(const FitOptions& options,
                        const std::vector<const LabelledContact*>& contacts) {
  FitOptions suited = options;
  const bool all_feel = std::ranges::all_of(
      contacts, [](const auto* contact) { return contact->layout.axes == 3; });
  if (all_feel) return suited;
  for (std::vector<Cue>* cues :
       {&suited.hmm_cues, &suited.lstm.cues, &suited.lstm.stretched_cues}) {
    std::vector<Cue> others = *cues;
    std::erase_if(others,
                  [](Cue cue) { return (SourcesOf(cue) & kFromShear) != 0; });
    // No cues would stand for the features.
    if (!others.empty()) *cues = std::move(others);
  }
  return suited;
}

absl::StatusOr<std::vector<Question>> QuestionsOf(
    const FitOptions& options, const std::vector<std::string>& class_names) {
  if (options.questions.class_names.empty()) {
    return DefaultQuestions(class_names);
  }
  return QuestionsFor(options.questions, class_names);
}

bool UsesWholeSkin(const FitOptions& options) {
  const auto of_skin = [](Cue cue) {
    return (SourcesOf(cue) & (kFromTaxels | kFromProfile)) != 0;
  };
  return options.learner != Learner::kHmms ||
         std::ranges::any_of(options.hmm_cues, of_skin) ||
         (options.lstm.networks > 0 &&
          (std::ranges::any_of(options.lstm.cues, of_skin) ||
           std::ranges::any_of(options.lstm.stretched_cues, of_skin)));
}

}  // namespace tactus::internal
