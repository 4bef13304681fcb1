// Writes what SkinTracker makes of wandering patches, for tracking_reference.py
// to compare with SciPy:
//
//   tracking_samples FOLDER SEED
//
// FOLDER/NAME.frames has the frames, rows x columns bytes each, 1 for a touched
// taxel; FOLDER/NAME.csv a line for each contact that touches in a frame: its
// frame, id, taxels of its largest region, row and column of its centroid.
// NAME is "flat" or "round", whose columns wrap. Prints rows and columns.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "core/features/skin_tracker.h"
#include "tests/support/flat_layout.h"

namespace tactus::internal {
namespace {

constexpr int kRows = 24;
constexpr int kColumns = 40;
constexpr int kFrames = 4000;
// Patches of neighbouring bands are always more than two taxels apart.
constexpr int kBands = 4;
constexpr int kBandRows = 6;

// A patch that comes, wanders along its band, flickers, and goes.
class Wanderer {
 public:
  Wanderer(int band, bool wrap, Random& random)
      : band_(band), wrap_(wrap), random_(random) {
    Rest();
  }

  void Step(std::vector<float>& taxels) {
    if (--left_ < 0) (there_ = !there_) ? Begin() : Rest();
    if (!there_) return;
    column_ += static_cast<int>(random_.Index(3)) - 1;
    column_ = wrap_ ? (column_ + kColumns) % kColumns
                    : std::clamp(column_, 0, kColumns - columns_);
    // It may be lost for three frames, but not as it begins.
    lost_ = ++age_ > 10 && lost_ < 3 && random_.Index(6) == 0 ? lost_ + 1 : 0;
    if (lost_ > 0) return;
    for (int row = 0; row < rows_; ++row) {
      for (int column = 0; column < columns_; ++column) {
        // The first column has no hole, so that the patch is one region.
        const bool is_hole = row == 1 && column > 0 && column % 2 == hole_;
        const int at = (column_ + column) % kColumns;
        taxels[(band_ * kBandRows + row) * kColumns + at] = is_hole ? 0 : 5;
      }
    }
  }

 private:
  void Begin() {
    left_ = 30 + static_cast<int>(random_.Index(300));
    rows_ = 1 + static_cast<int>(random_.Index(3));
    columns_ = 2 + static_cast<int>(random_.Index(6));
    column_ = static_cast<int>(random_.Index(kColumns - columns_));
    hole_ = static_cast<int>(random_.Index(2));
    age_ = lost_ = 0;
  }
  // Longer than any contact lasts without touch.
  void Rest() { left_ = 60 + static_cast<int>(random_.Index(200)); }

  const int band_;
  const bool wrap_;
  Random& random_;
  bool there_ = false;
  int left_ = 0;
  int age_ = 0;
  int lost_ = 0;
  int rows_ = 0;
  int columns_ = 0;
  int column_ = 0;
  int hole_ = 0;
};

bool Write(const std::string& path, bool wrap, uint64_t seed) {
  Random random = Random::ForStream(seed, wrap);
  SkinLayout layout = testing::FlatLayout(kRows, kColumns);
  layout.wrap_columns = wrap;
  SkinTracker tracker(layout, {.max_contacts = 8});
  std::vector<Wanderer> wanderers;
  for (int band = 0; band < kBands; ++band) {
    wanderers.emplace_back(band, wrap, random);
  }
  std::ofstream frames(path + ".frames", std::ios::binary);
  std::ofstream contacts(path + ".csv");
  contacts << std::setprecision(10);
  for (int t = 0; t < kFrames; ++t) {
    std::vector<float> taxels(layout.taxels());
    for (Wanderer& wanderer : wanderers) wanderer.Step(taxels);
    for (const float taxel : taxels) frames.put(taxel > 0 ? 1 : 0);
    tracker.Step({.taxels = taxels});
    for (const TrackedContact* contact : tracker.contacts()) {
      const FrameFeatures& features = contact->features();
      if (!features.touched) continue;
      contacts << t << "," << contact->id() << "," << features.area_taxels
               << "," << features.centroid.row << ","
               << features.centroid.column << "\n";
    }
  }
  return frames.flush() && contacts.flush();
}

}  // namespace
}  // namespace tactus::internal

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const std::string folder = argv[1];
  const uint64_t seed = std::strtoull(argv[2], nullptr, 10);
  if (!tactus::internal::Write(folder + "/flat", false, seed) ||
      !tactus::internal::Write(folder + "/round", true, seed)) {
    std::cerr << "tracking_samples: cannot write to " << folder << "\n";
    return 1;
  }
  std::cout << tactus::internal::kRows << " " << tactus::internal::kColumns
            << "\n";
  return 0;
}
