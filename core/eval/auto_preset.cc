#include "core/eval/auto_preset.h"

#include <algorithm>
#include <cmath>
#include <optional>

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

FitOptions WithNetworks(FitOptions options, int networks) {
  options.lstm.networks = networks;
  return options;
}

// Compares candidates and remembers the best.
class Comparison {
 public:
  Comparison(const Contacts& contacts, const ChoiceFolds& folds,
             const ParallelFor& parallel, const Progress& progress,
             PresetChoice& choice)
      : contacts_(contacts),
        folds_(folds),
        parallel_(parallel),
        progress_(progress),
        choice_(choice) {}

  // Returns the right answers; nothing if the models do not suit the contacts.
  std::optional<int> Try(const std::string& preset, const FitOptions& options) {
    const auto right = CountOutOfFoldRight(contacts_, folds_.folds, options,
                                           parallel_, progress_);
    ChoiceCandidate& candidate = Add(preset, options);
    if (!right.ok()) {
      candidate.unfit = std::string(right.status().message());
      return std::nullopt;
    }
    candidate.right = *right;
    if (*right > most_) {
      most_ = *right;
      choice_.name = preset;
      choice_.options = options;
    }
    return *right;
  }

  // What is tried next is better than what was tried before.
  void PreferNext() { most_ = -1; }

  // As Try, if the work of its LSTMs fits into what is left of the limit.
  void TryWithinLimit(const std::string& preset, const FitOptions& options) {
    double work = work_;
    for (const std::vector<int>& fold : folds_.folds) {
      Contacts rest;
      for (const int i : Complement(fold, static_cast<int>(contacts_.size()))) {
        rest.push_back(contacts_[i]);
      }
      work += LstmWork(rest, options) / 1e9;
    }
    if (work > choice_.work_limit) {
      ChoiceCandidate& candidate = Add(preset, options);
      candidate.unfit = absl::StrCat(
          "with it the comparison takes ", std::llround(std::ceil(work)),
          " billion multiplications, and the limit is ", choice_.work_limit);
      return;
    }
    work_ = work;
    choice_.work = static_cast<int>(std::lround(work));
    Try(preset, options);
  }

 private:
  ChoiceCandidate& Add(const std::string& preset, const FitOptions& options) {
    choice_.candidates.push_back({preset, options.lstm.networks});
    return choice_.candidates.back();
  }

  const Contacts& contacts_;
  const ChoiceFolds& folds_;
  const ParallelFor& parallel_;
  const Progress progress_;
  PresetChoice& choice_;
  int most_ = -1;
  double work_ = 0;
};

}  // namespace

absl::StatusOr<PresetChoice> ChoosePreset(const Contacts& contacts,
                                          const ChoiceRequest& request,
                                          const ParallelFor& parallel,
                                          const Progress& progress) {
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
  Comparison comparison(contacts, folds, parallel, each, choice);
  // Those that suit the contacts, by their right answers.
  std::vector<std::pair<int, size_t>> ranked;
  for (size_t i = 0; i < request.presets.size(); ++i) {
    const auto& [name, options] = request.presets[i];
    const auto right = comparison.Try(name, WithNetworks(options, 0));
    if (right) ranked.emplace_back(-*right, i);
  }
  if (ranked.empty()) {
    std::string why;
    for (const ChoiceCandidate& candidate : choice.candidates) {
      absl::StrAppend(&why, why.empty() ? "" : "; ", candidate.preset, ": ",
                      candidate.unfit);
    }
    return InvalidTrainingData(
        absl::StrCat("no preset suits the contacts: ", why));
  }
  std::ranges::stable_sort(ranked);
  // Whoever asks for LSTMs gets the preset that is best with them.
  if (request.networks_given) comparison.PreferNext();
  for (const auto& [negative, i] : ranked) {
    const auto& [name, options] = request.presets[i];
    const int networks = request.networks_given
                             ? options.lstm.networks
                             : std::max(options.lstm.networks, 1);
    if (networks > 0) {
      comparison.TryWithinLimit(name, WithNetworks(options, networks));
    }
  }
  if (request.networks_given) {
    const auto chosen =
        std::ranges::find(request.presets, choice.name,
                          [](const auto& preset) { return preset.first; });
    choice.options.lstm.networks = chosen->second.lstm.networks;
  }
  TACTUS_ASSIGN_OR_RETURN(const Baselines baselines,
                          MeasureBaselines(contacts, folds.folds));
  choice.nearest_right = baselines.nearest_right;
  choice.chance =
      static_cast<double>(baselines.frequent_right) / choice.contacts;
  return choice;
}

}  // namespace tactus::internal
