// File: fit_fields.h
//
// The fields of everything that a saved part of a fit holds or depends on, for
// archive.h. Options are taken apart by structured bindings, so that a new
// option does not compile before it is part of the fingerprint.
//
//   ByteWriter writer;
//   writer(options, *model);
//
// Thread-safe: free functions without state.
#pragma once

#include "core/contacts/labelled_contact.h"
#include "core/train/archive.h"
#include "core/train/calibrate.h"
#include "core/train/fit_options.h"

namespace tactus::internal {

template <class Archive>
void Fields(Archive& archive, GaussianHmm& hmm) {
  archive(hmm.states, hmm.dimensions, hmm.covariance_type, hmm.start,
          hmm.transition, hmm.means, hmm.covariances);
}
template <class Archive>
void Fields(Archive& archive, HmmMixture& mixture) {
  archive(mixture.log_weight, mixture.components);
}

template <class Archive>
void Fields(Archive& archive, Ridge& ridge) {
  HistorySpec& history = ridge.history;
  for (float& scale : history.scale) archive(scale);
  archive(history.rows, history.columns, history.block, history.planes,
          history.auxiliary_scale, history.mixed_channel, history.mixed_weight,
          history.threshold, ridge.offset, ridge.gain, ridge.weight,
          ridge.bias);
}

template <class Archive>
void Fields(Archive& archive, Trees& trees) {
  HistorySpec& history = trees.history;
  for (float& scale : history.scale) archive(scale);
  archive(history.rows, history.columns, history.block, history.planes,
          history.auxiliary_scale, trees.classes, trees.number, trees.threshold,
          trees.child, trees.root);
}

template <class Archive>
void Fields(Archive& archive, Nearest& nearest) {
  FrameViews& views = nearest.views;
  for (float& scale : views.scale) archive(scale);
  archive(views.rows, views.columns, views.block, views.planes,
          views.auxiliary_scale, nearest.view, nearest.gain, nearest.sample,
          nearest.label, nearest.classes);
}

template <class Archive>
void Fields(Archive& archive, LstmLayer& layer) {
  archive(layer.inputs, layer.cells, layer.kernel, layer.recurrent, layer.bias);
}
template <class Archive>
void Fields(Archive& archive, LstmNetwork& network) {
  archive(network.activation, network.gate_activation, network.layers,
          network.regressions, network.dense_kernel, network.dense_bias);
}
template <class Archive>
void Fields(Archive& archive, OptimizerState& state) {
  archive(state.mean, state.mean_square, state.steps);
}
template <class Archive>
void Fields(Archive& archive, LstmEpoch& epoch) {
  archive(epoch.epoch, epoch.train_loss, epoch.train_accuracy,
          epoch.validation_loss, epoch.validation_accuracy);
}
template <class Archive>
void Fields(Archive& archive, LstmCheckpoint& checkpoint) {
  archive(checkpoint.network, checkpoint.optimizer, checkpoint.history,
          checkpoint.best_epoch, checkpoint.best);
}

template <class Archive>
void Fields(Archive& archive, ObjectEstimate& estimate) {
  archive(estimate.log10_stiffness, estimate.log10_stiffness_deviation,
          estimate.moved_m, estimate.moved_deviation_m);
}
template <class Archive>
void Fields(Archive& archive, ScoredContact::Estimate& estimate) {
  archive(estimate.estimate, estimate.log10_stiffness, estimate.moved_m);
}
template <class Archive>
void Fields(Archive& archive, ScoredContact& scored) {
  archive(scored.labels, scored.log_likelihood, scored.lstm_score,
          scored.estimates, scored.hmm_steps, scored.log10_stiffness,
          scored.bounded);
}

template <class Archive>
void Fields(Archive& archive, StepIntervals& steps) {
  archive(steps.min, steps.max, steps.first, steps.divisor);
}
template <class Archive>
void Fields(Archive& archive, ModelInput& input) {
  archive(input.cue, input.log_offset, input.offset, input.gain, input.limit);
}
template <class Archive>
void Fields(Archive& archive, TaxelEmbedding& embedding) {
  archive(embedding.taxels, embedding.dimensions, embedding.weights);
}
template <class Archive>
void Fields(Archive& archive, InputSpec& spec) {
  archive(spec.hmm, spec.hmm_steps, spec.lstm, spec.lstm_steps,
          spec.sample_rate_hz, spec.embedding);
}

template <class Archive>
void Fields(Archive& archive, OptimizerOptions& options) {
  auto& [optimizer, rate, rms_decay, first_decay, second_decay, epsilon,
         weight_decay, clip] = options;
  archive(optimizer, rate, rms_decay, first_decay, second_decay, epsilon,
          weight_decay, clip);
}
template <class Archive>
void Fields(Archive& archive, LstmLossOptions& options) {
  auto& [steps, first_step, stride, smoothing, regression_weight] = options;
  archive(steps, first_step, stride, smoothing, regression_weight);
}
template <class Archive>
void Fields(Archive& archive, LstmNoise& noise) {
  auto& [dropout, input] = noise;
  archive(dropout, input);
}
template <class Archive>
void Fields(Archive& archive, LstmTrainOptions& options) {
  auto& [epochs, batch_size, optimizer, cosine_decay, loss, noise, seed,
         patience, shards] = options;
  archive(epochs, batch_size, optimizer, cosine_decay, loss, noise, seed,
          patience, shards);
}
template <class Archive>
void Fields(Archive& archive, LstmFit& fit) {
  auto& [networks, cues, scaling, limit, stretched_cues, stretches, steps,
         cells, estimates, estimator_cells, activation, gate_activation,
         training] = fit;
  archive(networks, cues, scaling, limit, stretched_cues, stretches, steps,
          cells, estimates, estimator_cells, activation, gate_activation,
          training);
}
template <class Archive>
void Fields(Archive& archive, VariationRange& range) {
  auto& [copies, pace, load, stiffness] = range;
  archive(copies, pace, load, stiffness);
}
template <class Archive>
void Fields(Archive& archive, Question& question) {
  archive(question.name, question.kind, question.values,
          question.value_of_class);
}
template <class Archive>
void Fields(Archive& archive, QuestionTable& table) {
  archive(table.class_names, table.questions);
}
template <class Archive>
void Fields(Archive& archive, FitOptions& options) {
  auto& [learner, features, hmm_cues, log_features, hmm_steps, states,
         hmms_per_class, score, max_iterations, covariance_floor, lstm,
         questions, truth, variations, inner_folds, calibration_folds, held_out,
         calibrate, shares, seed] = options;
  archive(learner, features, hmm_cues, log_features, hmm_steps, states,
          hmms_per_class, score, max_iterations, covariance_floor, lstm,
          questions, truth, variations, inner_folds, calibration_folds,
          held_out, calibrate, shares, seed);
}

}  // namespace tactus::internal
