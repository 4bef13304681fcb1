// File: opencv_regions.h
//
// OpenCvRegions: the regions of a frame by OpenCV, and the same joined across
// the seam of a skin whose columns wrap.
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

namespace tactus::internal::client {

class OpenCvRegions {
 public:
  // `layout` has no mask.
  explicit OpenCvRegions(const SkinLayout& layout);

  // Threshold and connectedComponentsWithStats; columns do not wrap. Returns
  // the number of regions.
  int Segment(std::span<const float> taxels);

  // Labels per taxel, 0 for the background. Regions are numbered by their first
  // taxels; regions that meet across the seam are one. Slow: for checks only.
  std::span<const uint16_t> JoinSeam();

  // Number of taxels of the regions of JoinSeam(), from label 1 on.
  std::span<const int> areas() const { return areas_; }

 private:
  void JoinAcross(int left, int right);

  SkinLayout layout_;
  cv::Mat binary_;
  cv::Mat region_of_;
  cv::Mat stats_;
  cv::Mat centroids_;
  // OpenCV's label -> joined label.
  std::vector<int> merged_;
  std::vector<uint16_t> labels_;
  std::vector<int> areas_;
};

}  // namespace tactus::internal::client
