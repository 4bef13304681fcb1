#include "core/hmm/train_mixture.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "Eigen/Core"
#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/hmm/init.h"
#include "core/hmm/kmeans.h"

namespace tactus::internal {
namespace {

constexpr int kMaxSummaryPoints = 1000;

absl::Status CheckOptions(const TrainMixtureOptions& options) {
  if (options.components < 1 || options.components > limits::kMaxHmmsPerClass) {
    return InvalidConfig("components", options.components,
                         absl::StrCat("1 to ", limits::kMaxHmmsPerClass));
  }
  if (options.min_trials < 1) {
    return InvalidConfig("min_trials", options.min_trials, "1 or more");
  }
  if (options.summary_points < 1 ||
      options.summary_points > kMaxSummaryPoints) {
    return InvalidConfig("summary_points", options.summary_points,
                         absl::StrCat("1 to ", kMaxSummaryPoints));
  }
  return absl::OkStatus();
}

// One column per trial: [(points * D) x trials].
Eigen::MatrixXd Summarise(const std::vector<SequenceView>& trials, int points) {
  const int d = trials.front().dimensions;
  Eigen::MatrixXd summary(points * d, trials.size());
  for (size_t s = 0; s < trials.size(); ++s) {
    const SequenceView& trial = trials[s];
    for (int p = 0; p < points; ++p) {
      const double place = points == 1 ? trial.frames - 1
                                       : static_cast<double>(p) *
                                             (trial.frames - 1) / (points - 1);
      const int before = static_cast<int>(place);
      const int after = std::min(before + 1, trial.frames - 1);
      const double share = place - before;
      for (int k = 0; k < d; ++k) {
        summary(p * d + k, s) = (1 - share) * trial.frame(before)[k] +
                                share * trial.frame(after)[k];
      }
    }
  }
  for (Eigen::Index r = 0; r < summary.rows(); ++r) {
    Eigen::ArrayXd values = summary.row(r).transpose();
    values -= values.mean();
    const double deviation = std::sqrt(values.square().mean());
    if (deviation > 0) values /= deviation;
    summary.row(r) = values.transpose();
  }
  return summary;
}

// Dissolves the smallest group until every group holds `min_trials` or one
// group is left. Each trial of a dissolved group joins the group with the
// nearest centre.
void DissolveSmallGroups(const Eigen::MatrixXd& summary,
                         const Eigen::MatrixXd& centres, int min_trials,
                         std::vector<int>& group_of) {
  const int groups = static_cast<int>(centres.cols());
  const auto cost = [&](size_t s, int g) {
    return (summary.col(s) - centres.col(g)).squaredNorm();
  };
  std::vector<bool> alive(groups, true);
  for (int left = groups; left > 1; --left) {
    std::vector<int> sizes(groups, 0);
    for (const int group : group_of) ++sizes[group];
    int smallest = -1;
    for (int g = 0; g < groups; ++g) {
      if (alive[g] && (smallest < 0 || sizes[g] < sizes[smallest])) {
        smallest = g;
      }
    }
    if (sizes[smallest] >= min_trials) break;
    alive[smallest] = false;
    for (size_t s = 0; s < group_of.size(); ++s) {
      if (group_of[s] != smallest) continue;
      int nearest = -1;
      for (int g = 0; g < groups; ++g) {
        if (alive[g] && (nearest < 0 || cost(s, g) < cost(s, nearest))) {
          nearest = g;
        }
      }
      group_of[s] = nearest;
    }
  }
}

// Renumbers the groups in use to 0 .. K-1, keeping their order; returns K.
int Compact(std::vector<int>& group_of) {
  std::vector<int> names = group_of;
  std::ranges::sort(names);
  names.erase(std::unique(names.begin(), names.end()), names.end());
  for (int& group : group_of) {
    group = static_cast<int>(std::ranges::lower_bound(names, group) -
                             names.begin());
  }
  return static_cast<int>(names.size());
}

std::vector<SequenceView> Members(const std::vector<SequenceView>& trials,
                                  const std::vector<int>& group_of, int group) {
  std::vector<SequenceView> members;
  for (size_t s = 0; s < trials.size(); ++s) {
    if (group_of[s] == group) members.push_back(trials[s]);
  }
  return members;
}

// The group of each trial. Groups are numbered with gaps.
std::vector<int> GroupTrials(const std::vector<SequenceView>& trials,
                             const TrainMixtureOptions& options,
                             const ParallelFor& parallel) {
  const Eigen::MatrixXd summary = Summarise(trials, options.summary_points);
  KMeansResult clusters =
      KMeans(summary, options.components, options.baum_welch.seed, parallel);
  std::vector<int> group_of = std::move(clusters.cluster_of);
  DissolveSmallGroups(summary, clusters.centres, options.min_trials, group_of);
  return group_of;
}

// Trains each component on its members, starting from the model it holds.
absl::Status TrainComponents(const std::vector<SequenceView>& trials,
                             const BaumWelchOptions& options,
                             MixtureSink on_iteration,
                             TrainedMixture& trained) {
  for (size_t k = 0; k < trained.mixture.components.size(); ++k) {
    const int component = static_cast<int>(k);
    const std::vector<SequenceView> members =
        Members(trials, trained.component_of, component);
    TACTUS_ASSIGN_OR_RETURN(
        BaumWelchReport report,
        BaumWelch(members, options, trained.mixture.components[k],
                  [&](const BaumWelchReport& so_far) {
                    return on_iteration(component, so_far);
                  }));
    trained.reports.push_back(std::move(report));
    trained.mixture.log_weight.push_back(
        std::log(static_cast<double>(members.size()) / trials.size()));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<TrainedMixture> TrainMixture(
    const std::vector<SequenceView>& trials, const TrainMixtureOptions& options,
    MixtureSink on_iteration, const ParallelFor& parallel) {
  TACTUS_RETURN_IF_ERROR(CheckOptions(options));
  TACTUS_RETURN_IF_ERROR(Validate(trials));
  TrainedMixture trained;
  trained.component_of = GroupTrials(trials, options, parallel);
  const int components = Compact(trained.component_of);
  const InitOptions init = {
      .states = options.states,
      .left_right = options.baum_welch.left_right,
      .max_jump = options.max_jump,
      .covariance_type = options.baum_welch.covariance_type,
      .covariance_floor = options.baum_welch.covariance_floor};
  for (int k = 0; k < components; ++k) {
    TACTUS_ASSIGN_OR_RETURN(
        GaussianHmm model,
        InitPaper(Members(trials, trained.component_of, k), init));
    trained.mixture.components.push_back(std::move(model));
  }
  TACTUS_RETURN_IF_ERROR(
      TrainComponents(trials, options.baum_welch, on_iteration, trained));
  return trained;
}

}  // namespace tactus::internal
