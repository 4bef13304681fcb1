#include <vector>

#include "core/base/status_macros.h"
#include "core/bundle/bundle.h"
#include "core/classify/compiled_model.h"
#include "core/classify/contact_pipeline.h"
#include "server/registry/default_bundle.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/rendered_frames.h"
#include "tests/bench/timing.h"

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
    TACTUS_ASSIGN_OR_RETURN(const SkinLayout layout,
                            LayoutPreset("cody-forearm"));
    TACTUS_ASSIGN_OR_RETURN(const auto pipeline,
                            ContactPipeline::Create(layout, compiled, {}));
    TACTUS_ASSIGN_OR_RETURN(const auto trials, RenderTrials(layout, kTrials));
    const int repetitions = quick ? 2 : 15;

    // Frames differ, as the networks step on few of them: each frame's median
    // counts.
    double contact = 0;
    int contact_frames = 0;
    for (const RenderedTrial& trial : trials) {
      std::vector<std::vector<double>> seconds(trial.frames());
      for (int i = 0; i < repetitions; ++i) {
        pipeline->EndTrial();
        for (int t = trial.lead_in; t < trial.frames(); ++t) {
          seconds[t].push_back(
              SecondsOf([&] { pipeline->Step(trial.frame(t)); }));
        }
      }
      for (int t = trial.lead_in; t < trial.frames(); ++t) {
        contact += Percentile(seconds[t], 0.5);
        ++contact_frames;
      }
    }
    pipeline->EndTrial();
    constexpr int kRounds = 10;
    const double idle = MedianSeconds(repetitions, [&] {
      for (int round = 0; round < kRounds; ++round) {
        for (const RenderedTrial& trial : trials) {
          for (int t = 0; t + 1 < trial.lead_in; ++t) {
            pipeline->Step(trial.frame(t));
          }
        }
      }
    });
    const int idle_frames = kRounds * kTrials * (trials[0].lead_in - 1);
    return std::vector<BenchRow>{{.name = "session/contact",
                                  .unit = "ns",
                                  .ours = contact / contact_frames * 1e9},
                                 {.name = "session/idle",
                                  .unit = "ns",
                                  .ours = idle / idle_frames * 1e9}};
  }
};

}  // namespace

std::unique_ptr<Benchmark> MakeSessionBenchmark() {
  return std::make_unique<SessionBenchmark>();
}

}  // namespace tactus::client
