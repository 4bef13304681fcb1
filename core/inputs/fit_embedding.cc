#include "core/inputs/fit_embedding.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "Eigen/Cholesky"
#include "Eigen/Core"
#include "Eigen/Eigenvalues"
#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/taxels/components.h"

namespace tactus::internal {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// With fewer discriminants than this, principal components make up the number.
constexpr int kFilledDimensions = 16;
// Fraction of the mean variance that is added to each variance within the
// classes, because there may be fewer contacts than taxels.
constexpr double kShrinkage = 0.03;
// Directions with a smaller fraction of the largest one's variance are noise of
// the computation.
constexpr double kLeastVariance = 1e-9;

// Numbers the taxels that are ever touched; -1 for the others.
std::vector<int> NumberTouched(
    const std::vector<const LabelledContact*>& contacts, int* count) {
  const int taxels = contacts.front()->layout.taxels();
  std::vector<int> numbers(taxels, -1);
  for (const LabelledContact* contact : contacts) {
    for (size_t t = 0; t < contact->frames.size(); ++t) {
      for (const TaxelLoad& load :
           WithoutComponents(contact->frames.loads(t), taxels)) {
        numbers[load.taxel] = 0;
      }
    }
  }
  *count = 0;
  for (int& number : numbers) {
    if (number == 0) number = (*count)++;
  }
  return numbers;
}

// What EmbeddingTracker computes from one map per taxel: the levels of all
// taxels, and their changes.
class FrameVectors {
 public:
  FrameVectors(const std::vector<int>& numbers, int taxels, double rate)
      : numbers_(numbers),
        window_(std::max(1.0, EmbeddingTracker::kWindowS * rate)),
        level_(VectorXd::Zero(taxels)),
        mean_(VectorXd::Zero(taxels)) {}

  void Step(std::span<const TaxelLoad> loads) {
    level_.setZero();
    const auto taxels = static_cast<int>(numbers_.size());
    for (const TaxelLoad& load : WithoutComponents(loads, taxels)) {
      level_[numbers_[load.taxel]] = load.root;
    }
    ++frames_;
    if (frames_ == 1) mean_ = level_;
    mean_ += (level_ - mean_) / std::min(static_cast<double>(frames_), window_);
  }

  void Write(Eigen::Ref<VectorXd> out) const {
    out.head(level_.size()) = level_;
    out.tail(level_.size()) = level_ - mean_;
  }

 private:
  const std::vector<int>& numbers_;
  const double window_;
  uint64_t frames_ = 0;
  VectorXd level_;
  VectorXd mean_;
};

// Means and scatter of frames, by class.
struct Scatter {
  Scatter(int size, int classes)
      : sums(MatrixXd::Zero(size, classes)),
        counts(VectorXd::Zero(classes)),
        products(MatrixXd::Zero(size, size)) {}

  MatrixXd sums;
  VectorXd counts;
  MatrixXd products;  // the lower half
};

void AddContact(const LabelledContact& contact, int label,
                const std::vector<int>& numbers, const StepIntervals& steps,
                Scatter& scatter) {
  const auto size = scatter.products.rows();
  FrameVectors vectors(numbers, static_cast<int>(size / 2),
                       contact.sample_rate_hz);
  StepClock clock(steps);
  std::vector<double> due;
  VectorXd row(size);
  for (size_t t = 0; t < contact.frames.size(); ++t) {
    if (!contact.frames.touched(t)) continue;
    vectors.Step(contact.frames.loads(t));
    if (!clock.Tick(t + 1)) continue;
    vectors.Write(row);
    due.insert(due.end(), row.begin(), row.end());
  }
  const auto count = static_cast<Eigen::Index>(due.size()) / size;
  const Eigen::Map<const MatrixXd> rows(due.data(), size, count);
  scatter.products.selfadjointView<Eigen::Lower>().rankUpdate(rows);
  scatter.sums.col(label) += rows.rowwise().sum();
  scatter.counts[label] += static_cast<double>(count);
}

// Makes the sign of a direction a matter of the classes alone.
void FixSign(const MatrixXd& class_means, Eigen::Ref<VectorXd> direction) {
  const VectorXd at = class_means.transpose() * direction;
  const double largest = at.cwiseAbs().maxCoeff();
  for (const double value : at) {
    if (std::abs(value) < 1e-6 * largest) continue;
    if (value < 0) direction = -direction;
    return;
  }
}

// Columns are the directions that separate the classes, relative to the
// covariance `within` them, the best first. `means` are those of the classes
// less the mean of all, times the roots of the classes' shares.
MatrixXd Discriminants(const MatrixXd& within, const MatrixXd& means) {
  const Eigen::LLT<MatrixXd> root(within);
  const MatrixXd white = root.matrixL().solve(means);
  // The few directions that the class means span.
  const Eigen::SelfAdjointEigenSolver<MatrixXd> between(white.transpose() *
                                                        white);
  const auto classes = means.cols();
  const double largest = between.eigenvalues()[classes - 1];
  std::vector<VectorXd> found;
  for (auto i = classes - 1; i > 0; --i) {
    const double variance = between.eigenvalues()[i];
    if (static_cast<int>(found.size()) == kMaxEmbedding ||
        !(variance > kLeastVariance * largest)) {
      break;
    }
    found.emplace_back(root.matrixU().solve(
        white * between.eigenvectors().col(i) / std::sqrt(variance)));
  }
  MatrixXd directions(within.rows(), static_cast<Eigen::Index>(found.size()));
  for (size_t i = 0; i < found.size(); ++i) {
    directions.col(static_cast<Eigen::Index>(i)) = found[i];
  }
  return directions;
}

// Columns are up to `count` directions of largest variance, each divided by its
// deviation.
MatrixXd PrincipalComponents(const MatrixXd& covariance, int count) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(covariance);
  const auto size = covariance.rows();
  const double largest = solver.eigenvalues()[size - 1];
  const auto enough = [&](Eigen::Index i) {
    return solver.eigenvalues()[size - 1 - i] > kLeastVariance * largest;
  };
  Eigen::Index usable = 0;
  while (usable < std::min<Eigen::Index>(count, size) && enough(usable)) {
    ++usable;
  }
  MatrixXd directions(size, usable);
  for (Eigen::Index i = 0; i < usable; ++i) {
    directions.col(i) = solver.eigenvectors().col(size - 1 - i) /
                        std::sqrt(solver.eigenvalues()[size - 1 - i]);
  }
  return directions;
}

}  // namespace

absl::StatusOr<TaxelEmbedding> FitTaxelEmbedding(
    const std::vector<const LabelledContact*>& contacts,
    const std::vector<std::string>& class_names, const StepIntervals& steps) {
  int taxels = 0;
  const std::vector<int> numbers = NumberTouched(contacts, &taxels);
  if (taxels < 1 || taxels > limits::kMaxEmbeddedTaxels) {
    return InvalidTrainingData(absl::StrCat("the contacts touch ", taxels,
                                            " taxels; an embedding takes 1 to ",
                                            limits::kMaxEmbeddedTaxels));
  }
  const auto classes = static_cast<int>(class_names.size());
  Scatter scatter(2 * taxels, classes);
  for (const LabelledContact* contact : contacts) {
    const auto label = std::ranges::find(class_names, contact->label);
    AddContact(*contact, static_cast<int>(label - class_names.begin()), numbers,
               steps, scatter);
  }
  const double total = scatter.counts.sum();
  MatrixXd within = scatter.products.selfadjointView<Eigen::Lower>();
  const VectorXd mean = scatter.sums.rowwise().sum() / total;
  const MatrixXd covariance = within.topLeftCorner(taxels, taxels) / total -
                              mean.head(taxels) * mean.head(taxels).transpose();
  MatrixXd means(2 * taxels, classes);
  MatrixXd weighted(2 * taxels, classes);
  for (int c = 0; c < classes; ++c) {
    means.col(c) =
        scatter.sums.col(c) / std::max(scatter.counts[c], 1.0) - mean;
    weighted.col(c) = means.col(c) * std::sqrt(scatter.counts[c] / total);
  }
  within = within / total - mean * mean.transpose() -
           weighted * weighted.transpose();
  const double variance = within.trace() / static_cast<double>(2 * taxels);
  within.diagonal().array() += kShrinkage * variance + 1e-12;

  MatrixXd best = Discriminants(within, weighted);
  const int discriminants = static_cast<int>(best.cols());
  MatrixXd components =
      PrincipalComponents(covariance, kFilledDimensions - discriminants);
  for (int d = 0; d < discriminants; ++d) FixSign(means, best.col(d));
  for (int d = 0; d < components.cols(); ++d) {
    FixSign(means.topRows(taxels), components.col(d));
  }

  TaxelEmbedding embedding;
  embedding.taxels = static_cast<int>(numbers.size());
  embedding.dimensions = discriminants + static_cast<int>(components.cols());
  const size_t count = embedding.dimensions;
  embedding.weights.resize(2 * numbers.size() * count);
  for (size_t t = 0; t < numbers.size(); ++t) {
    if (numbers[t] < 0) continue;
    float* level = &embedding.weights[2 * t * count];
    for (int d = 0; d < discriminants; ++d) {
      level[d] = static_cast<float>(best(numbers[t], d));
      level[count + d] = static_cast<float>(best(taxels + numbers[t], d));
    }
    for (int d = 0; d < components.cols(); ++d) {
      level[discriminants + d] = static_cast<float>(components(numbers[t], d));
    }
  }
  return embedding;
}

}  // namespace tactus::internal
