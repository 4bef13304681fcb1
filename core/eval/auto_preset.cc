#include "core/eval/auto_preset.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/contacts/class_counts.h"
#include "core/eval/baselines.h"
#include "core/eval/out_of_fold.h"
#include "core/train/lstm_work.h"

namespace tactus::internal {
namespace {

using Contacts = std::vector<const LabelledContact*>;

const FitOptions& OptionsOf(const ChoiceRequest& request,
                            const std::string& preset) {
  return std::ranges::find(request.presets, preset,
                           [](const auto& named) { return named.first; })
      ->second;
}

FitOptions WithNetworks(FitOptions options, int networks) {
  options.lstm.networks = networks;
  return options;
}

// What a candidate costs per frame and in training, compared with others.
int CostOf(const FitOptions& options) {
  constexpr int kMostLearners = 10;
  if (options.lstm.networks > 0) return kMostLearners + options.lstm.networks;
  return static_cast<int>(options.learner);
}

// A candidate that was compared.
struct Compared {
  std::string preset;
  FitOptions options;
  std::vector<bool> right;
  int right_count = 0;
};

// True if `best` has more right answers by more than one standard error of the
// difference.
bool ClearlyWorse(const Compared& candidate, const Compared& best) {
  const auto contacts = static_cast<double>(best.right.size());
  const double more = best.right_count - candidate.right_count;
  double apart = 0;
  for (size_t i = 0; i < best.right.size(); ++i) {
    apart += best.right[i] != candidate.right[i];
  }
  return more > std::sqrt(apart - more * more / contacts);
}

// The cheapest of those that are not clearly worse than the best; the first of
// equal ones. There must be some.
const Compared& Cheapest(const std::vector<Compared>& candidates) {
  const Compared& best =
      *std::ranges::max_element(candidates, {}, &Compared::right_count);
  const auto rank = [](const Compared& c) {
    return std::pair(CostOf(c.options), -c.right_count);
  };
  const Compared* chosen = &best;
  for (const Compared& candidate : candidates) {
    if (ClearlyWorse(candidate, best)) continue;
    if (rank(candidate) < rank(*chosen)) chosen = &candidate;
  }
  return *chosen;
}

// Compares candidates and remembers their answers.
class Comparison {
 public:
  Comparison(const Contacts& contacts, const ChoiceFolds& folds,
             const ParallelFor& parallel, const Progress& progress,
             Ranks* ranks, const ChoiceRequest& request, PresetChoice& choice)
      : contacts_(contacts),
        folds_(folds),
        parallel_(parallel),
        progress_(progress),
        ranks_(ranks),
        request_(request),
        choice_(choice) {}

  // Compares nothing if the models do not suit the contacts. CANCELLED.
  absl::Status Try(const std::string& preset, const FitOptions& options) {
    auto right = RightOutOfFold(contacts_, folds_.folds, options, parallel_,
                                progress_, ranks_, request_.cancelled);
    if (absl::IsCancelled(right.status())) return right.status();
    ChoiceCandidate candidate = {preset, options.lstm.networks,
                                 options.learner};
    if (!right.ok()) {
      candidate.unfit = std::string(right.status().message());
      Add(std::move(candidate));
      return absl::OkStatus();
    }
    candidate.right = static_cast<int>(std::ranges::count(*right, true));
    Add(candidate);
    compared_.push_back({preset, options, *std::move(right), candidate.right});
    return absl::OkStatus();
  }

  // As Try, if the work of its LSTMs fits into what is left of the limit.
  absl::Status TryWithinLimit(const std::string& preset,
                              const FitOptions& options) {
    double work = work_;
    for (const std::vector<int>& fold : folds_.folds) {
      Contacts rest;
      for (const int i : Complement(fold, static_cast<int>(contacts_.size()))) {
        rest.push_back(contacts_[i]);
      }
      work += LstmWork(rest, options) / 1e9;
    }
    if (work > choice_.work_limit) {
      Add({preset, options.lstm.networks, options.learner, 0,
           absl::StrCat("with it the comparison takes ",
                        std::llround(std::ceil(work)),
                        " billion multiplications, and the limit is ",
                        choice_.work_limit)});
      return absl::OkStatus();
    }
    work_ = work;
    choice_.work = static_cast<int>(std::lround(work));
    return Try(preset, options);
  }

  // In the order in which they were tried.
  const std::vector<Compared>& compared() const { return compared_; }

 private:
  void Add(ChoiceCandidate candidate) {
    if (request_.considered) {
      request_.considered(candidate, static_cast<int>(contacts_.size()));
    }
    choice_.candidates.push_back(std::move(candidate));
  }

  const Contacts& contacts_;
  const ChoiceFolds& folds_;
  const ParallelFor& parallel_;
  const Progress progress_;
  Ranks* const ranks_;
  const ChoiceRequest& request_;
  PresetChoice& choice_;
  std::vector<Compared> compared_;
  double work_ = 0;
};

// Why none of the candidates was compared.
absl::Status NoneSuits(const PresetChoice& choice) {
  std::string why;
  for (const ChoiceCandidate& candidate : choice.candidates) {
    absl::StrAppend(&why, why.empty() ? "" : "; ", candidate.preset, ": ",
                    candidate.unfit);
  }
  return InvalidTrainingData(
      absl::StrCat("no preset suits the contacts: ", why));
}

}  // namespace

bool IsChosen(const ChoiceCandidate& candidate, const PresetChoice& choice) {
  return candidate.preset == choice.name &&
         candidate.networks == choice.options.lstm.networks;
}

absl::StatusOr<PresetChoice> ChoosePreset(const Contacts& contacts,
                                          const ChoiceRequest& request,
                                          const ParallelFor& parallel,
                                          const Progress& progress,
                                          Ranks* ranks) {
  const absl::Status classes = CheckClasses(CountClasses(contacts), "contacts");
  const ChoiceFolds folds = FoldsForChoice(contacts);
  if (const absl::Status enough =
          CheckFolds(contacts, folds.folds, kStratifiedChoice);
      !enough.ok()) {
    if (!classes.ok()) return enough;
    return Advise(enough, "or name a preset, like --preset=profile");
  }
  TACTUS_RETURN_IF_ERROR(classes);
  PresetChoice choice;
  choice.contacts = static_cast<int>(contacts.size());
  choice.folds = static_cast<int>(folds.folds.size());
  choice.by = folds.by;
  choice.work_limit = request.work_limit;
  const Progress each =
      progress.Part("choose preset", 1)
          .Part("", 1.0 / static_cast<double>(2 * request.presets.size()));
  Comparison comparison(contacts, folds, parallel, each, ranks, request,
                        choice);
  for (const auto& [name, options] : request.presets) {
    TACTUS_RETURN_IF_ERROR(comparison.Try(name, WithNetworks(options, 0)));
  }
  if (comparison.compared().empty()) return NoneSuits(choice);
  std::vector<Compared> ranked = comparison.compared();
  std::ranges::stable_sort(ranked, std::greater<>(), &Compared::right_count);
  for (const Compared& alone : ranked) {
    const int given = OptionsOf(request, alone.preset).lstm.networks;
    const int networks = request.networks_given ? given : std::max(given, 1);
    // Few contacts make a ridge; LSTMs beside it would need many.
    if (networks == 0 ||
        (alone.options.learner != Learner::kHmms && !request.networks_given)) {
      continue;
    }
    TACTUS_RETURN_IF_ERROR(comparison.TryWithinLimit(
        alone.preset, WithNetworks(alone.options, networks)));
  }
  std::vector<Compared> pool = comparison.compared();
  // Whoever asks for LSTMs gets the preset that is best with them.
  if (request.networks_given && pool.size() > ranked.size()) {
    pool.erase(pool.begin(), pool.begin() + ranked.size());
  }
  const Compared& chosen = Cheapest(pool);
  choice.name = chosen.preset;
  choice.options = chosen.options;
  if (request.networks_given) {
    choice.options.lstm.networks =
        OptionsOf(request, chosen.preset).lstm.networks;
  }
  TACTUS_ASSIGN_OR_RETURN(const Baselines baselines,
                          MeasureBaselines(contacts, folds.folds));
  choice.nearest_right = baselines.nearest_right;
  choice.chance =
      static_cast<double>(baselines.frequent_right) / choice.contacts;
  return choice;
}

}  // namespace tactus::internal
