#include "core/data/recording/foxglove_image.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <vector>

#include "core/data/recording/foxglove_schema.h"
#include "core/skin/normal_loads.h"
#include "core/skin/taxel_values.h"

namespace tactus::internal {
namespace {

static_assert(std::endian::native == std::endian::little,
              "pixels are little-endian");

// Field numbers of foxglove.RawImage.
enum ImageField {
  kTimestamp = 1,
  kWidth = 2,
  kHeight = 3,
  kEncoding = 4,
  kStep = 5,
  kData = 6,
  kFrameId = 7,
};

constexpr char kRawImage[] = R"(
message RawImage {
  google.protobuf.Timestamp timestamp = 1;
  string frame_id = 7;
  fixed32 width = 2;
  fixed32 height = 3;
  string encoding = 4;
  fixed32 step = 5;
  bytes data = 6;
})";

// A pixel that is 4 onset thresholds above 0 is half as bright as white.
constexpr double kHalfGrey = 4;

}  // namespace

McapSchema FoxgloveImage::Schema() {
  return FoxgloveSchema("foxglove.RawImage", kRawImage);
}

std::vector<double> FoxgloveImage::Brightness(std::span<const float> values,
                                              double scale,
                                              double white) const {
  const double half = kHalfGrey * layout_.onset_threshold;
  NormalLoads normal(layout_);
  const std::span<const float> loads = normal.Of(values);
  std::vector<double> pixels(static_cast<size_t>(layout_.taxels()));
  for (size_t i = 0; i < pixels.size(); ++i) {
    if (!layout_.mask.empty() && layout_.mask[i] == 0) continue;
    const double value = scale * loads[i];
    // NaN is black too.
    if (!(value > 0)) continue;
    pixels[i] = std::isinf(value) ? white : white * value / (value + half);
  }
  return pixels;
}

std::string FoxgloveImage::Encode(const v1::FrameBatch& batch,
                                  v1::TaxelType type, double scale) const {
  // As they were sent, without a rounding; loads scale as values do.
  std::vector<float> values(static_cast<size_t>(layout_.values()));
  ScaleTaxels(type, batch.taxels().data(), 1, values);
  std::string pixels;
  for (const double grey : Brightness(values, scale, 255)) {
    pixels += static_cast<char>(static_cast<uint8_t>(std::lround(grey)));
  }
  return Message(batch.first_capture_time_ns(), "mono8", pixels);
}

std::string FoxgloveImage::EncodeFloats(int64_t time_ns,
                                        std::span<const float> values) const {
  std::string pixels;
  for (const double brightness : Brightness(values, 1, 1)) {
    const auto pixel = static_cast<float>(brightness);
    pixels.append(reinterpret_cast<const char*>(&pixel), sizeof pixel);
  }
  return Message(time_ns, "32FC1", pixels);
}

std::string FoxgloveImage::Message(int64_t time_ns, const char* encoding,
                                   const std::string& pixels) const {
  const auto rows = static_cast<uint32_t>(layout_.rows);
  ProtoFields image;
  image.AddTime(kTimestamp, time_ns);
  image.AddFixed(kWidth, static_cast<uint32_t>(layout_.columns));
  image.AddFixed(kHeight, rows);
  image.AddBytes(kEncoding, encoding);
  image.AddFixed(kStep, static_cast<uint32_t>(pixels.size()) / rows);
  image.AddBytes(kData, pixels);
  image.AddBytes(kFrameId, layout_.name);
  return image.bytes();
}

}  // namespace tactus::internal
