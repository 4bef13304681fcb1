// File: foxglove_image.h
//
// FoxgloveImage: skin frames as pictures of the schema foxglove.RawImage, which
// Foxglove's Image panel shows without a plug-in. One pixel per taxel, 8 bits
// of grey: a value v is 255 v / (v + 4 t), where t is the onset threshold of
// the skin. So an untouched taxel is black, one at the onset threshold is dark
// grey, and no load is ever white. Masked taxels are black.
//
//   FoxgloveImage image(layout);
//   const McapSchema schema = FoxgloveImage::Schema();
//   const std::string bytes = image.Encode(batch, TAXEL_TYPE_UINT16, 0.001);
//
// Not thread-safe.
#pragma once

#include <string>

#include "core/files/mcap/mcap_records.h"
#include "core/skin/layout.h"
#include "tactus/v1/contact.pb.h"

namespace tactus::internal {

class FoxgloveImage {
 public:
  explicit FoxgloveImage(SkinLayout layout) : layout_(std::move(layout)) {}

  static McapSchema Schema();

  // A serialised foxglove.RawImage of the one dense frame of `batch`, whose
  // size is that of the layout.
  std::string Encode(const v1::FrameBatch& batch, v1::TaxelType type,
                     double scale) const;

 private:
  SkinLayout layout_;
};

}  // namespace tactus::internal
