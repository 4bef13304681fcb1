#include <array>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/bundle/bundle.h"
#include "core/classify/compiled_model.h"
#include "core/classify/contact_pipeline.h"
#include "core/features/contact_tracker.h"
#include "server/registry/default_bundle.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/frame_timer.h"
#include "tests/bench/rendered_frames.h"

namespace tactus::internal::client {
namespace {

constexpr int kTrials = 8;
// Objects pressed at once.
constexpr int kPressed[] = {1, 2, 8};

class SessionBenchmark : public Benchmark {
 public:
  const char* name() const override { return "session"; }
  const char* description() const override {
    return "The whole per-frame path with the default bundle";
  }

  absl::StatusOr<std::vector<BenchRow>> Run(bool quick) override {
    TACTUS_ASSIGN_OR_RETURN(model_, DecodeBundle(server::DefaultBundle()));
    TACTUS_RETURN_IF_ERROR(RunWarmUp(*model_));
    TACTUS_ASSIGN_OR_RETURN(const SkinModel skin, SkinModelNamed("good"));
    TACTUS_ASSIGN_OR_RETURN(const auto trials, WorldTrials(skin, kTrials));
    std::vector<RenderedTrial> pressed;
    for (const int objects : kPressed) {
      TACTUS_ASSIGN_OR_RETURN(pressed.emplace_back(),
                              PressedTrial(skin, objects));
    }
    SkinLayout without = skin.layout;
    without.light_touch.reset();

    repetitions_ = quick ? 2 : 31;
    std::vector<BenchRow> rows;
    for (const bool light : {true, false}) {
      const SkinLayout& layout = light ? skin.layout : without;
      suffix_ = light ? "" : "_without_light_touch";
      TACTUS_RETURN_IF_ERROR(MeasureOne(layout, trials, rows));
      TACTUS_RETURN_IF_ERROR(MeasurePressed(layout, pressed, rows));
    }
    return rows;
  }

 private:
  absl::Status MeasureOne(const SkinLayout& layout,
                          const std::vector<RenderedTrial>& trials,
                          std::vector<BenchRow>& rows) const {
    TACTUS_ASSIGN_OR_RETURN(const auto pipeline,
                            ContactPipeline::Create(layout, model_, {}));
    ContactTracker tracker(layout, {.load_profile = false});
    FrameTimer whole(trials);
    FrameTimer features(trials);
    for (size_t n = 0; n < trials.size(); ++n) {
      const RenderedTrial& trial = trials[n];
      for (int i = 0; i < repetitions_; ++i) {
        whole.Run(
            n, [&] { pipeline->EndTrial(); },
            [&](int t) { pipeline->Step(trial.frame(t)); });
        features.Run(
            n, [&] { tracker.Reset(); },
            [&](int t) { tracker.Step(trial.frame(t)); });
      }
    }
    const FrameTimes all = whole.Result();
    const FrameTimes part = features.Result();
    rows.push_back(Row("contact", all.contact));
    rows.push_back(Row("contact_features", part.contact));
    rows.push_back(Row("idle", all.idle));
    rows.push_back(Row("idle_features", part.idle));
    return absl::OkStatus();
  }

  // Several contacts at once: all of a frame, and its features alone.
  absl::Status MeasurePressed(const SkinLayout& layout,
                              const std::vector<RenderedTrial>& trials,
                              std::vector<BenchRow>& rows) const {
    TACTUS_ASSIGN_OR_RETURN(const auto pipeline,
                            ContactPipeline::Create(layout, model_, {}));
    // As many as there are contacts, so that they share the caches alike.
    std::vector<std::unique_ptr<ContactClassifier>> alone;
    for (int k = 0; k < limits::kMaxContacts; ++k) {
      alone.push_back(std::make_unique<ContactClassifier>(
          model_, ContactClassifier::Options()));
    }
    SkinTracker tracker(layout, {.max_contacts = pipeline->max_contacts(),
                                 .load_profile = alone[0]->uses_profile(),
                                 .load_spread = alone[0]->uses_spread(),
                                 .shear = alone[0]->uses_shear()});
    FrameTimer whole(trials);
    FrameTimer features(trials);
    FrameTimer classifier(trials);
    for (size_t n = 0; n < trials.size(); ++n) {
      TACTUS_RETURN_IF_ERROR(CheckContacts(trials[n], kPressed[n], *pipeline));
      const Samples samples = SamplesOf(trials[n], tracker);
      for (int i = 0; i < repetitions_; ++i) {
        whole.Run(
            n, [&] { pipeline->EndTrial(); },
            [&](int t) { pipeline->Step(trials[n].frame(t)); });
        features.Run(
            n, [&] { tracker.Reset(); },
            [&](int t) { tracker.Step(trials[n].frame(t)); });
        classifier.Run(
            n,
            [&] {
              for (const auto& each : alone) each->Reset();
            },
            [&](int t) {
              for (size_t k = 0; k < alone.size(); ++k) {
                const ContactFrame& frame = samples[t][k];
                if (frame.touched) alone[k]->Step(frame.sample, 0);
              }
            });
      }
    }
    for (size_t n = 0; n < trials.size(); ++n) {
      const std::string contacts = absl::StrCat("contacts_", kPressed[n]);
      rows.push_back(Row(contacts, whole.Of(n).contact));
      rows.push_back(
          Row(absl::StrCat(contacts, "_features"), features.Of(n).contact));
    }
    const size_t last = trials.size() - 1;
    rows.push_back(
        Row("further_contact", (whole.Of(last).contact - whole.Of(0).contact) /
                                   (kPressed[last] - kPressed[0])));
    rows.back().peer = classifier.Of(last).contact / kPressed[last];
    rows.back().peer_name = "its classifier's step alone";
    return absl::OkStatus();
  }

  // The features of a trial's contacts, by frame and by slot.
  using Samples = std::vector<std::array<ContactFrame, limits::kMaxContacts>>;
  static Samples SamplesOf(const RenderedTrial& trial, SkinTracker& tracker) {
    Samples samples(trial.frames());
    tracker.Reset();
    for (int t = 0; t < trial.frames(); ++t) {
      for (ContactFrame& frame : samples[t]) frame.touched = false;
      tracker.Step(trial.frame(t));
      for (const TrackedContact* contact : tracker.contacts()) {
        const FrameFeatures& features = contact->features();
        samples[t][contact->slot] = {features.sample(), features.touched};
      }
    }
    return samples;
  }

  // An error unless there are `wanted` contacts in each frame after the
  // lead-in.
  static absl::Status CheckContacts(const RenderedTrial& trial, int wanted,
                                    ContactPipeline& pipeline) {
    pipeline.EndTrial();
    for (int t = 0; t < trial.frames(); ++t) {
      const auto contacts =
          static_cast<int>(pipeline.Step(trial.frame(t)).size());
      if (t >= trial.lead_in && contacts != wanted) {
        return absl::InternalError(absl::StrCat(contacts, " contacts in frame ",
                                                t, " of ", wanted, " objects"));
      }
    }
    return absl::OkStatus();
  }

  BenchRow Row(absl::string_view name, double nanoseconds) const {
    return {.name = absl::StrCat("session/", name, suffix_),
            .unit = "ns",
            .ours = nanoseconds};
  }

  std::shared_ptr<const CompiledModel> model_;
  int repetitions_ = 0;
  std::string suffix_;
};

}  // namespace

std::unique_ptr<Benchmark> MakeSessionBenchmark() {
  return std::make_unique<SessionBenchmark>();
}

}  // namespace tactus::internal::client
