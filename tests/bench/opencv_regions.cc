#include "tests/bench/opencv_regions.h"

#include <algorithm>
#include <numeric>

#include "core/features/segmenter.h"
#include "opencv2/imgproc.hpp"

namespace tactus::internal::client {

OpenCvRegions::OpenCvRegions(const SkinLayout& layout)
    : layout_(layout), labels_(layout.taxels()) {
  // Frames are too small to share between threads.
  cv::setNumThreads(1);
}

int OpenCvRegions::Segment(std::span<const float> taxels) {
  const cv::Mat frame(layout_.rows, layout_.columns, CV_32F,
                      const_cast<float*>(taxels.data()));
  cv::compare(frame, TaxelThreshold(layout_.contact_threshold), binary_,
              cv::CMP_GE);
  const int ways = layout_.connectivity == Connectivity::kEight ? 8 : 4;
  return cv::connectedComponentsWithStats(binary_, region_of_, stats_,
                                          centroids_, ways, CV_32S) -
         1;
}

std::span<const uint16_t> OpenCvRegions::JoinSeam() {
  merged_.resize(stats_.rows);
  std::iota(merged_.begin(), merged_.end(), 0);
  const int last = layout_.columns - 1;
  const int reach = layout_.connectivity == Connectivity::kEight ? 1 : 0;
  for (int row = 0; layout_.wrap_columns && row < layout_.rows; ++row) {
    for (int other = std::max(row - reach, 0);
         other <= std::min(row + reach, layout_.rows - 1); ++other) {
      JoinAcross(region_of_.at<int>(row, last), region_of_.at<int>(other, 0));
    }
  }
  std::vector<int> numbers(merged_.size());
  areas_.clear();
  for (int i = 0; i < layout_.taxels(); ++i) {
    const int region = merged_[region_of_.ptr<int>()[i]];
    if (region != 0 && numbers[region] == 0) {
      areas_.push_back(0);
      numbers[region] = static_cast<int>(areas_.size());
    }
    labels_[i] = static_cast<uint16_t>(numbers[region]);
    if (region != 0) ++areas_[labels_[i] - 1];
  }
  return labels_;
}

void OpenCvRegions::JoinAcross(int left, int right) {
  const int keep = merged_[left];
  const int drop = merged_[right];
  if (keep == 0 || drop == 0) return;
  std::replace(merged_.begin(), merged_.end(), drop, keep);
}

}  // namespace tactus::internal::client
