#include "tests/bench/ghmm_peer.h"

#include <ghmm/ghmm.h>
#include <ghmm/sequence.h>
#include <ghmm/sfoba.h>
#include <ghmm/smodel.h>
#include <ghmm/sreestimate.h>
#include <ghmm/sviterbi.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <vector>

#include "Eigen/Cholesky"
#include "Eigen/LU"
#include "core/base/errors.h"

using RowMajor =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Debian's libghmm was built against ATLAS but does not depend on it; these
// stand in for the three functions it misses. Covariances are positive
// definite, so the factorisation needs no pivoting.
extern "C" int clapack_dgetrf(int, int, int n, double* a, int, int* pivots) {
  for (int k = 0; k < n; ++k) {
    pivots[k] = k;
    for (int i = k + 1; i < n; ++i) {
      a[i * n + k] /= a[k * n + k];
      for (int j = k + 1; j < n; ++j)
        a[i * n + j] -= a[i * n + k] * a[k * n + j];
    }
  }
  return 0;
}

extern "C" int clapack_dgetri(int, int n, double* a, int, const int*) {
  Eigen::Map<RowMajor> factors(a, n, n);
  RowMajor inverse = RowMajor::Identity(n, n);
  factors.triangularView<Eigen::UnitLower>().solveInPlace(inverse);
  factors.triangularView<Eigen::Upper>().solveInPlace(inverse);
  factors = inverse;
  return 0;
}

extern "C" int clapack_dpotrf(int, int, int n, double* a, int) {
  Eigen::Map<RowMajor> matrix(a, n, n);
  const RowMajor factor = matrix.llt().matrixU();
  matrix = factor;
  return 0;
}

namespace tactus::internal::client {
namespace {

struct FreeModel {
  void operator()(ghmm_cmodel* model) const { ghmm_cmodel_free(&model); }
};
using GhmmModel = std::unique_ptr<ghmm_cmodel, FreeModel>;

void SetEmission(const GaussianHmm& model, int state, ghmm_c_emission& e) {
  const int d = model.dimensions;
  e.dimension = d;
  RowMajor covariance(d, d);
  FullCovariance(model, state, covariance.data());
  if (d == 1) {
    e.type = normal;
    e.mean.val = model.means[state];
    e.variance.val = covariance(0, 0);
    return;
  }
  e.type = multinormal;
  ghmm_c_emission_alloc(&e, d);
  const RowMajor inverse = covariance.inverse();
  for (int k = 0; k < d; ++k) e.mean.vec[k] = model.means[state * d + k];
  for (int k = 0; k < d * d; ++k) {
    e.variance.mat[k] = covariance.data()[k];
    e.sigmainv[k] = inverse.data()[k];
  }
  e.det = covariance.determinant();
}

GhmmModel Convert(const GaussianHmm& model) {
  const int n = model.states;
  GhmmModel out(ghmm_cmodel_calloc(
      n,
      GHMM_kContinuousHMM | (model.dimensions > 1 ? GHMM_kMultivariate : 0)));
  out->M = 1;
  out->dim = model.dimensions;
  out->cos = 1;
  out->prior = -1;
  const auto probability = [&](int i, int j) {
    return model.transition[static_cast<size_t>(i) * n + j];
  };
  for (int s = 0; s < n; ++s) {
    std::vector<int> next;
    std::vector<int> previous;
    for (int k = 0; k < n; ++k) {
      if (probability(s, k) > 0) next.push_back(k);
      if (probability(k, s) > 0) previous.push_back(k);
    }
    ghmm_cstate& state = out->s[s];
    ghmm_cstate_alloc(&state, 1, static_cast<int>(previous.size()),
                      static_cast<int>(next.size()), 1);
    state.M = 1;
    state.pi = model.start[s];
    state.out_states = static_cast<int>(next.size());
    state.in_states = static_cast<int>(previous.size());
    for (size_t k = 0; k < next.size(); ++k) {
      state.out_id[k] = next[k];
      state.out_a[0][k] = probability(s, next[k]);
    }
    for (size_t k = 0; k < previous.size(); ++k) {
      state.in_id[k] = previous[k];
      state.in_a[0][k] = probability(previous[k], s);
    }
    state.c[0] = 1;
    SetEmission(model, s, state.e[0]);
  }
  return out;
}

struct FreeSequences {
  void operator()(ghmm_cseq* data) const { ghmm_cseq_free(&data); }
};
using GhmmSequences = std::unique_ptr<ghmm_cseq, FreeSequences>;

GhmmSequences Convert(const std::vector<SequenceView>& sequences) {
  GhmmSequences data(ghmm_cseq_calloc(static_cast<long>(sequences.size())));
  data->dim = sequences.front().dimensions;
  for (size_t s = 0; s < sequences.size(); ++s) {
    const size_t count = static_cast<size_t>(sequences[s].frames) * data->dim;
    data->seq[s] = static_cast<double*>(std::malloc(count * sizeof(double)));
    std::copy_n(sequences[s].data, count, data->seq[s]);
    data->seq_len[s] = static_cast<int>(count);
    data->seq_w[s] = 1;
  }
  return data;
}

class Peer : public GhmmPeer {
 public:
  explicit Peer(const GaussianHmm& model)
      : initial_(model), ghmm_(Convert(model)) {}

  // Lengths count numbers, not frames, whatever libghmm's documentation says.
  absl::StatusOr<double> LogLikelihood(
      std::span<double> observations) override {
    double log_likelihood = 0;
    if (ghmm_cmodel_logp(ghmm_.get(), observations.data(),
                         static_cast<int>(observations.size()),
                         &log_likelihood) != 0) {
      return NumericalFailure("libghmm gives no log-likelihood");
    }
    return log_likelihood;
  }

  absl::StatusOr<double> ViterbiScore(std::span<double> observations) override {
    double score = 0;
    int* path =
        ghmm_cmodel_viterbi(ghmm_.get(), observations.data(),
                            static_cast<int>(observations.size()), &score);
    if (path == nullptr) return NumericalFailure("libghmm finds no path");
    std::free(path);
    return score;
  }

  absl::Status Train(const std::vector<SequenceView>& sequences,
                     int iterations) override {
    const GhmmSequences data = Convert(sequences);
    double log_likelihood = 0;
    ghmm_cmodel_baum_welch_context context = {.smo = ghmm_.get(),
                                              .sqd = data.get(),
                                              .logp = &log_likelihood,
                                              .eps = 1e-9,
                                              .max_iter = iterations};
    if (ghmm_cmodel_baum_welch(&context) != 0) {
      return NumericalFailure("libghmm does not train");
    }
    return absl::OkStatus();
  }

  GaussianHmm model() const override {
    const size_t n = initial_.states;
    const size_t d = initial_.dimensions;
    GaussianHmm out = WithCovarianceType(initial_, CovarianceType::kFull);
    for (size_t s = 0; s < n; ++s) {
      const ghmm_cstate& state = ghmm_->s[s];
      out.start[s] = state.pi;
      for (int k = 0; k < state.out_states; ++k) {
        out.transition[s * n + state.out_id[k]] = state.out_a[0][k];
      }
      const ghmm_c_emission& e = state.e[0];
      std::copy_n(d == 1 ? &e.mean.val : e.mean.vec, d, &out.means[s * d]);
      std::copy_n(d == 1 ? &e.variance.val : e.variance.mat, d * d,
                  &out.covariances[s * d * d]);
    }
    return out;
  }

 private:
  const GaussianHmm initial_;
  GhmmModel ghmm_;
};

}  // namespace

std::unique_ptr<GhmmPeer> MakeGhmmPeer(const GaussianHmm& model) {
  ghmm_set_loglevel(0);  // what fails, the status says
  return std::make_unique<Peer>(model);
}

}  // namespace tactus::internal::client
