// File: opencv_regions.h
//
// Regions of a frame as OpenCV finds them, and joined across the seam of a skin
// that wraps.
//
//   OpenCvRegions regions(layout);
//   regions.Segment(taxels);
//   regions.JoinSeam();
//
// Owns its workspace. Not thread-safe.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/skin/layout.h"
#include "opencv2/core.hpp"

namespace tactus::client {

class OpenCvRegions {
 public:
  // `layout` has no mask.
  explicit OpenCvRegions(const SkinLayout& layout);

  // Threshold and connectedComponentsWithStats; columns do not wrap. Returns
  // the number of regions.
  int Segment(std::span<const float> taxels);

  // Numbers the regions in the order of their first taxels, those that meet
  // across the seam as one; 0 is background. Slow: to check with.
  std::span<const uint16_t> JoinSeam();

  // Of the regions of JoinSeam(), from label 1 on.
  std::span<const int> areas() const { return areas_; }

 private:
  void JoinAcross(int left, int right);

  SkinLayout layout_;
  cv::Mat binary_;
  cv::Mat region_of_;
  cv::Mat stats_;
  cv::Mat centroids_;
  // What OpenCV's labels have become.
  std::vector<int> merged_;
  std::vector<uint16_t> labels_;
  std::vector<int> areas_;
};

}  // namespace tactus::client
