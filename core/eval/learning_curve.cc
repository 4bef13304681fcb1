#include "core/eval/learning_curve.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "core/base/random.h"
#include "core/base/status_macros.h"
#include "core/contacts/class_counts.h"
#include "core/eval/out_of_fold.h"

namespace tactus::internal {
namespace {

constexpr int kSizes[] = {5, 10, 20, 50};

// For each contact, how many of its class come before it in a drawn order.
std::vector<int> DrawRanks(const std::vector<const LabelledContact*>& contacts,
                           uint64_t seed) {
  Random random(seed);
  std::vector<size_t> order(contacts.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  for (size_t i = 0; i < order.size(); ++i) {
    std::swap(order[i], order[i + random.Index(order.size() - i)]);
  }
  std::vector<int> rank(contacts.size());
  std::map<std::string, int> before;
  for (const size_t i : order) rank[i] = before[contacts[i]->label]++;
  return rank;
}

// The contacts outside of each fold, at most `per_class` of a class.
std::vector<std::vector<int>> TrainingSets(
    const std::vector<const LabelledContact*>& contacts,
    const std::vector<std::vector<int>>& folds, const std::vector<int>& rank,
    int per_class) {
  std::vector<std::vector<int>> sets;
  for (const std::vector<int>& fold : folds) {
    std::vector<int> rest = Complement(fold, static_cast<int>(contacts.size()));
    std::ranges::stable_sort(rest, {}, [&](int i) { return rank[i]; });
    std::map<std::string, int> taken;
    std::erase_if(
        rest, [&](int i) { return taken[contacts[i]->label]++ >= per_class; });
    std::ranges::sort(rest);
    sets.push_back(std::move(rest));
  }
  return sets;
}

}  // namespace

absl::StatusOr<LearningCurve> MeasureLearningCurve(
    const std::vector<const LabelledContact*>& contacts,
    const Protocol& protocol, const FitOptions& options,
    const ParallelFor& parallel, const Progress& progress) {
  TACTUS_ASSIGN_OR_RETURN(const auto folds, MakeFolds(contacts, protocol));
  int most = 0;
  for (const auto& [label, count] : CountClasses(contacts)) {
    most = std::max(most, count);
  }
  std::vector<int> sizes;
  for (const int size : kSizes) {
    if (size < most) sizes.push_back(size);
  }
  sizes.push_back(most);
  const std::vector<int> rank = DrawRanks(contacts, options.seed);
  LearningCurve curve;
  curve.tested = static_cast<int>(contacts.size());
  const Progress each = progress.Part("learning curve", 1)
                            .Part("", 1 / static_cast<double>(sizes.size()));
  for (const int size : sizes) {
    TACTUS_ASSIGN_OR_RETURN(
        const std::vector<bool> right,
        RightOutOfFold(contacts, folds,
                       TrainingSets(contacts, folds, rank, size), options,
                       parallel, each));
    curve.points.push_back(
        {size, static_cast<int>(std::ranges::count(right, true))});
  }
  return curve;
}

std::optional<double> ExpectedAccuracy(const LearningCurve& curve,
                                       double per_class) {
  constexpr size_t kFitted = 3;
  if (curve.points.size() < kFitted) return std::nullopt;
  // A straight line through the logarithms. Half an error is added, so that
  // there is a logarithm without errors.
  double sum_x = 0;
  double sum_y = 0;
  double sum_xx = 0;
  double sum_xy = 0;
  for (size_t i = curve.points.size() - kFitted; i < curve.points.size(); ++i) {
    const CurvePoint& point = curve.points[i];
    const double x = std::log(point.per_class);
    const double y =
        std::log((curve.tested - point.right + 0.5) / (curve.tested + 1.0));
    sum_x += x;
    sum_y += y;
    sum_xx += x * x;
    sum_xy += x * y;
  }
  const double spread = kFitted * sum_xx - sum_x * sum_x;
  const double slope = (kFitted * sum_xy - sum_x * sum_y) / spread;
  if (!(slope < 0)) return std::nullopt;
  const double level = (sum_y - slope * sum_x) / kFitted;
  return 1 - std::exp(level + slope * std::log(per_class));
}

}  // namespace tactus::internal
