#include <algorithm>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/bundle/bundle.h"
#include "core/classify/compiled_model.h"
#include "core/classify/contact_pipeline.h"
#include "core/features/contact_tracker.h"
#include "core/sim/experiments/random_world.h"
#include "server/registry/default_bundle.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/rendered_frames.h"
#include "tests/bench/timing.h"

namespace tactus::client {
namespace {

constexpr int kTrials = 8;
// Of the built-in models' test contacts (docs/results/world.md).
constexpr uint64_t kSeed = 1001;

// Contacts of the random world as the skin `good` records them, on which the
// built-in models were trained.
absl::StatusOr<std::vector<RenderedTrial>> WorldTrials(const SkinModel& skin) {
  std::vector<RenderedTrial> trials;
  for (uint64_t n = 0; static_cast<int>(trials.size()) < kTrials; ++n) {
    TACTUS_ASSIGN_OR_RETURN(const Trial trial, WorldTrial(skin, kSeed, n));
    ContactTracker tracker(skin.layout, {.release_after_s = -1});
    RenderedTrial to;
    to.taxels = skin.layout.taxels();
    to.poses = trial.poses;
    to.lead_in = to.frames();
    to.values.resize(trial.taxels.frames() * to.taxels);
    for (int t = 0; t < to.frames(); ++t) {
      trial.taxels.Decode(t, &to.values[size_t(t) * to.taxels]);
      tracker.Step(to.frame(t));
      if (tracker.onset()) to.lead_in = t;
    }
    if (to.lead_in < to.frames()) trials.push_back(std::move(to));
  }
  return trials;
}

// Nanoseconds of a frame before the onset and of one after it, each the sum of
// the trials' medians.
struct FrameTimes {
  double idle = 0;
  double contact = 0;
};

// Runs the trials in turns through each of several parts of the path.
class FrameTimer {
 public:
  explicit FrameTimer(const std::vector<RenderedTrial>& trials)
      : trials_(&trials), idle_(trials.size()), contact_(trials.size()) {}

  // `reset` before and `step` on each frame of a trial.
  template <typename Reset, typename Step>
  void Run(size_t trial, const Reset& reset, const Step& step) {
    const RenderedTrial& frames = (*trials_)[trial];
    reset();
    int t = 0;
    const auto time = [&](int end) {
      const double start = ThreadSeconds();
      for (; t < end; ++t) step(t);
      return ThreadSeconds() - start;
    };
    idle_[trial].push_back(time(frames.lead_in));
    contact_[trial].push_back(time(frames.frames()));
  }

  FrameTimes Result() const {
    FrameTimes times;
    double idle_frames = 0;
    double contact_frames = 0;
    for (size_t i = 0; i < trials_->size(); ++i) {
      times.idle += Percentile(idle_[i], 0.5);
      times.contact += Percentile(contact_[i], 0.5);
      idle_frames += (*trials_)[i].lead_in;
      contact_frames += (*trials_)[i].frames() - (*trials_)[i].lead_in;
    }
    times.idle *= 1e9 / idle_frames;
    times.contact *= 1e9 / contact_frames;
    return times;
  }

 private:
  const std::vector<RenderedTrial>* trials_;
  std::vector<std::vector<double>> idle_;
  std::vector<std::vector<double>> contact_;
};

class SessionBenchmark : public Benchmark {
 public:
  const char* name() const override { return "session"; }
  const char* description() const override {
    return "The whole per-frame path with the default bundle";
  }

  absl::StatusOr<std::vector<BenchRow>> Run(bool quick) override {
    TACTUS_ASSIGN_OR_RETURN(const auto compiled,
                            DecodeBundle(server::DefaultBundle()));
    TACTUS_RETURN_IF_ERROR(RunWarmUp(*compiled));
    TACTUS_ASSIGN_OR_RETURN(const SkinModel skin, SkinModelNamed("good"));
    TACTUS_ASSIGN_OR_RETURN(const auto trials, WorldTrials(skin));
    SkinLayout without = skin.layout;
    without.light_touch.reset();

    std::vector<BenchRow> rows;
    for (const bool light : {true, false}) {
      const SkinLayout& layout = light ? skin.layout : without;
      TACTUS_ASSIGN_OR_RETURN(const auto pipeline,
                              ContactPipeline::Create(layout, compiled, {}));
      ContactTracker tracker(layout, {.load_profile = false});
      FrameTimer whole(trials);
      FrameTimer features(trials);
      const int repetitions = quick ? 2 : 31;
      for (size_t n = 0; n < trials.size(); ++n) {
        const RenderedTrial& trial = trials[n];
        for (int i = 0; i < repetitions; ++i) {
          whole.Run(
              n, [&] { pipeline->EndTrial(); },
              [&](int t) { pipeline->Step(trial.frame(t)); });
          features.Run(
              n, [&] { tracker.Reset(); },
              [&](int t) { tracker.Step(trial.frame(t)); });
        }
      }
      const std::string suffix = light ? "" : "_without_light_touch";
      const FrameTimes all = whole.Result();
      const FrameTimes part = features.Result();
      const auto add = [&](const char* name, double ours) {
        rows.push_back({.name = absl::StrCat("session/", name, suffix),
                        .unit = "ns",
                        .ours = ours});
      };
      add("contact", all.contact);
      add("contact_features", part.contact);
      add("idle", all.idle);
      add("idle_features", part.idle);
    }
    return rows;
  }
};

}  // namespace

std::unique_ptr<Benchmark> MakeSessionBenchmark() {
  return std::make_unique<SessionBenchmark>();
}

}  // namespace tactus::client
