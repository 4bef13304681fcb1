#include "tests/core/features/segmentation_reference.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "opencv2/core.hpp"
#include "opencv2/core/utility.hpp"
#include "opencv2/imgproc.hpp"

namespace tactus::internal {
namespace {

bool Touched(const SkinLayout& layout, const std::vector<float>& taxels,
             int taxel) {
  const bool valid = layout.mask.empty() || layout.mask[taxel] != 0;
  return valid && taxels[taxel] >= static_cast<float>(layout.contact_threshold);
}

// Calls visit(taxel) for each neighbour of `taxel`; some may come twice.
template <typename Visit>
void ForNeighbours(const SkinLayout& layout, int taxel, Visit visit) {
  const int row = taxel / layout.columns;
  const int column = taxel % layout.columns;
  for (int dr = -1; dr <= 1; ++dr) {
    for (int dc = -1; dc <= 1; ++dc) {
      const int steps = std::abs(dr) + std::abs(dc);
      if (steps == 0) continue;
      if (steps == 2 && layout.connectivity == Connectivity::kFour) continue;
      const int r = row + dr;
      int c = column + dc;
      if (layout.wrap_columns) c = (c + layout.columns) % layout.columns;
      if (r < 0 || r >= layout.rows || c < 0 || c >= layout.columns) continue;
      visit(r * layout.columns + c);
    }
  }
}

// First column after the widest cyclic stretch of columns not in `used`.
int FirstColumn(const std::vector<bool>& used) {
  const int columns = static_cast<int>(used.size());
  int widest = 0;
  int start = 0;
  for (int begin = 0; begin < columns; ++begin) {
    int width = 0;
    while (width < columns && !used[(begin + width) % columns]) ++width;
    if (width > widest) {
      widest = width;
      start = (begin + width) % columns;
    }
  }
  return start;
}

Region Measure(const SkinLayout& layout, const std::vector<float>& taxels,
               const std::vector<int>& members) {
  Region region;
  region.taxels = static_cast<int>(members.size());
  region.first_taxel = *std::min_element(members.begin(), members.end());
  std::vector<bool> used(layout.columns);
  for (int taxel : members) used[taxel % layout.columns] = true;
  const int start = layout.wrap_columns ? FirstColumn(used) : 0;
  for (int taxel : members) {
    region.max_value = std::max(region.max_value, taxels[taxel]);
    region.total += taxels[taxel];
    const int column = taxel % layout.columns;
    const int unrolled = column < start ? column + layout.columns : column;
    region.centroid_row +=
        static_cast<double>(taxel / layout.columns) / region.taxels;
    region.centroid_column += static_cast<double>(unrolled) / region.taxels;
  }
  region.centroid_column = std::fmod(region.centroid_column, layout.columns);
  return region;
}

}  // namespace

ReferenceSegmentation FloodFill(const SkinLayout& layout,
                                const std::vector<float>& taxels) {
  ReferenceSegmentation result;
  result.labels.assign(taxels.size(), 0);
  std::vector<int> members;
  for (int first = 0; first < layout.taxels(); ++first) {
    if (result.labels[first] != 0 || !Touched(layout, taxels, first)) continue;
    const int label = static_cast<int>(result.regions.size()) + 1;
    members.assign(1, first);
    result.labels[first] = label;
    for (size_t next = 0; next < members.size(); ++next) {
      ForNeighbours(layout, members[next], [&](int taxel) {
        if (result.labels[taxel] != 0 || !Touched(layout, taxels, taxel)) {
          return;
        }
        result.labels[taxel] = label;
        members.push_back(taxel);
      });
    }
    result.regions.push_back(Measure(layout, taxels, members));
  }
  return result;
}

ReferenceSegmentation OpenCvSegmentation(const SkinLayout& layout,
                                         const std::vector<float>& taxels) {
  // Frames are too small to share between threads.
  cv::setNumThreads(1);
  cv::Mat binary(layout.rows, layout.columns, CV_8U);
  for (int taxel = 0; taxel < layout.taxels(); ++taxel) {
    binary.data[taxel] = Touched(layout, taxels, taxel) ? 255 : 0;
  }
  cv::Mat labels, stats, centroids;
  const int ways = layout.connectivity == Connectivity::kEight ? 8 : 4;
  const int count = cv::connectedComponentsWithStats(binary, labels, stats,
                                                     centroids, ways, CV_32S);
  ReferenceSegmentation result;
  result.labels.assign(labels.begin<int>(), labels.end<int>());
  result.regions.resize(count - 1);
  for (int i = 1; i < count; ++i) {
    Region& region = result.regions[i - 1];
    region.taxels = stats.at<int>(i, cv::CC_STAT_AREA);
    if (layout.wrap_columns) continue;
    region.centroid_column = centroids.at<double>(i, 0);
    region.centroid_row = centroids.at<double>(i, 1);
  }
  if (!layout.wrap_columns) return result;
  for (int row = 0; row < layout.rows; ++row) {
    const int edge = row * layout.columns + layout.columns - 1;
    ForNeighbours(layout, edge, [&](int taxel) {
      const int keep = result.labels[edge];
      const int drop = result.labels[taxel];
      if (keep == 0 || drop == 0 || keep == drop) return;
      std::replace(result.labels.begin(), result.labels.end(), drop, keep);
      result.regions[keep - 1].taxels += result.regions[drop - 1].taxels;
      result.regions[drop - 1].taxels = 0;
    });
  }
  return result;
}

}  // namespace tactus::internal
