#include "core/lstm/train.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/random.h"
#include "core/base/status_macros.h"
#include "core/lstm/batch_gradient.h"

namespace tactus::internal {
namespace {

// Number of sequences that run together during validation.
constexpr size_t kValidationBatch = 32;

// Even streams of random numbers shuffle the epochs; odd ones draw the noise of
// batches.
Random RandomOfEpoch(uint64_t seed, uint64_t epoch) {
  return Random::ForStream(seed, 2 * epoch);
}

absl::Status CheckOptions(const LstmTrainOptions& options,
                          std::span<const LstmSequence> validation) {
  TACTUS_RETURN_IF_ERROR(Validate(options.optimizer));
  TACTUS_RETURN_IF_ERROR(Validate(options.loss));
  TACTUS_RETURN_IF_ERROR(Validate(options.noise));
  if (options.epochs < 1) {
    return InvalidConfig("epochs", options.epochs, "at least 1");
  }
  if (options.batch_size < 1) {
    return InvalidConfig("batch_size", options.batch_size, "at least 1");
  }
  if (options.shards < 1) {
    return InvalidConfig("shards", options.shards, "at least 1");
  }
  if (options.patience < 0 || (options.patience > 0 && validation.empty())) {
    return InvalidConfig("patience", options.patience,
                         "0, or above with validation sequences");
  }
  return absl::OkStatus();
}

// Checks that `from` is an initial network, or a checkpoint of these options.
absl::Status CheckStart(const LstmCheckpoint& from,
                        const LstmTrainOptions& options) {
  TACTUS_RETURN_IF_ERROR(Validate(from.network));
  if (!from.network.hidden.empty()) {
    return InvalidModel("lstm.hidden", from.network.hidden.size(),
                        "0: networks with hidden layers are not trained");
  }
  const OptimizerState& optimizer = from.optimizer;
  const size_t moments =
      optimizer.steps == 0 ? 0 : from.network.parameter_count();
  const bool adam = options.optimizer.optimizer == Optimizer::kAdam;
  if (optimizer.mean_square.size() != moments ||
      optimizer.mean.size() != (adam ? moments : 0)) {
    return InvalidModel("checkpoint.optimizer",
                        "not the optimizer's of this network",
                        "as a checkpoint with the same options has it");
  }
  const bool has_best = options.patience > 0 && !from.history.empty();
  const int epochs = has_best ? static_cast<int>(from.history.size()) : 0;
  if (from.best_epoch < (has_best ? 1 : 0) || from.best_epoch > epochs) {
    return InvalidModel("checkpoint.best_epoch", from.best_epoch,
                        absl::StrCat(has_best ? 1 : 0, " to ", epochs));
  }
  return has_best ? Annotate(Validate(from.best), "checkpoint.best")
                  : absl::OkStatus();
}

class Trainer {
 public:
  Trainer(LstmCheckpoint from, LstmSequenceSource& training,
          std::span<const LstmSequence> validation,
          const LstmTrainOptions& options, Ranks& ranks)
      : state_(std::move(from)),
        training_(training),
        validation_(validation),
        options_(options),
        batches_(state_.network, training, options, ranks),
        gradient_(state_.network) {}

  absl::StatusOr<LstmTrained> Run(LstmEpochSink on_epoch,
                                  LstmBatchCheck before_batch) {
    while (epoch() < options_.epochs && !HasStalled()) {
      LstmEpoch done;
      done.epoch = epoch() + 1;
      TACTUS_RETURN_IF_ERROR(TrainEpoch(before_batch, done));
      TACTUS_RETURN_IF_ERROR(ValidateEpoch(done));
      state_.history.push_back(done);
      if (options_.patience > 0) KeepBest();
      TACTUS_RETURN_IF_ERROR(on_epoch(done, state_));
    }
    const bool best = options_.patience > 0;
    return LstmTrained{
        .network = std::move(best ? state_.best : state_.network),
        .epoch = best ? state_.best_epoch : epoch(),
        .history = std::move(state_.history)};
  }

 private:
  // Epochs done.
  int epoch() const { return static_cast<int>(state_.history.size()); }

  bool HasStalled() const {
    return options_.patience > 0 &&
           epoch() - state_.best_epoch >= options_.patience;
  }

  double LearningRate() const {
    const double full = options_.optimizer.learning_rate;
    if (!options_.cosine_decay) return full;
    const size_t batches =
        (training_.size() + options_.batch_size - 1) / options_.batch_size;
    const double steps =
        static_cast<double>(batches) * static_cast<double>(options_.epochs);
    const double done = static_cast<double>(state_.optimizer.steps) / steps;
    return full * 0.5 * (1 + std::cos(std::numbers::pi * done));
  }

  void Shuffle() {
    order_.resize(training_.size());
    std::iota(order_.begin(), order_.end(), size_t{0});
    Random random = RandomOfEpoch(options_.seed, epoch());
    for (size_t i = order_.size(); i > 1; --i) {
      std::swap(order_[i - 1], order_[random.Index(i)]);
    }
  }

  absl::Status TrainEpoch(LstmBatchCheck before_batch, LstmEpoch& done) {
    Shuffle();
    const size_t batch_size = options_.batch_size;
    LstmBatchLoss total;
    for (size_t from = 0; from < order_.size(); from += batch_size) {
      TACTUS_RETURN_IF_ERROR(before_batch());
      TACTUS_RETURN_IF_ERROR(
          TrainBatch(std::span(order_).subspan(
                         from, std::min(batch_size, order_.size() - from)),
                     done.epoch, total));
    }
    const auto count = static_cast<double>(training_.size());
    done.train_loss = total.sum / count;
    done.train_accuracy = total.correct / count;
    if (!Validate(state_.network).ok()) {
      return NumericalFailure(
          absl::StrCat("an LSTM weight outgrew its limit in epoch ", done.epoch,
                       "; a smaller learning rate may help"));
    }
    return absl::OkStatus();
  }

  absl::Status TrainBatch(std::span<const size_t> numbers, int epoch,
                          LstmBatchLoss& total) {
    TACTUS_ASSIGN_OR_RETURN(
        const LstmBatchLoss loss,
        batches_.Compute(state_.network, numbers, state_.optimizer.steps,
                         gradient_));
    const double norm =
        ClipGradient(options_.optimizer.gradient_clip, gradient_);
    if (!std::isfinite(loss.sum) || !std::isfinite(norm)) {
      return NumericalFailure(absl::StrCat(
          "LSTM loss ", loss.sum, " and gradient ", norm, " in epoch ", epoch,
          "; want finite; a smaller learning rate may help"));
    }
    OptimizerStep(options_.optimizer, LearningRate(), gradient_,
                  state_.optimizer, state_.network);
    total.sum += loss.sum;
    total.correct += loss.correct;
    return absl::OkStatus();
  }

  absl::Status ValidateEpoch(LstmEpoch& done) {
    if (validation_.empty()) return absl::OkStatus();
    LstmBackprop backprop(state_.network);
    backprop.SetWeights(state_.network);
    LstmBatchLoss total;
    for (size_t from = 0; from < validation_.size(); from += kValidationBatch) {
      Random unused(0);
      backprop.Forward(
          validation_.subspan(
              from, std::min(kValidationBatch, validation_.size() - from)),
          {}, unused);
      const LstmBatchLoss loss = backprop.Loss(options_.loss);
      total.sum += loss.sum;
      total.correct += loss.correct;
    }
    const auto count = static_cast<double>(validation_.size());
    done.validation_loss = total.sum / count;
    done.validation_accuracy = total.correct / count;
    if (std::isfinite(done.validation_loss)) return absl::OkStatus();
    return NumericalFailure(absl::StrCat("LSTM validation loss ",
                                         done.validation_loss, " in epoch ",
                                         done.epoch, "; want finite"));
  }

  void KeepBest() {
    if (state_.best_epoch > 0 &&
        state_.history.back().validation_loss >=
            state_.history[state_.best_epoch - 1].validation_loss) {
      return;
    }
    state_.best = state_.network;
    state_.best_epoch = epoch();
  }

  LstmCheckpoint state_;
  LstmSequenceSource& training_;
  std::span<const LstmSequence> validation_;
  const LstmTrainOptions& options_;
  BatchGradient batches_;
  LstmNetwork gradient_;
  std::vector<size_t> order_;
};

}  // namespace

absl::StatusOr<LstmTrained> TrainLstm(LstmCheckpoint from,
                                      std::span<const LstmSequence> training,
                                      std::span<const LstmSequence> validation,
                                      const LstmTrainOptions& options,
                                      LstmEpochSink on_epoch,
                                      LstmBatchCheck before_batch) {
  TACTUS_RETURN_IF_ERROR(Validate(from.network));
  TACTUS_RETURN_IF_ERROR(
      Annotate(Validate(training, from.network), "training"));
  LstmSequencesInMemory source(training);
  return TrainLstm(std::move(from), source, validation, options, on_epoch,
                   before_batch);
}

absl::StatusOr<LstmTrained> TrainLstm(
    LstmCheckpoint from, LstmSequenceSource& training,
    std::span<const LstmSequence> validation, const LstmTrainOptions& options,
    LstmEpochSink on_epoch, LstmBatchCheck before_batch, Ranks* ranks) {
  TACTUS_RETURN_IF_ERROR(CheckOptions(options, validation));
  TACTUS_RETURN_IF_ERROR(CheckStart(from, options));
  TACTUS_RETURN_IF_ERROR(
      Annotate(Validate(validation, from.network), "validation"));
  if (training.size() == 0) return InvalidTrainingData("no training sequences");
  OneRank alone;
  return Trainer(std::move(from), training, validation, options,
                 ranks == nullptr ? alone : *ranks)
      .Run(on_epoch, before_batch);
}

}  // namespace tactus::internal
