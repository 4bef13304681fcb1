#include "core/eval/auto_preset.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "Eigen/Core"
#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/eval/evaluate.h"
#include "core/nearest/pca_nearest.h"
#include "core/train/folds.h"

namespace tactus {
namespace {

constexpr int kFolds = 3;
constexpr size_t kMaxConditions = 8;

using Contacts = std::vector<const LabelledContact*>;

// True if every class has two contacts outside of each fold, as a fit needs.
bool LeavesEveryClass(const Contacts& contacts,
                      const std::vector<std::vector<int>>& folds) {
  std::map<std::string, int> all;
  for (const LabelledContact* contact : contacts) ++all[contact->label];
  for (const std::vector<int>& fold : folds) {
    std::map<std::string, int> rest = all;
    for (const int i : fold) {
      if (--rest[contacts[i]->label] < 2) return false;
    }
  }
  return true;
}

// Mean, deviation and largest value over the touched frames, of the features,
// the whole skin's force and the load profile.
Eigen::VectorXd Summary(const LabelledContact& contact) {
  constexpr int kNumbers = kFeatureCount + 1 + kProfileSize;
  Eigen::ArrayXd sum = Eigen::ArrayXd::Zero(kNumbers);
  Eigen::ArrayXd square = sum;
  Eigen::ArrayXd most = sum;
  int frames = 0;
  for (const ContactFrame& frame : contact.frames) {
    if (!frame.touched) continue;
    Eigen::ArrayXd now(kNumbers);
    for (int i = 0; i < kFeatureCount; ++i) now[i] = frame.sample.features[i];
    now[kFeatureCount] = frame.sample.net_force;
    for (int i = 0; i < kProfileSize; ++i) {
      now[kFeatureCount + 1 + i] = frame.sample.profile[i];
    }
    sum += now;
    square += now * now;
    most = most.max(now);
    ++frames;
  }
  const Eigen::ArrayXd mean = sum / std::max(frames, 1);
  const Eigen::ArrayXd deviation =
      (square / std::max(frames, 1) - mean * mean).max(0).sqrt();
  Eigen::VectorXd summary(3 * kNumbers);
  summary << mean, deviation, most;
  return summary;
}

// How many contacts have the label of the nearest one of the other folds, in
// numbers of mean 0 and deviation 1.
absl::StatusOr<int> CountNearestRight(
    const Contacts& contacts, const std::vector<std::vector<int>>& folds) {
  std::vector<Eigen::VectorXd> summaries;
  std::map<std::string, int> number_of;
  for (const LabelledContact* contact : contacts) {
    summaries.push_back(Summary(*contact));
    number_of.try_emplace(contact->label, static_cast<int>(number_of.size()));
  }
  int right = 0;
  for (const std::vector<int>& fold : folds) {
    const auto rest = Complement(fold, static_cast<int>(contacts.size()));
    Eigen::MatrixXd samples(rest.size(), summaries.front().size());
    std::vector<int> labels;
    for (size_t i = 0; i < rest.size(); ++i) {
      samples.row(static_cast<Eigen::Index>(i)) = summaries[rest[i]];
      labels.push_back(number_of[contacts[rest[i]]->label]);
    }
    const Eigen::RowVectorXd mean = samples.colwise().mean();
    samples.rowwise() -= mean;
    Eigen::RowVectorXd gain =
        (samples.array().square().colwise().mean()).sqrt().matrix();
    for (double& g : gain) g = g > 0 ? 1 / g : 1;
    samples.array().rowwise() *= gain.array();
    TACTUS_ASSIGN_OR_RETURN(const PcaNearest nearest,
                            PcaNearest::Fit(samples, labels, 1));
    for (const int i : fold) {
      const Eigen::RowVectorXd sample =
          ((summaries[i].transpose() - mean).array() * gain.array()).matrix();
      TACTUS_ASSIGN_OR_RETURN(const PcaNearest::Match match,
                              nearest.Predict(sample.transpose()));
      right += match.label == number_of[contacts[i]->label];
    }
  }
  return right;
}

}  // namespace

absl::StatusOr<PresetChoice> ChoosePreset(
    const std::vector<const LabelledContact*>& contacts,
    const std::vector<std::pair<std::string, FitOptions>>& candidates,
    const ParallelFor& parallel, const Progress& progress) {
  if (contacts.empty()) {
    return InvalidTrainingData("there is no contact to choose a preset for");
  }
  PresetChoice choice;
  choice.contacts = static_cast<int>(contacts.size());
  Protocol protocol(Protocol::kKFold, kFolds);
  auto folds = MakeFolds(contacts, Protocol::kLeaveOneConditionOut);
  if (folds.ok() && folds->size() <= kMaxConditions &&
      LeavesEveryClass(contacts, *folds)) {
    protocol = Protocol::kLeaveOneConditionOut;
    choice.by_condition = true;
  } else {
    folds = MakeFolds(contacts, protocol);
    TACTUS_RETURN_IF_ERROR(folds.status());
  }
  if (!LeavesEveryClass(contacts, *folds)) {
    return InvalidTrainingData(absl::StrCat(
        "a class has too few contacts to choose a preset by cross-validation "
        "in ",
        kFolds, " folds; record three or more of each, or name a preset"));
  }
  choice.folds = static_cast<int>(folds->size());
  const Progress each = progress.Part("choose preset", 1);
  int most = -1;
  for (const auto& [name, candidate] : candidates) {
    FitOptions options = candidate;
    options.calibrate = false;
    const auto result =
        EvaluateProtocol(contacts, protocol, Algorithm::kHmm, options, parallel,
                         each.Part("", 1.0 / candidates.size()));
    if (!result.ok()) {
      choice.unfit.emplace_back(name, result.status().message());
      continue;
    }
    const int right = CountRight(result->final);
    choice.right.emplace_back(name, right);
    if (right <= most) continue;
    most = right;
    choice.name = name;
    choice.options = candidate;
  }
  if (choice.right.empty()) {
    return InvalidTrainingData(
        "no preset suits the contacts; name one to learn why");
  }
  TACTUS_ASSIGN_OR_RETURN(choice.nearest_right,
                          CountNearestRight(contacts, *folds));
  std::map<std::string, int> counts;
  int frequent = 0;
  for (const LabelledContact* contact : contacts) {
    frequent = std::max(frequent, ++counts[contact->label]);
  }
  choice.chance = static_cast<double>(frequent) / choice.contacts;
  return choice;
}

}  // namespace tactus
