// File: foxglove_image.h
//
// FoxgloveImage: skin frames as pictures of the schema foxglove.RawImage, which
// Foxglove's Image panel shows without a plug-in. One pixel per taxel, whose
// brightness is v / (v + 4 t) of white for a load v, where t is the onset
// threshold of the skin. So an untouched taxel is black, one at the onset
// threshold is dark grey, and no load is ever white. Masked taxels are black.
//
//   FoxgloveImage image(layout);
//   const McapSchema schema = FoxgloveImage::Schema();
//   const std::string bytes = image.Encode(batch, TAXEL_TYPE_UINT16, 0.001);
//   const std::string same = image.EncodeFloats(time_ns, taxels);
//
// Not thread-safe.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include "core/files/mcap/mcap_records.h"
#include "core/skin/layout.h"
#include "tactus/v1/contact.pb.h"

namespace tactus::internal {

class FoxgloveImage {
 public:
  explicit FoxgloveImage(SkinLayout layout) : layout_(std::move(layout)) {}

  static McapSchema Schema();

  // A serialised foxglove.RawImage of the one dense frame of `batch`, whose
  // size is that of the layout: 8 bits of grey, `mono8`.
  std::string Encode(const v1::FrameBatch& batch, v1::TaxelType type,
                     double scale) const;
  // The same of a frame's values, layout.values() of them in the layout's unit:
  // single precision from 0 to 1, `32FC1`.
  std::string EncodeFloats(int64_t time_ns,
                           std::span<const float> values) const;

 private:
  // Brightness of each taxel, where `white` is white. `values` are a frame's,
  // `scale` times smaller than in the layout's unit.
  std::vector<double> Brightness(std::span<const float> values, double scale,
                                 double white) const;
  std::string Message(int64_t time_ns, const char* encoding,
                      const std::string& pixels) const;

  SkinLayout layout_;
};

}  // namespace tactus::internal
