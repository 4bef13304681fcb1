#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/bundle/bundle.h"
#include "core/classify/compiled_model.h"
#include "core/classify/contact_pipeline.h"
#include "server/registry/default_bundle.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/frame_timer.h"

namespace tactus::internal::client {
namespace {

// A rule and the frames on which it skips.
struct RuleCase {
  const char* name;
  SkipRule rule;
  // Before the onset; else after it.
  bool idle = false;
  bool light_touch = true;
  // How often each frame comes.
  int times = 1;
  ContactClassifier::Options decision = {};
  // No probability may change.
};

const RuleCase kCases[] = {
    {.name = "untouched_frames",
     .rule = SkipRule::kUntouchedFrames,
     .idle = true,
     .light_touch = false},
    {.name = "quiet_rows", .rule = SkipRule::kQuietRows, .idle = true},
    {.name = "unchanged_frames",
     .rule = SkipRule::kUnchangedFrames,
     .light_touch = false,
     .times = 4},
    // No frame comes twice: what the comparison costs.
    {.name = "unchanged_frames_without_any",
     .rule = SkipRule::kUnchangedFrames,
     .light_touch = false},
    {.name = "unused_cues", .rule = SkipRule::kUnusedCues},
    {.name = "unchanged_scores", .rule = SkipRule::kUnchangedScores},
    {.name = "unused_lstms",
     .rule = SkipRule::kUnusedLstms,
     .decision = {.scorers = Scorers::kHmms}},
};

// The largest change of a probability at the end of a contact.
double LargestChange(const ContactPipeline& on, const ContactPipeline& off) {
  const ContactReport* a = on.main_contact();
  const ContactReport* b = off.main_contact();
  if (a == nullptr || b == nullptr) return a == b ? 0 : 1;
  double largest = 0;
  const auto p = a->classifier->probability();
  for (size_t k = 0; k < p.size(); ++k) {
    largest =
        std::max(largest, std::abs(p[k] - b->classifier->probability()[k]));
  }
  return largest;
}

class SkippingBenchmark : public Benchmark {
 public:
  const char* name() const override { return "skipping"; }
  const char* description() const override {
    return "The per-frame path with and without each rule of skip_rules.h";
  }

  absl::StatusOr<std::vector<BenchRow>> Run(bool quick) override {
    TACTUS_ASSIGN_OR_RETURN(model_, DecodeBundle(server::DefaultBundle()));
    TACTUS_ASSIGN_OR_RETURN(skin_, SkinModelNamed("good"));
    TACTUS_ASSIGN_OR_RETURN(trials_, WorldTrials(skin_, quick ? 4 : 64));
    std::vector<BenchRow> rows;
    for (const RuleCase& rule : kCases) {
      TACTUS_RETURN_IF_ERROR(Measure(rule, quick ? 2 : 15, rows));
    }
    return rows;
  }

 private:
  absl::Status Measure(const RuleCase& rule, int repetitions,
                       std::vector<BenchRow>& rows) const {
    SkinLayout layout = skin_.layout;
    if (!rule.light_touch) layout.light_touch.reset();
    ContactPipeline::Options options;
    options.decision = rule.decision;
    TACTUS_ASSIGN_OR_RETURN(const auto on,
                            ContactPipeline::Create(layout, model_, options));
    options.skip[rule.rule] = false;
    TACTUS_ASSIGN_OR_RETURN(const auto off,
                            ContactPipeline::Create(layout, model_, options));
    FrameTimer with(trials_);
    FrameTimer without(trials_);
    double largest = 0;
    for (size_t n = 0; n < trials_.size(); ++n) {
      const auto run = [&](ContactPipeline& pipeline, FrameTimer& timer) {
        timer.Run(
            n, [&] { pipeline.EndTrial(); },
            [&](int t) {
              for (int i = 0; i < rule.times; ++i) {
                pipeline.Step(trials_[n].frame(t));
              }
            });
      };
      for (int i = 0; i < repetitions; ++i) {
        run(*on, with);
        run(*off, without);
      }
      largest = std::max(largest, LargestChange(*on, *off));
    }
    if (largest != 0) {
      return absl::InternalError(
          absl::StrCat("the rule ", rule.name, " changes a probability by ",
                       largest, "; it must change no bit"));
    }
    const auto nanoseconds = [&](const FrameTimer& timer) {
      const FrameTimes times = timer.Result();
      return (rule.idle ? times.idle : times.contact) / rule.times;
    };
    rows.push_back({.name = absl::StrCat("skipping/", rule.name),
                    .unit = "ns",
                    .ours = nanoseconds(with),
                    .peer = nanoseconds(without),
                    .peer_name = "rule off",
                    .error = largest,
                    .error_reference = "probability, rule off"});
    return absl::OkStatus();
  }

  std::shared_ptr<const CompiledModel> model_;
  SkinModel skin_;
  std::vector<RenderedTrial> trials_;
};

}  // namespace

std::unique_ptr<Benchmark> MakeSkippingBenchmark() {
  return std::make_unique<SkippingBenchmark>();
}

}  // namespace tactus::internal::client
