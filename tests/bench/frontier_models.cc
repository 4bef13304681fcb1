#include "tests/bench/frontier_models.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <span>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/run_on_threads.h"
#include "core/base/status_macros.h"
#include "core/sim/exact/simulate_contact.h"
#include "core/sim/experiments/grid_set.h"
#include "core/sim/experiments/paper_set.h"
#include "core/train/fit.h"

namespace tactus::internal::client {
namespace {

constexpr size_t kTestContacts = 6000;
constexpr size_t kQuickTestContacts = 60;
// `quick` takes every 27th of the paper's trials: evenly over the conditions,
// and over the materials because 27 does not divide their number.
constexpr size_t kQuickStride = 27;

std::vector<TrialSpec> AllGridSpecs() {
  return DrawSpecs(UntrainedGrid().Conditions(), kTestSeed);
}

using Pair = std::vector<LabelledContact>;

// A contact and, if its object moved, its twin with the object fixed.
absl::StatusOr<Pair> SimulatePair(const TrialSpec& spec, uint64_t seed) {
  Pair pair;
  TACTUS_ASSIGN_OR_RETURN(const auto simulated, SimulateWithTwin(spec));
  for (const SimulatedContact& each : simulated) {
    TACTUS_ASSIGN_OR_RETURN(pair.emplace_back(), ContactOf(each, seed));
  }
  return pair;
}

absl::StatusOr<std::vector<LabelledContact>> Simulate(
    std::span<const TrialSpec> specs, uint64_t seed) {
  std::vector<absl::StatusOr<Pair>> pairs(specs.size());
  RunOnThreads(static_cast<int>(specs.size()),
               [&](int i) { pairs[i] = SimulatePair(specs[i], seed); });
  std::vector<LabelledContact> contacts;
  for (absl::StatusOr<Pair>& pair : pairs) {
    TACTUS_RETURN_IF_ERROR(pair.status());
    std::ranges::move(*pair, std::back_inserter(contacts));
  }
  return contacts;
}

constexpr char kFused[] = "fused";
constexpr char kHmms[] = "HMMs";
constexpr char kLstms[] = "LSTMs";

// A separate fit. Of a fit of the family kLstms, only the LSTMs are used.
struct FitJob {
  std::string family;
  std::string name;
  FitOptions options;
};

Model HmmsAlone(Model model) {
  model.lstms.clear();
  RemoveEstimator(model);
  model.inputs.lstm.clear();
  for (auto* table :
       {&model.calibration.lstm_inverse_temperature,
        &model.calibration.lstm_bias, &model.calibration.hmm_weight,
        &model.calibration.lstm_weight, &model.calibration.fused_bias}) {
    table->clear();
  }
  return model;
}

Model WithoutEstimator(Model model) {
  RemoveEstimator(model);
  return model;
}

// Every model has HMMs. These have one state that scores every class equally,
// and the longest step interval.
Model LstmsAlone(Model model) {
  const GaussianHmm indifferent = {.states = 1,
                                   .dimensions = 1,
                                   .start = {1},
                                   .transition = {1},
                                   .means = {0},
                                   .covariances = {1}};
  for (HmmMixture& mixture : model.hmms) {
    mixture = {.log_weight = {0}, .components = {indifferent}};
  }
  model.inputs.hmm.resize(1);
  model.inputs.hmm_steps = {limits::kMaxBridgedFrames,
                            limits::kMaxBridgedFrames};
  std::ranges::fill(model.calibration.hmm_weight, 0.0);
  std::ranges::fill(model.calibration.lstm_weight, 1.0);
  std::ranges::fill(model.calibration.fused_bias, 0.0);
  return model;
}

absl::StatusOr<FitOptions> TunedOptions(bool quick) {
  TACTUS_ASSIGN_OR_RETURN(FitOptions options, FitPreset("tuned"));
  options.seed = kTrainingSeed;
  if (quick) {
    options.hmms_per_class = 2;
    options.max_iterations = 2;
    options.variations.copies = 0;
    options.lstm.cells = {8};
    options.lstm.training.epochs = 1;
  }
  return options;
}

FitOptions OnlyHmms(FitOptions options, int hmms, StepIntervals steps) {
  options.calibrate = false;
  options.lstm.networks = 0;
  options.hmms_per_class = hmms;
  options.hmm_steps = steps;
  return options;
}

FitOptions OneLstm(FitOptions options, StepIntervals steps) {
  options.calibrate = false;
  options.hmms_per_class = 1;
  options.states = 1;
  options.lstm.networks = 1;
  options.lstm.estimates = false;
  options.lstm.steps = steps;
  return options;
}

FitOptions FusedAt(FitOptions options, StepIntervals steps) {
  options.lstm.networks = 1;
  options.lstm.estimates = false;
  options.hmm_steps = steps;
  options.lstm.steps = steps;
  return options;
}

std::string Hmms(int count) {
  return absl::StrCat(count, count == 1 ? " HMM" : " HMMs");
}

std::vector<FitJob> FitJobs(const FitOptions& tuned) {
  constexpr StepIntervals kEvery = {1, 1};
  constexpr StepIntervals kSlow = {10, 40};
  std::vector<FitJob> jobs;
  const int most = tuned.hmms_per_class;
  std::vector<int> numbers = {most / 2, most / 4, 1};
  numbers.erase(std::ranges::find_if(numbers, [](int n) { return n < 2; }),
                numbers.end() - 1);
  for (const int hmms : numbers) {
    jobs.push_back({kHmms, Hmms(hmms), OnlyHmms(tuned, hmms, tuned.hmm_steps)});
  }
  jobs.push_back({kHmms, Hmms(1) + " every frame", OnlyHmms(tuned, 1, kEvery)});
  jobs.push_back(
      {kHmms, Hmms(most) + " at 10-40", OnlyHmms(tuned, most, kSlow)});
  jobs.push_back({kLstms, "1 network at 10-40", OneLstm(tuned, kSlow)});
  jobs.push_back({kFused, "1 network at 10-40", FusedAt(tuned, kSlow)});
  return jobs;
}

}  // namespace

std::vector<const LabelledContact*> Pointers(
    const std::vector<LabelledContact>& contacts) {
  std::vector<const LabelledContact*> pointers;
  for (const LabelledContact& contact : contacts) pointers.push_back(&contact);
  return pointers;
}

absl::StatusOr<LabelledContact> ContactOf(const SimulatedContact& simulated,
                                          uint64_t seed) {
  TACTUS_ASSIGN_OR_RETURN(
      std::optional<LabelledContact> contact,
      ExtractContact(SignalTrial(simulated, SignalNoise(), seed)));
  if (!contact) return NumericalFailure("a simulated contact touches nothing");
  return *std::move(contact);
}

absl::StatusOr<FrontierContacts> SimulateContacts(bool quick) {
  std::vector<TrialSpec> training = TrialSpecs(PaperGrid().Conditions());
  if (quick) {
    std::vector<TrialSpec> some;
    for (size_t i = 0; i < training.size(); i += kQuickStride) {
      some.push_back(training[i]);
    }
    training = some;
  }
  FrontierContacts contacts;
  TACTUS_ASSIGN_OR_RETURN(contacts.training, Simulate(training, kTrainingSeed));
  const size_t wanted = quick ? kQuickTestContacts : kTestContacts;
  const std::vector<TrialSpec> test = AllGridSpecs();
  TACTUS_ASSIGN_OR_RETURN(contacts.test,
                          Simulate(std::span(test).first(wanted), kTestSeed));
  contacts.test.resize(wanted);
  return contacts;
}

std::vector<TrialSpec> GridSpecs(int count) {
  std::vector<TrialSpec> specs = AllGridSpecs();
  specs.resize(count);
  for (size_t i = 1; i < specs.size(); i += 2) specs[i] = FixedTwin(specs[i]);
  return specs;
}

absl::StatusOr<std::vector<ClassifierVariant>> FitVariants(
    const std::vector<LabelledContact>& contacts, bool quick) {
  const std::vector<const LabelledContact*> pointers = Pointers(contacts);
  TACTUS_ASSIGN_OR_RETURN(const FitOptions options, TunedOptions(quick));
  TACTUS_ASSIGN_OR_RETURN(const Model tuned,
                          FitModel(pointers, options, RunOnThreads));
  std::vector<ClassifierVariant> variants;
  const auto add = [&](const std::string& family, const std::string& name,
                       Model model) -> absl::Status {
    TACTUS_ASSIGN_OR_RETURN(auto compiled,
                            CompiledModel::Create(std::move(model)));
    variants.push_back(
        {.family = family, .name = name, .model = std::move(compiled)});
    return absl::OkStatus();
  };
  TACTUS_RETURN_IF_ERROR(add(kFused, "tuned", tuned));
  variants.push_back({.family = kFused,
                      .name = "nothing skipped",
                      .model = variants[kTunedVariant].model});
  for (bool& on : variants[kUnskippedVariant].skip) on = false;
  TACTUS_RETURN_IF_ERROR(
      add(kHmms, Hmms(options.hmms_per_class), HmmsAlone(tuned)));
  TACTUS_RETURN_IF_ERROR(
      add(kLstms, "1 network", LstmsAlone(WithoutEstimator(tuned))));
  TACTUS_RETURN_IF_ERROR(add(kFused, "no estimate", WithoutEstimator(tuned)));

  const std::vector<FitJob> jobs = FitJobs(options);
  std::vector<absl::StatusOr<Model>> fitted(jobs.size());
  RunOnThreads(static_cast<int>(jobs.size()), [&](int i) {
    fitted[i] = FitModel(pointers, jobs[i].options, RunSerially);
  });
  for (size_t i = 0; i < jobs.size(); ++i) {
    TACTUS_RETURN_IF_ERROR(fitted[i].status());
    TACTUS_RETURN_IF_ERROR(
        add(jobs[i].family, jobs[i].name,
            jobs[i].family == kLstms ? LstmsAlone(*fitted[i]) : *fitted[i]));
  }
  return variants;
}

}  // namespace tactus::internal::client
