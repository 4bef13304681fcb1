#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/bundle/bundle.h"
#include "core/classify/compiled_model.h"
#include "core/classify/contact_pipeline.h"
#include "core/features/contact_tracker.h"
#include "server/registry/default_bundle.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/frame_timer.h"
#include "tests/bench/rendered_frames.h"

namespace tactus::client {
namespace {

constexpr int kTrials = 8;

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
    TACTUS_ASSIGN_OR_RETURN(const auto trials, WorldTrials(skin, kTrials));
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
