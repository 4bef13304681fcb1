// File: segmentation_reference.h
//
// Slow, plain segmentations of a frame that share no code and no method with
// core/features/segmenter.h: flood fill, taxel by taxel, and OpenCV.
#pragma once

#include <vector>

#include "core/features/segmenter.h"

namespace tactus::internal {

struct ReferenceSegmentation {
  // 0 is background; the numbering of regions is the reference's own.
  std::vector<int> labels;
  // By label - 1.
  std::vector<Region> regions;
};

// Regions are numbered in raster order of their first taxels. Centroids of
// regions that cross the seam are taken from the columns counted from the end
// of the widest stretch of columns without a taxel.
ReferenceSegmentation FloodFill(const SkinLayout& layout,
                                const std::vector<float>& taxels);

// cv::connectedComponentsWithStats. On a skin that wraps, labels that meet
// across the seam are merged afterwards and centroids are left 0; else
// centroids are those of OpenCV.
ReferenceSegmentation OpenCvSegmentation(const SkinLayout& layout,
                                         const std::vector<float>& taxels);

}  // namespace tactus::internal
