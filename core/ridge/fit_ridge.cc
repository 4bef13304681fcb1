#include "core/ridge/fit_ridge.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "Eigen/Cholesky"
#include "Eigen/Core"
#include "core/base/random.h"
#include "core/base/status_macros.h"
#include "core/ridge/history_kernels.h"

namespace tactus::internal {
namespace {

using Matrix = Eigen::MatrixXd;
using Rows =
    Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr size_t kPartCount = kHistoryParts.size();
// Penalties, relative to the mean of the diagonal of the kernel matrix.
constexpr std::array<double, 7> kPenalties = {1e-4, 1e-3, 3e-3, 1e-2,
                                              3e-2, 0.1,  0.5};
// Factors on the scores before a softmax, of which the best counts.
constexpr std::array<double, 7> kSharpness = {1, 2, 4, 8, 12, 18, 27};
// Contacts that the thresholds of the kernels are taken from, and frames of
// each.
constexpr size_t kThresholdContacts = 96;
constexpr size_t kThresholdFrames = 16;
// Rows of the kernel matrix that are made between two questions whether to go
// on.
constexpr Eigen::Index kKernelRows = 192;
// A number that varies less than this fraction of its mean does not count.
constexpr double kConstant = 1e-6;

// Draws the channels of each kernel: some of them, with random weights.
void DrawMixtures(uint64_t seed, HistorySpec& spec) {
  Random random = Random::ForStream(seed, 0);
  const int cells = spec.cells();
  const int most = std::min(cells, kMiniMixed);
  spec.mixed_channel.assign(size_t{kFrameViews} * kMiniKernels * kMiniMixed, 0);
  spec.mixed_weight.assign(spec.mixed_channel.size(), 0);
  std::vector<uint16_t> order(cells);
  for (size_t first = 0; first < spec.mixed_channel.size();
       first += kMiniMixed) {
    std::iota(order.begin(), order.end(), uint16_t{0});
    // As many sizes below two as from two on to four, and so on.
    const double size = std::exp2(random.Uniform(0, std::log2(most + 1.0)));
    const int count = std::clamp(static_cast<int>(size), 1, most);
    for (int m = 0; m < count; ++m) {
      std::swap(order[m], order[m + random.Index(cells - m)]);
      spec.mixed_channel[first + m] = order[m];
      spec.mixed_weight[first + m] = static_cast<float>(random.Gaussian());
    }
  }
}

// Sets the thresholds of each kernel to quantiles of its values.
void FitThresholds(std::span<const HistorySample> samples, uint64_t seed,
                   HistorySpec& spec) {
  Random random = Random::ForStream(seed, 1);
  constexpr size_t kSeries = size_t{kFrameViews} * kMiniDilationCount;
  spec.threshold.assign(kSeries * kMiniThresholds * kMiniKernels, 0);
  std::vector<size_t> order(samples.size());
  std::iota(order.begin(), order.end(), size_t{0});
  const size_t contacts = std::min(order.size(), kThresholdContacts);
  std::vector<std::vector<float>> values(kSeries * kMiniKernels);
  TouchHistory history(&spec);
  for (size_t c = 0; c < contacts; ++c) {
    std::swap(order[c], order[c + random.Index(order.size() - c)]);
    const auto& frames = samples[order[c]].frames;
    const double stride = std::max(
        1.0, static_cast<double>(frames.size()) / double{kThresholdFrames});
    double next = random.Uniform(0, stride);
    history.Reset();
    for (size_t t = 0; t < frames.size(); ++t) {
      history.Step(frames[t]);
      if (static_cast<double>(t + 1) <= next) continue;
      next += stride;
      for (size_t s = 0; s < kSeries; ++s) {
        for (int k = 0; k < kMiniKernels; ++k) {
          values[s * kMiniKernels + k].push_back(
              history.kernel_values()[s * kMiniLanes + k]);
        }
      }
    }
  }
  for (size_t s = 0; s < kSeries; ++s) {
    for (int k = 0; k < kMiniKernels; ++k) {
      std::vector<float>& of = values[s * kMiniKernels + k];
      std::ranges::sort(of);
      for (int t = 0; t < kMiniThresholds; ++t) {
        // Evenly spread, and shifted from kernel to kernel.
        const double place =
            std::fmod((t + 0.5) / kMiniThresholds + k * 0.6180339887, 1.0);
        spec.threshold[(s * kMiniThresholds + t) * kMiniKernels + k] =
            of[static_cast<size_t>(place * static_cast<double>(of.size() - 1))];
      }
    }
  }
}

// The numbers of all parts of all contacts, a row each.
absl::StatusOr<Rows> MakeRows(std::span<const HistorySample> samples,
                              const HistorySpec& spec,
                              const RidgeOptions& options) {
  const auto numbers = static_cast<Eigen::Index>(spec.numbers());
  Rows rows(static_cast<Eigen::Index>(samples.size() * kPartCount), numbers);
  TouchHistory history(&spec);
  Eigen::Index row = 0;
  for (const HistorySample& sample : samples) {
    TACTUS_RETURN_IF_ERROR(options.go_on());
    history.Reset();
    size_t t = 0;
    for (const double part : kHistoryParts) {
      for (const size_t end = EndOf(part, sample.frames.size()); t < end; ++t) {
        history.Step(sample.frames[t]);
      }
      history.Write({&rows(row++, 0), spec.numbers()});
    }
  }
  return rows;
}

// Standardises the columns.
void FitScaling(const Rows& rows, Ridge& ridge) {
  const auto count = static_cast<double>(rows.rows());
  const Eigen::RowVectorXd mean = rows.cast<double>().colwise().sum() / count;
  Eigen::RowVectorXd square = Eigen::RowVectorXd::Zero(rows.cols());
  for (Eigen::Index r = 0; r < rows.rows(); ++r) {
    square += (rows.row(r).cast<double>() - mean).array().square().matrix();
  }
  for (Eigen::Index i = 0; i < rows.cols(); ++i) {
    const double deviation = std::sqrt(square[i] / count);
    const double size = std::max(std::abs(mean[i]), 1.0);
    ridge.offset.push_back(static_cast<float>(mean[i]));
    ridge.gain.push_back(
        deviation > kConstant * size ? static_cast<float>(1 / deviation) : 0);
  }
}

// The statistics, the stretches and the kernels count as much as each other,
// however many they are.
std::vector<float> BlockWeights(const HistorySpec& spec) {
  const size_t channels = static_cast<size_t>(spec.channels()) * kFrameViews;
  const size_t statistics = channels * kHistoryStatistics;
  const size_t stretches = channels * kHistoryStretches;
  std::vector<float> weights(spec.numbers());
  for (size_t i = 0; i < weights.size(); ++i) {
    const size_t size = i < statistics ? statistics
                        : i < statistics + stretches
                            ? stretches
                            : weights.size() - statistics - stretches;
    weights[i] = static_cast<float>(1 / std::sqrt(static_cast<double>(size)));
  }
  return weights;
}

// Sum of the log losses of the contacts, at the best sharpness.
double LogLossOf(const Matrix& predicted,
                 std::span<const HistorySample> samples) {
  double least = std::numeric_limits<double>::infinity();
  for (const double sharpness : kSharpness) {
    double loss = 0;
    for (size_t s = 0; s < samples.size(); ++s) {
      const auto scores = predicted.row(static_cast<Eigen::Index>(s));
      const double top = scores.maxCoeff();
      const double sum = (sharpness * (scores.array() - top)).exp().sum();
      loss += std::log(sum) - sharpness * (scores[samples[s].label] - top);
    }
    least = std::min(least, loss);
  }
  return least;
}

// The answers to the contacts of each group by a ridge of the others.
Matrix LeftOut(const Matrix& inverse, const Matrix& alpha, const Matrix& wanted,
               const std::vector<std::vector<Eigen::Index>>& groups) {
  Matrix predicted = wanted;
  for (const std::vector<Eigen::Index>& rows : groups) {
    const Matrix block = inverse(rows, rows);
    const Matrix error = block.llt().solve(alpha(rows, Eigen::all));
    predicted(rows, Eigen::all) -= error;
  }
  return predicted;
}

std::vector<std::vector<Eigen::Index>> ContactsOfGroups(
    std::span<const HistorySample> samples) {
  int most = 0;
  for (const HistorySample& sample : samples)
    most = std::max(most, sample.group);
  std::vector<std::vector<Eigen::Index>> groups(most + 1);
  for (size_t s = 0; s < samples.size(); ++s) {
    groups[samples[s].group].push_back(static_cast<Eigen::Index>(s));
  }
  std::erase_if(groups, [](const auto& rows) { return rows.empty(); });
  return groups;
}

// The products of all pairs of rows. Each element is the same sum whichever
// rows are made together.
absl::StatusOr<Matrix> KernelOf(const Rows& rows, const RidgeOptions& options) {
  const Eigen::Index count = rows.rows();
  Rows product(count, count);
  for (Eigen::Index first = 0; first < count; first += kKernelRows) {
    TACTUS_RETURN_IF_ERROR(options.go_on());
    const Eigen::Index size = std::min(kKernelRows, count - first);
    const auto some = rows.middleRows(first, size);
    product.block(first, 0, size, first).noalias() =
        some * rows.topRows(first).transpose();
    Rows square = Rows::Zero(size, size);
    square.selfadjointView<Eigen::Lower>().rankUpdate(some);
    product.block(first, first, size, size) = square;
  }
  Matrix kernel = product.cast<double>();
  kernel.triangularView<Eigen::StrictlyUpper>() = kernel.transpose();
  return kernel;
}

// The class indicators of `parts` rows a contact, less the shares of the
// classes.
Matrix Indicators(std::span<const HistorySample> samples, size_t parts,
                  const Eigen::RowVectorXd& share) {
  Matrix wanted(static_cast<Eigen::Index>(samples.size() * parts),
                share.size());
  wanted.rowwise() = -share;
  for (size_t row = 0; row < samples.size() * parts; ++row) {
    wanted(static_cast<Eigen::Index>(row), samples[row / parts].label) += 1;
  }
  return wanted;
}

Matrix Penalised(Matrix kernel, double penalty) {
  kernel.diagonal().array() += penalty;
  return kernel;
}

struct Penalty {
  double penalty = 0;
  // What left-out contacts lose.
  double log_loss = std::numeric_limits<double>::infinity();
};

// The best penalty for whole contacts. `kernel` is that of all rows.
absl::StatusOr<Penalty> ChoosePenalty(std::span<const HistorySample> samples,
                                      const Matrix& kernel,
                                      const Eigen::RowVectorXd& share,
                                      const RidgeOptions& options) {
  const auto count = static_cast<Eigen::Index>(samples.size());
  std::vector<Eigen::Index> whole(count);
  for (Eigen::Index s = 0; s < count; ++s) {
    whole[s] = s * static_cast<Eigen::Index>(kPartCount) + kPartCount - 1;
  }
  const Matrix of_wholes = kernel(whole, whole);
  const Matrix wanted = Indicators(samples, 1, share);
  const auto groups = ContactsOfGroups(samples);
  const double scale =
      std::max(of_wholes.trace() / static_cast<double>(count), 1e-12);
  Penalty best;
  for (const double penalty : kPenalties) {
    const Eigen::LLT<Matrix> cholesky(Penalised(of_wholes, penalty * scale));
    const Matrix inverse = cholesky.solve(Matrix::Identity(count, count));
    const double loss =
        LogLossOf(LeftOut(inverse, inverse * wanted, wanted, groups), samples);
    TACTUS_RETURN_IF_ERROR(options.go_on());
    if (loss < best.log_loss) best = {penalty * scale, loss};
  }
  return best;
}

struct Candidate {
  Ridge ridge;
  // What left-out contacts lose.
  double log_loss = 0;
};

absl::StatusOr<Candidate> FitTo(const TaxelShape& shape,
                                std::span<const HistorySample> samples,
                                const RidgeOptions& options) {
  Candidate candidate;
  Ridge& ridge = candidate.ridge;
  HistorySpec& spec = ridge.history;
  static_cast<FrameViews&>(spec) = FitViews(samples, shape);
  DrawMixtures(options.seed, spec);
  FitThresholds(samples, options.seed, spec);
  TACTUS_RETURN_IF_ERROR(options.go_on());
  TACTUS_ASSIGN_OR_RETURN(Rows rows, MakeRows(samples, spec, options));
  FitScaling(rows, ridge);
  const std::vector<float> block = BlockWeights(spec);
  for (Eigen::Index r = 0; r < rows.rows(); ++r) {
    const std::span<float> row(&rows(r, 0), block.size());
    Standardise(row, ridge.offset, ridge.gain, kRidgeLimit, row);
    for (size_t i = 0; i < block.size(); ++i) row[i] *= block[i];
  }
  TACTUS_ASSIGN_OR_RETURN(Matrix kernel, KernelOf(rows, options));
  TACTUS_RETURN_IF_ERROR(options.go_on());

  Eigen::RowVectorXd share = Eigen::RowVectorXd::Zero(options.classes);
  for (const HistorySample& sample : samples) share[sample.label] += 1;
  share /= static_cast<double>(samples.size());
  TACTUS_ASSIGN_OR_RETURN(const Penalty chosen,
                          ChoosePenalty(samples, kernel, share, options));
  candidate.log_loss = chosen.log_loss;
  const Eigen::LLT<Matrix> cholesky(
      Penalised(std::move(kernel), chosen.penalty));
  const Matrix alpha = cholesky.solve(Indicators(samples, kPartCount, share));
  const Rows weight = alpha.transpose().cast<float>() * rows;
  ridge.weight.assign(weight.data(), weight.data() + weight.size());
  for (int k = 0; k < options.classes; ++k) {
    float* const of_class = ridge.weight.data() + k * block.size();
    for (size_t i = 0; i < block.size(); ++i) of_class[i] *= block[i];
    ridge.bias.push_back(static_cast<float>(share[k]));
  }
  return candidate;
}

}  // namespace

absl::StatusOr<Ridge> FitRidge(std::span<const HistorySample> samples,
                               const RidgeOptions& options) {
  TACTUS_ASSIGN_OR_RETURN(
      Candidate best,
      FitTo(WithoutComponents(options.shape), samples, options));
  if (options.shape == WithoutComponents(options.shape)) return best.ridge;
  TACTUS_ASSIGN_OR_RETURN(Candidate all,
                          FitTo(options.shape, samples, options));
  return all.log_loss < best.log_loss ? all.ridge : best.ridge;
}

}  // namespace tactus::internal
