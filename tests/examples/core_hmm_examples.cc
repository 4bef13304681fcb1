// What the examples of public headers need around them. They only have to
// compile. The build takes each .inc from the comment of the header it names.
#include <span>
#include <vector>

#include "core/base/status_macros.h"
#include "core/hmm/baum_welch.h"
#include "core/hmm/expectation.h"
#include "core/hmm/floored_covariance.h"
#include "core/hmm/forward_backward.h"
#include "core/hmm/gaussian_hmm.h"
#include "core/hmm/hmm_bank.h"
#include "core/hmm/init.h"
#include "core/hmm/kmeans.h"
#include "core/hmm/mixture.h"
#include "core/hmm/scaled_filter.h"
#include "core/hmm/scaled_model.h"
#include "core/hmm/sequence.h"
#include "core/hmm/sequence_batch.h"
#include "core/hmm/train_mixture.h"
#include "core/nearest/pca_nearest.h"

namespace tactus::internal::examples {

using Sequences = std::vector<SequenceView>;

static absl::Status BaumWelchExample(const Sequences& sequences,
                                     const InitOptions& init_options,
                                     const BaumWelchOptions& options) {
#include "core/hmm/baum_welch.h.inc"
  return absl::OkStatus();
}

static void ExpectationExample(const Sequences& sequences,
                               const GaussianHmm& model) {
#include "core/hmm/expectation.h.inc"
}

static void ForwardBackwardExample(const SequenceBatch& batch,
                                   const GaussianHmm& model,
                                   ExpectedCounts& counts) {
#include "core/hmm/forward_backward.h.inc"
}

static void FlooredCovarianceExample(const std::vector<double>& covariance,
                                     int state, GaussianHmm& model) {
#include "core/hmm/floored_covariance.h.inc"
}

static absl::Status GaussianHmmExample(
    const Sequences& sequences, const std::vector<HmmMixture>& mixtures) {
#include "core/hmm/gaussian_hmm.h.inc"
  return absl::OkStatus();
}

static absl::Status HmmBankExample(const std::vector<HmmMixture>& mixtures,
                                   std::span<const double> observation,
                                   std::span<double> scores) {
#include "core/hmm/hmm_bank.h.inc"
  return absl::OkStatus();
}

static absl::Status InitExample(const Sequences& sequences,
                                const InitOptions& options) {
#include "core/hmm/init.h.inc"
  return absl::OkStatus();
}

static void KMeansExample(const Eigen::MatrixXd& points, uint64_t seed, int i) {
#include "core/hmm/kmeans.h.inc"
}

static absl::Status MixtureExample(const GaussianHmm& model) {
#include "core/hmm/mixture.h.inc"
  return absl::OkStatus();
}

static void ScaledFilterExample(const ScaledModel<float>& packed,
                                std::span<const double> observation,
                                int component) {
#include "core/hmm/scaled_filter.h.inc"
}

static void ScaledModelExample(const GaussianHmm& model_a,
                               const GaussianHmm& model_b) {
#include "core/hmm/scaled_model.h.inc"
}

static void SequenceExample(int frames, int dimensions) {
#include "core/hmm/sequence.h.inc"
}

static void SequenceBatchExample(const Sequences& sequences, int t) {
#include "core/hmm/sequence_batch.h.inc"
}

static absl::Status TrainMixtureExample(const Sequences& trials_of_class) {
#include "core/hmm/train_mixture.h.inc"
  return absl::OkStatus();
}

static absl::Status PcaNearestExample(const Eigen::MatrixXd& samples,
                                      const std::vector<int>& labels,
                                      const Eigen::VectorXd& vector) {
#include "core/nearest/pca_nearest.h.inc"
  return absl::OkStatus();
}

}  // namespace tactus::internal::examples
