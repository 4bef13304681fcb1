#include <algorithm>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/random.h"
#include "core/base/status_macros.h"
#include "core/features/contact_tracker.h"
#include "core/features/segmenter.h"
#include "core/sim/exact/simulate_contact.h"
#include "core/sim/skin/record_contact.h"
#include "tests/bench/benchmarks.h"
#include "tests/bench/opencv_regions.h"
#include "tests/bench/rendered_frames.h"
#include "tests/bench/timing.h"

namespace tactus::internal::client {
namespace {

constexpr char kOpenCv[] = "OpenCV connectedComponentsWithStats";

using Frames = std::vector<std::vector<float>>;

SkinLayout Skin(bool wrap) {
  SkinLayout layout = *LayoutPreset("cody-forearm");
  layout.wrap_columns = wrap;
  return layout;
}

// Rendered frames in which something is touched, or nothing is.
absl::StatusOr<Frames> RenderFrames(bool touched) {
  TACTUS_ASSIGN_OR_RETURN(const SkinModel skin, SkinModelNamed("good"));
  TACTUS_ASSIGN_OR_RETURN(const auto trials, RenderTrials(skin, 8));
  // As many as the cache next to the core holds beside all else.
  constexpr size_t kFrames = 64;
  Segmenter segmenter(Skin(true));
  Frames frames;
  for (int t = 0; frames.size() < kFrames; ++t) {
    for (const RenderedTrial& trial : trials) {
      const auto taxels = trial.taxels_of(t % trial.frames());
      if ((segmenter.Segment(taxels) > 0) != touched) continue;
      frames.emplace_back(taxels.begin(), taxels.end());
    }
    if (touched) t += 4;
  }
  frames.resize(kFrames);
  return frames;
}

// Frames of a contact on a skin, or of the second before it.
absl::StatusOr<Frames> RecordFrames(const SkinModel& skin, bool touched) {
  TrialSpec spec;
  spec.object = {Materials()[0], 0.04, Surface::kWood};
  spec.fixed = true;
  TACTUS_ASSIGN_OR_RETURN(const auto contact, SimulateContact(spec));
  Random random(1);
  const Placement placement = {.centre = {.row = 7, .column = 5}};
  const Trial trial = RecordContact(contact, skin, placement, random);
  Frames frames;
  for (int i = 0; i < 64; ++i) {
    const int t = touched ? placement.lead_in_frames + 5 * i : i;
    trial.taxels.Decode(t, frames.emplace_back(skin.layout.taxels()).data());
  }
  return frames;
}

// Taxels alone at a random density, or random blobs: the one meets odd
// shapes, the other large ones.
void DrawFrame(const SkinLayout& layout, Random& random,
               std::vector<float>& taxels) {
  std::fill(taxels.begin(), taxels.end(), 0.0F);
  if (random.Index(2) == 0) {
    const double density = random.Uniform();
    for (float& taxel : taxels) {
      if (random.Uniform() < density) taxel = 1;
    }
    return;
  }
  const auto blobs = random.Index(12);
  for (uint64_t blob = 0; blob < blobs; ++blob) {
    const auto row = static_cast<int>(random.Index(layout.rows));
    const auto column = static_cast<int>(random.Index(layout.columns));
    const auto height = static_cast<int>(1 + random.Index(5));
    const auto width = static_cast<int>(1 + random.Index(5));
    for (int r = row; r < std::min(row + height, layout.rows); ++r) {
      for (int c = column; c < column + width; ++c) {
        taxels[r * layout.columns + c % layout.columns] = 1;
      }
    }
  }
}

// Segments random frames both ways; the largest difference there may be is
// none.
absl::Status CompareRegions(int frames) {
  Random random(1);
  for (const bool wrap : {true, false}) {
    for (const auto connectivity :
         {Connectivity::kEight, Connectivity::kFour}) {
      SkinLayout layout = Skin(wrap);
      layout.connectivity = connectivity;
      Segmenter ours(layout);
      OpenCvRegions theirs(layout);
      std::vector<float> taxels(layout.taxels());
      std::vector<uint16_t> labels(layout.taxels());
      for (int i = 0; i < frames / 4; ++i) {
        DrawFrame(layout, random, taxels);
        const int count = ours.Segment(taxels);
        ours.CopyLabels(labels);
        theirs.Segment(taxels);
        const auto want = theirs.JoinSeam();
        const auto areas = theirs.areas();
        const int most =
            areas.empty() ? 0 : *std::max_element(areas.begin(), areas.end());
        if (count != static_cast<int>(areas.size()) ||
            ours.largest().taxels != most ||
            !std::equal(labels.begin(), labels.end(), want.begin())) {
          return NumericalFailure(absl::StrCat(
              "regions of random frame ", i, wrap ? ", wrapped," : "",
              " differ from OpenCV's: ", count, " and ", areas.size()));
        }
      }
    }
  }
  return absl::OkStatus();
}

BenchRow MeasureFrames(const std::string& name, const Frames& frames, bool wrap,
                       bool quick) {
  const SkinLayout layout = Skin(wrap);
  Segmenter ours(layout);
  OpenCvRegions theirs(layout);
  // Shorter than what the machine gives a thread at a time.
  constexpr int kOurRounds = 16;
  int regions = 0;
  const auto run = [&](auto& segmenter, int rounds) {
    for (int round = 0; round < rounds; ++round) {
      for (const auto& frame : frames) regions += segmenter.Segment(frame);
    }
  };
  const Timing timing = Interleave(
      quick ? 3 : 301, [&] { run(ours, kOurRounds); }, [&] { run(theirs, 1); });
  const auto count = static_cast<double>(frames.size());
  return {.name = name,
          .unit = "ns",
          .ours = timing.ours / (kOurRounds * count) * 1e9,
          .peer = timing.peer / count * 1e9,
          .peer_name = kOpenCv};
}

// The tracker with and without light touch, on frames of the skin "good".
absl::StatusOr<BenchRow> MeasureLightTouch(const std::string& name,
                                           bool touched, bool quick) {
  TACTUS_ASSIGN_OR_RETURN(const SkinModel skin, SkinModelNamed("good"));
  SkinLayout without = skin.layout;
  without.light_touch.reset();
  TACTUS_ASSIGN_OR_RETURN(const Frames frames, RecordFrames(skin, touched));
  ContactTracker ours(skin.layout, {.load_profile = false});
  ContactTracker theirs(without, {.load_profile = false});
  constexpr int kRounds = 4;
  double force = 0;
  const auto run = [&](ContactTracker& tracker) {
    for (int round = 0; round < kRounds; ++round) {
      for (const auto& frame : frames) {
        force += tracker.Step({.taxels = frame}).max_force;
      }
    }
  };
  const Timing timing = Interleave(
      quick ? 3 : 301, [&] { run(ours); }, [&] { run(theirs); });
  const double count = kRounds * static_cast<double>(frames.size());
  return BenchRow{.name = name,
                  .unit = "ns",
                  .ours = timing.ours / count * 1e9,
                  .peer = timing.peer / count * 1e9,
                  .peer_name = "the tracker without light touch"};
}

class FeaturesBenchmark : public Benchmark {
 public:
  const char* name() const override { return "features"; }
  const char* description() const override {
    return "Segmentation of skin frames";
  }

  absl::StatusOr<std::vector<BenchRow>> Run(bool quick) override {
    TACTUS_RETURN_IF_ERROR(CompareRegions(quick ? 10'000 : 1'000'000));
    TACTUS_ASSIGN_OR_RETURN(const Frames contact, RenderFrames(true));
    TACTUS_ASSIGN_OR_RETURN(const Frames idle, RenderFrames(false));
    std::vector<BenchRow> rows = {
        MeasureFrames("features/contact", contact, true, quick),
        MeasureFrames("features/contact_flat", contact, false, quick),
        MeasureFrames("features/idle", idle, true, quick)};
    for (BenchRow& row : rows) {
      row.error = 0;
      row.error_reference = "the peer's regions";
    }
    for (const bool touched : {true, false}) {
      TACTUS_ASSIGN_OR_RETURN(
          rows.emplace_back(),
          MeasureLightTouch(touched ? "features/light_touch_contact"
                                    : "features/light_touch_idle",
                            touched, quick));
    }
    return rows;
  }
};

}  // namespace

std::unique_ptr<Benchmark> MakeFeaturesBenchmark() {
  return std::make_unique<FeaturesBenchmark>();
}

}  // namespace tactus::internal::client
