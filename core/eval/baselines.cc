#include "core/eval/baselines.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include "Eigen/Core"
#include "core/base/status_macros.h"
#include "core/contacts/folds.h"
#include "core/nearest/pca_nearest.h"

namespace tactus::internal {
namespace {

using Contacts = std::vector<const LabelledContact*>;

// The number of each contact's class.
std::vector<int> NumberLabels(const Contacts& contacts) {
  std::map<std::string, int> number_of;
  std::vector<int> labels;
  for (const LabelledContact* contact : contacts) {
    const int next = static_cast<int>(number_of.size());
    labels.push_back(number_of.try_emplace(contact->label, next).first->second);
  }
  return labels;
}

int CountClasses(const std::vector<int>& labels) {
  return labels.empty() ? 0 : *std::ranges::max_element(labels) + 1;
}

// See CountNearestRight().
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

// The largest touched areas of contacts, in m^2, as ranks: more than kMostSizes
// areas share kMostSizes ranks.
struct Sizes {
  // Per contact.
  std::vector<int> rank;
  // Per rank, the smallest area that has it.
  std::vector<double> area;
};

Sizes RankSizes(const Contacts& contacts) {
  constexpr size_t kMostSizes = 256;
  constexpr int kArea = static_cast<int>(Feature::kArea);
  std::vector<double> sizes;
  for (const LabelledContact* contact : contacts) {
    double largest = 0;
    for (const ContactFrame& frame : contact->frames) {
      if (!frame.touched) continue;
      largest = std::max(largest, frame.sample.features[kArea]);
    }
    sizes.push_back(largest);
  }
  std::vector<double> sorted = sizes;
  std::ranges::sort(sorted);
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  const size_t ranks = std::min(sorted.size(), kMostSizes);
  Sizes result;
  result.area.assign(ranks, std::numeric_limits<double>::infinity());
  for (const double size : sizes) {
    const size_t place =
        std::ranges::lower_bound(sorted, size) - sorted.begin();
    const size_t rank = place * ranks / sorted.size();
    result.rank.push_back(static_cast<int>(rank));
    result.area[rank] = std::min(result.area[rank], size);
  }
  return result;
}

// The best answer to each rank, if at most `segments` answers follow each other
// from the first rank to the last. counts: [ranks][classes] of the training
// contacts. O(ranks^2 x segments), by dynamic programming.
std::vector<int> BestAnswers(const std::vector<std::vector<int>>& counts,
                             int segments) {
  const int ranks = static_cast<int>(counts.size());
  const int classes = static_cast<int>(counts.front().size());
  struct Segment {
    int first = 0;
    int answer = 0;
  };
  constexpr int kNone = std::numeric_limits<int>::min() / 2;
  // Most right answers to the ranks below r with s segments, and the last one.
  std::vector<std::vector<int>> most(segments + 1,
                                     std::vector<int>(ranks + 1, kNone));
  std::vector<std::vector<Segment>> last(segments + 1,
                                         std::vector<Segment>(ranks + 1));
  most[0][0] = 0;
  for (int first = 0; first < ranks; ++first) {
    std::vector<int> sums(classes, 0);
    int answer = 0;
    for (int end = first + 1; end <= ranks; ++end) {
      for (int k = 0; k < classes; ++k) {
        sums[k] += counts[end - 1][k];
        if (sums[k] > sums[answer]) answer = k;
      }
      for (int s = 1; s <= segments; ++s) {
        const int right = most[s - 1][first] + sums[answer];
        if (right <= most[s][end]) continue;
        most[s][end] = right;
        last[s][end] = {first, answer};
      }
    }
  }
  int s = 0;
  for (int i = 1; i <= segments; ++i) {
    if (most[i][ranks] > most[s][ranks]) s = i;
  }
  std::vector<int> answers(ranks, 0);
  for (int end = ranks; s > 0; --s) {
    const Segment& segment = last[s][end];
    std::fill(answers.begin() + segment.first, answers.begin() + end,
              segment.answer);
    end = segment.first;
  }
  return answers;
}

// Gives ranks without training contacts the answer of the nearest area that has
// some: a threshold lies in the middle between two areas.
void AnswerGaps(const std::vector<std::vector<int>>& counts,
                const std::vector<double>& area, std::vector<int>& answers) {
  std::vector<size_t> seen;
  for (size_t r = 0; r < counts.size(); ++r) {
    if (std::ranges::any_of(counts[r], [](int c) { return c > 0; })) {
      seen.push_back(r);
    }
  }
  if (seen.empty()) return;
  for (size_t r = 0, next = 0; r < counts.size(); ++r) {
    while (next + 1 < seen.size() && std::abs(area[seen[next + 1]] - area[r]) <
                                         std::abs(area[seen[next]] - area[r])) {
      ++next;
    }
    answers[r] = answers[seen[next]];
  }
}

}  // namespace

absl::StatusOr<int> CountNearestRight(
    const Contacts& contacts, const std::vector<std::vector<int>>& folds) {
  std::vector<Eigen::VectorXd> summaries;
  for (const LabelledContact* contact : contacts) {
    summaries.push_back(Summary(*contact));
  }
  const std::vector<int> numbers = NumberLabels(contacts);
  int right = 0;
  for (const std::vector<int>& fold : folds) {
    const auto rest = Complement(fold, static_cast<int>(contacts.size()));
    Eigen::MatrixXd samples(rest.size(), summaries.front().size());
    std::vector<int> labels;
    for (size_t i = 0; i < rest.size(); ++i) {
      samples.row(static_cast<Eigen::Index>(i)) = summaries[rest[i]];
      labels.push_back(numbers[rest[i]]);
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
      right += match.label == numbers[i];
    }
  }
  return right;
}

int CountSizeRight(const Contacts& contacts,
                   const std::vector<std::vector<int>>& folds) {
  const std::vector<int> labels = NumberLabels(contacts);
  const int classes = CountClasses(labels);
  const Sizes sizes = RankSizes(contacts);
  int right = 0;
  for (const std::vector<int>& fold : folds) {
    std::vector<std::vector<int>> counts(sizes.area.size(),
                                         std::vector<int>(classes, 0));
    for (const int i : Complement(fold, static_cast<int>(contacts.size()))) {
      ++counts[sizes.rank[i]][labels[i]];
    }
    std::vector<int> answers = BestAnswers(counts, classes);
    AnswerGaps(counts, sizes.area, answers);
    for (const int i : fold) right += answers[sizes.rank[i]] == labels[i];
  }
  return right;
}

absl::StatusOr<Baselines> MeasureBaselines(
    const Contacts& contacts, const std::vector<std::vector<int>>& folds) {
  Baselines baselines;
  baselines.contacts = static_cast<int>(contacts.size());
  std::map<int, int> counts;
  for (const int label : NumberLabels(contacts)) {
    baselines.frequent_right =
        std::max(baselines.frequent_right, ++counts[label]);
  }
  TACTUS_ASSIGN_OR_RETURN(baselines.nearest_right,
                          CountNearestRight(contacts, folds));
  baselines.size_right = CountSizeRight(contacts, folds);
  return baselines;
}

}  // namespace tactus::internal
