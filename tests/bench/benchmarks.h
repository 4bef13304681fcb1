// File: benchmarks.h
//
// Every sub-benchmark of tactus-bench. Each function creates one; its comment
// names the rows that it prints and what makes it fail.
//
//   std::unique_ptr<Benchmark> benchmark = MakeHmmBenchmark();
//   TACTUS_ASSIGN_OR_RETURN(auto rows, benchmark->Run(/*quick=*/true));
//
// Thread-safe: functions without state. A benchmark belongs to one thread.
#pragma once

#include <memory>

#include "tests/bench/benchmark.h"

namespace tactus::internal::client {

// Segmentation of skin frames, compared with OpenCV's connected components.
// Rows features/contact, features/contact_flat (columns do not wrap) and
// features/idle (nothing touches the skin): ns per frame of 16 x 24 taxels,
// threshold included. The peer's regions end at the seam where ours wrap;
// joining them would cost the peer more. Fails unless both find the same
// regions in a million random frames; there the peer's regions are joined
// across the seam.
std::unique_ptr<Benchmark> MakeFeaturesBenchmark();

// LSTM networks stepped frame by frame, compared with PyTorch. Rows lstm/step
// and lstm/step_tuned: ns per frame of one stream, two layers of 50 cells, with
// the paper's three inputs and with the inputs of the preset `tuned`. Row
// lstm/batch64: ns per frame of 64 streams in step. The error is that of the
// probabilities; above 1e-5 the benchmark fails.
std::unique_ptr<Benchmark> MakeLstmBenchmark();

// One step of LSTM training, compared with PyTorch. Row train-lstm/step: ms for
// one batch of five contacts of 500 frames through two layers of 50 cells:
// forward, backward and RMSprop. There is no dropout because the random numbers
// would differ. The error is that of the gradient, relative to its largest
// entry; above 1e-4 the benchmark fails.
std::unique_ptr<Benchmark> MakeTrainLstmBenchmark();

// The whole per-frame path with the default bundle: the server's cost of a
// stream without its messages, on contacts of the random world as the skin
// `good` records them. Rows session/contact (ns per frame of a contact at 100
// Hz, from the first touch on), session/idle (ns per frame without touch),
// session/contacts_N (N small objects pressed at once, far apart), the same of
// the features alone, and all of these without light touch. The row
// session/further_contact says what each contact beyond the first costs, beside
// its classifier's step. Fails if the bundle does not give its stored answers,
// or if N objects are not N contacts.
std::unique_ptr<Benchmark> MakeSessionBenchmark();

// What it costs a stream of contacts of the random world that somebody could
// watch it (row watched/unwatched), that somebody does (row watched/watched),
// and that its contacts are kept (row watched/kept): ns of a frame beside the
// same stream that nobody can see.
std::unique_ptr<Benchmark> MakeWatchedBenchmark();

// The learners for few trials, of 300 made-up contacts of 20 x 20 taxels in 2
// and in 20 classes. Rows few-trials/LEARNER/N_classes/: frame (ns of a step),
// answer (ns of the scores), stream (KiB of memory), fit (s of one core).
std::unique_ptr<Benchmark> MakeFewTrialsBenchmark();

// Each rule of skip_rules.h on and off, on 64 contacts of the random world as
// the skin `good` records them, with the default bundle. Rows skipping/RULE: ns
// per frame, before the onset or after it, whichever the rule is for. The error
// is the largest change of a probability at a contact's end. Fails if a rule
// changes one.
std::unique_ptr<Benchmark> MakeSkippingBenchmark();

// The built-in model on held-out contacts of the random world, as it is served
// and with steps of its LSTMs left out: run time of the classifier against
// wrong answers. Rows served/FAMILY/VARIANT (ns per contact frame).
std::unique_ptr<Benchmark> MakeServedBenchmark();

// `trainctl fit` of the preset `tuned` (one network, two epochs, five HMMs a
// class) on more and more contacts of the random world, ideal signals. Rows
// fit-scale/TRIALS/time (s of processor time) and fit-scale/TRIALS/memory (MB,
// the peak). --table and --figure show the same.
std::unique_ptr<Benchmark> MakeFitScaleBenchmark();

// Work and precision of the contact simulator: processor time on one core and
// the largest error of the noiseless features, for the exact method and for
// CVODE at several tolerances, on the same trials. Errors are relative to the
// feature's peak in the trial, against the independent integration of
// tests/reference/sim. Rows sim/paper-set, sim/SAMPLE/exact,
// sim/SAMPLE/CVODE-TOLERANCE and, with --all, sim/random-scenes. --table and
// --figure (work_precision.h) show the same points. Fails with
// NUMERICAL_FAILURE if an error of the exact method exceeds its stated bound.
// The comparisons and the worst scenes go to stderr.
std::unique_ptr<Benchmark> MakeSimBenchmark();

// How long the first frame after a silence waits for its answer. On an idle
// server this is the moment a touch begins. Rows idle/first_frame_p50, _p90,
// _p99 and _max: ms from sending a frame to receiving its posterior.
std::unique_ptr<Benchmark> MakeIdleBenchmark();

// Scoring one frame with HMMs, compared with libghmm, and the error of a long
// contact's score, compared with long double. Rows hmm/forward and hmm/viterbi:
// ns per frame and model, 4 left-right models of 10 states and 3 features. Row
// hmm/default-bundle: ns per frame of the default bundle's shape, 4 classes
// of 20 such models.
std::unique_ptr<Benchmark> MakeHmmBenchmark();

// Baum-Welch on one core, compared with libghmm from the same start on the same
// trials. Row train-hmm/iteration: ns per frame and iteration, a left-right
// model of 10 states and 3 features. The error is the difference of the two
// log-likelihoods after convergence.
std::unique_ptr<Benchmark> MakeTrainHmmBenchmark();

// The cost of a tactusd stream above gRPC itself: throughput and round trip of
// one stream, compared with an echo server of messages of the same sizes. Both
// servers are child processes and take turns. Rows stream/throughput,
// _rtt_p50, _server_cpu and _superseded: frames of contacts and of untouched
// skin alternate. Rows stream/untouched_throughput and _rtt_p50: no contacts,
// so the models have little to do. Rows stream/echo_callback_vs_cq_throughput,
// _rtt_p50 and _server_cpu compare an echo by callbacks with an echo by a
// completion queue. Rows stream/proxied_throughput and _rtt_p50: the first two
// through HAProxy with deploy/haproxy.cfg, server and echo alike, and
// stream/proxy_added_rtt_p50: what the proxy adds to the round trip of each.
// Without HAProxy these rows are left out.
std::unique_ptr<Benchmark> MakeStreamBenchmark();

// How long answers stop when the server is killed (SIGKILL) in the middle of a
// contact and started again 50 ms later, as deploy/tactusd.service does. Rows
// restart/gap_p50 and _max: the longest time in ms between two answers that
// follow each other; gap_without: the same if it is not killed; proxied_:
// through HAProxy with deploy/haproxy.cfg. Fails if the final probabilities of
// a killed contact are not those of a whole one, bit for bit.
std::unique_ptr<Benchmark> MakeRestartBenchmark();

// How many robots one tactusd serves while the load generator of
// tools/load runs on the same processors. Rows load/200x100_p50, _p99
// and _lost. Rows load/max_robots_1_per_message and _4_per_message: the largest
// number of robots at 100 Hz that lose no frame and keep the p99 from due time
// to answer below 10 ms.
std::unique_ptr<Benchmark> MakeLoadBenchmark();

// Start-up time and memory of tactusd. Row startup/serving: time from the start
// until the server reports SERVING. Row startup/stream_memory: memory per
// configured stream that shares one of 8 connections; _played after each has
// sent its first frame. Row startup/connection_memory: memory per configured
// stream with its own connection.
std::unique_ptr<Benchmark> MakeStartupBenchmark();

// The training service of one tactusd. Row training/upload: MB of records a
// second over a unix socket, with reading the trials. Row
// training/first_iteration: time from TrainModel to the first point of the
// learning curve; _signals for the paper's trials as ideal signals. Row
// training/100x100_p99: ms from due time to answer of 100 robots at 100 Hz
// during a training and promotions; the peer is the same server without them,
// measured in turns.
std::unique_ptr<Benchmark> MakeTrainingBenchmark();

// Run time and error of three kinds of variants, each kind on the same
// contacts, with the Pareto front: classifiers of several sizes and step
// intervals, HMM scores in several precisions, simulators of several methods
// and tolerances. The models are fitted in the run to the paper's trials and
// tested at robot conditions that were not trained at. Rows
// frontier/COMPARISON/VARIANT; --table and --figures (frontier.h) show the same
// points. Fails with NUMERICAL_FAILURE if an error of a precision or of the
// exact simulator exceeds its stated bound, if a part of a model answers
// differently alone, if a skip rule changes an answer, or if the answers are
// hardly better than guesses.
std::unique_ptr<Benchmark> MakeFrontierBenchmark();

}  // namespace tactus::internal::client
