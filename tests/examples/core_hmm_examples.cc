// The examples of public headers, as their comments show them. They only have
// to compile; HouseTest.ExamplesAreCompiled compares the texts.
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

namespace tactus::examples {

using Sequences = std::vector<SequenceView>;

absl::Status BaumWelchExample(const Sequences& sequences,
                              const InitOptions& init_options,
                              const BaumWelchOptions& options) {
  GaussianHmm model = *InitPaper(sequences, init_options);
  TACTUS_ASSIGN_OR_RETURN(BaumWelchReport report,
                          BaumWelch(sequences, options, model));
  return absl::OkStatus();
}

void ExpectationExample(const Sequences& sequences, const GaussianHmm& model) {
  Expectation expectation(sequences);
  const ExpectedCounts counts = expectation.Compute(model);
}

void ForwardBackwardExample(const SequenceBatch& batch,
                            const GaussianHmm& model, ExpectedCounts& counts) {
  ForwardBackward smoother(batch.lanes());
  smoother.SetModel(model);
  smoother.Add(batch, Counts::kAll);
  smoother.AddTo(counts);
}

void FlooredCovarianceExample(const std::vector<double>& covariance, int state,
                              GaussianHmm& model) {
  const bool raised =
      SetFlooredCovariance(covariance, /*floor=*/1e-6, state, model);
}

absl::Status GaussianHmmExample(const Sequences& sequences,
                                const std::vector<HmmMixture>& mixtures) {
  GaussianHmm model = *InitPaper(sequences, {});
  TACTUS_RETURN_IF_ERROR(Validate(model));
  TACTUS_ASSIGN_OR_RETURN(HmmBank bank, HmmBank::Create(mixtures));
  return absl::OkStatus();
}

absl::Status HmmBankExample(const std::vector<HmmMixture>& mixtures,
                            std::span<const double> observation,
                            std::span<double> scores) {
  TACTUS_ASSIGN_OR_RETURN(HmmBank bank, HmmBank::Create(mixtures));
  BankFilter filter(bank, Score::kForward);
  filter.Step(observation);
  filter.Skip(3);
  filter.LogLikelihood(scores);
  return absl::OkStatus();
}

absl::Status InitExample(const Sequences& sequences,
                         const InitOptions& options) {
  TACTUS_ASSIGN_OR_RETURN(GaussianHmm model, InitPaper(sequences, options));
  return absl::OkStatus();
}

void KMeansExample(const Eigen::MatrixXd& points, uint64_t seed, int i) {
  KMeansResult clusters = KMeans(points, 10, seed);
  clusters.cluster_of[i];  // the cluster of point i
}

absl::Status MixtureExample(const GaussianHmm& model) {
  HmmMixture mixture = {.log_weight = {0}, .components = {model}};
  TACTUS_RETURN_IF_ERROR(Validate(mixture));
  return absl::OkStatus();
}

void ScaledFilterExample(const ScaledModel<float>& packed,
                         std::span<const double> observation, int component) {
  ScaledFilter<float> filter(packed, {}, Score::kForward);
  filter.Step(observation);
  filter.UpdateTotals();
  filter.log_likelihood(component);
}

void ScaledModelExample(const GaussianHmm& model_a,
                        const GaussianHmm& model_b) {
  const ScaledModel<float> packed({&model_a, &model_b}, UnitScale(3));
  ScaledFilter<float> filter(packed, {}, Score::kForward);
}

void SequenceExample(int frames, int dimensions) {
  std::vector<double> data(frames * dimensions);  // [T x D] row-major
  SequenceView view{data.data(), frames, dimensions};
}

void SequenceBatchExample(const Sequences& sequences, int t) {
  for (const SequenceBatch& batch : MakeBatches(sequences)) {
    batch.frame(t);
  }
}

absl::Status TrainMixtureExample(const Sequences& trials_of_category) {
  TrainMixtureOptions options;
  options.components = 10;
  TACTUS_ASSIGN_OR_RETURN(TrainedMixture trained,
                          TrainMixture(trials_of_category, options));
  return absl::OkStatus();
}

absl::Status PcaNearestExample(const Eigen::MatrixXd& samples,
                               const std::vector<int>& labels,
                               const Eigen::VectorXd& vector) {
  TACTUS_ASSIGN_OR_RETURN(PcaNearest nearest,
                          PcaNearest::Fit(samples, labels, 0.95));
  TACTUS_ASSIGN_OR_RETURN(PcaNearest::Match match, nearest.Predict(vector));
  return absl::OkStatus();
}

}  // namespace tactus::examples
