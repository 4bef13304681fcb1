// The learners that see all taxels, on made-up contacts of 20 x 20 taxels.
#include <malloc.h>

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/random.h"
#include "core/base/status_macros.h"
#include "core/nearest/fit_nearest.h"
#include "core/ridge/fit_ridge.h"
#include "core/trees/fit_trees.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/timing.h"

namespace tactus::internal::client {
namespace {

constexpr int kSkinRows = 20;
constexpr int kSkinColumns = 20;
constexpr int kMadeFrames = 300;

using MadeFrames = std::vector<std::vector<TaxelLoad>>;

// Contacts that touch every fourth taxel. The loads of the taxels tell the
// class.
struct MadeContacts {
  std::vector<MadeFrames> frames;
  std::vector<HistorySample> samples;
};

MadeContacts MakeContacts(int contacts, int classes, uint64_t seed) {
  Random random(seed);
  MadeContacts made;
  for (int i = 0; i < contacts; ++i) {
    Random of_class = Random::ForStream(seed, i % classes);
    MadeFrames& frames = made.frames.emplace_back(kMadeFrames);
    for (uint32_t taxel = 0; taxel < kSkinRows * kSkinColumns; taxel += 4) {
      const double root = of_class.Uniform(1, 2);
      for (auto& frame : frames) {
        frame.push_back(
            {taxel, static_cast<float>(root + 0.3 * random.Uniform())});
      }
    }
  }
  for (int i = 0; i < contacts; ++i) {
    made.samples.push_back({.frames = std::vector<std::span<const TaxelLoad>>(
                                made.frames[i].begin(), made.frames[i].end()),
                            .label = i % classes,
                            .group = i / classes % 5});
  }
  return made;
}

size_t HeapBytes() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

class FewTrialsBenchmark : public Benchmark {
 public:
  const char* name() const override { return "few-trials"; }
  const char* description() const override {
    return "The learners that see all taxels: a frame, an answer, a fit";
  }

  absl::StatusOr<std::vector<BenchRow>> Run(bool quick) override {
    repetitions_ = quick ? 1 : 31;
    rows_.clear();
    for (const int classes : {2, 20}) {
      const MadeContacts made = MakeContacts(quick ? 40 : 300, classes, 1);
      TACTUS_RETURN_IF_ERROR(
          (Measure<Ridge, RidgeScorer>("ridge", made, classes, [&](int of) {
            return FitRidge(made.samples, {.shape = {kSkinRows, kSkinColumns},
                                           .classes = of});
          })));
      TACTUS_RETURN_IF_ERROR(
          (Measure<Trees, TreesScorer>("trees", made, classes, [&](int of) {
            return FitTrees(made.samples, {.shape = {kSkinRows, kSkinColumns},
                                           .classes = of});
          })));
      TACTUS_RETURN_IF_ERROR((Measure<Nearest, NearestScorer>(
          "nearest", made, classes, [&](int of) {
            return FitNearest(made.samples, {.shape = {kSkinRows, kSkinColumns},
                                             .classes = of});
          })));
    }
    return rows_;
  }

 private:
  template <class Learned, class Scorer, class Fit>
  absl::Status Measure(const char* learner, const MadeContacts& made,
                       int classes, const Fit& fit) {
    const std::string row =
        absl::StrCat(name(), "/", learner, "/", classes, "_classes/");
    absl::StatusOr<Learned> learned;
    const double fit_s = ProcessorSecondsOf([&] { learned = fit(classes); });
    TACTUS_RETURN_IF_ERROR(learned.status());
    const size_t before = HeapBytes();
    Scorer scorer(&*learned);
    const size_t bytes = HeapBytes() - before;
    const auto& frames = made.samples.front().frames;
    const double frame_s = MedianSeconds(repetitions_, [&] {
      scorer.Reset();
      for (const auto loads : frames) scorer.Step(loads);
    });
    std::vector<double> scores(classes);
    constexpr int kAnswers = 20;
    const double answer_s = MedianSeconds(repetitions_, [&] {
      for (int i = 0; i < kAnswers; ++i) scorer.Score(scores);
    });
    rows_.push_back({.name = row + "frame",
                     .unit = "ns",
                     .ours = frame_s / kMadeFrames * 1e9});
    rows_.push_back({.name = row + "answer",
                     .unit = "ns",
                     .ours = answer_s / kAnswers * 1e9});
    rows_.push_back({.name = row + "stream",
                     .unit = "KiB",
                     .ours = static_cast<double>(bytes) / 1024});
    rows_.push_back({.name = row + "fit", .unit = "s", .ours = fit_s});
    return absl::OkStatus();
  }

  int repetitions_ = 1;
  std::vector<BenchRow> rows_;
};

}  // namespace

std::unique_ptr<Benchmark> MakeFewTrialsBenchmark() {
  return std::make_unique<FewTrialsBenchmark>();
}

}  // namespace tactus::internal::client
