#include "core/data/recording/foxglove_image.h"

#include <cmath>
#include <span>
#include <vector>

#include "core/base/serialize.h"
#include "core/skin/normal_loads.h"
#include "core/skin/taxel_values.h"
#include "google/protobuf/descriptor.pb.h"
#include "google/protobuf/io/coded_stream.h"
#include "google/protobuf/io/zero_copy_stream_impl_lite.h"
#include "google/protobuf/timestamp.pb.h"

namespace tactus::internal {
namespace {

using google::protobuf::FieldDescriptorProto;
using google::protobuf::io::CodedOutputStream;

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

constexpr int64_t kNsPerSecond = 1'000'000'000;

// The value of a pixel that is 4 onset thresholds above 0 is 127.
constexpr double kHalfGrey = 4;

// The tag of a field: wire type 2 has a length, wire type 5 has 32 bits.
void WriteBytes(int field, const std::string& bytes, CodedOutputStream& out) {
  out.WriteTag(static_cast<uint32_t>(field) << 3 | 2);
  out.WriteVarint32(static_cast<uint32_t>(bytes.size()));
  out.WriteString(bytes);
}

void WriteFixed(int field, uint32_t value, CodedOutputStream& out) {
  out.WriteTag(static_cast<uint32_t>(field) << 3 | 5);
  out.WriteLittleEndian32(value);
}

}  // namespace

McapSchema FoxgloveImage::Schema() {
  google::protobuf::FileDescriptorSet files;
  google::protobuf::Timestamp::descriptor()->file()->CopyTo(files.add_file());
  google::protobuf::FileDescriptorProto& file = *files.add_file();
  file.set_name("foxglove/RawImage.proto");
  file.set_package("foxglove");
  file.set_syntax("proto3");
  file.add_dependency("google/protobuf/timestamp.proto");
  google::protobuf::DescriptorProto& message = *file.add_message_type();
  message.set_name("RawImage");
  const auto add = [&](const char* name, ImageField number,
                       FieldDescriptorProto::Type type) {
    FieldDescriptorProto& field = *message.add_field();
    field.set_name(name);
    field.set_number(number);
    field.set_label(FieldDescriptorProto::LABEL_OPTIONAL);
    field.set_type(type);
    if (number == kTimestamp) field.set_type_name(".google.protobuf.Timestamp");
  };
  add("timestamp", kTimestamp, FieldDescriptorProto::TYPE_MESSAGE);
  add("frame_id", kFrameId, FieldDescriptorProto::TYPE_STRING);
  add("width", kWidth, FieldDescriptorProto::TYPE_FIXED32);
  add("height", kHeight, FieldDescriptorProto::TYPE_FIXED32);
  add("encoding", kEncoding, FieldDescriptorProto::TYPE_STRING);
  add("step", kStep, FieldDescriptorProto::TYPE_FIXED32);
  add("data", kData, FieldDescriptorProto::TYPE_BYTES);
  return {"foxglove.RawImage", "protobuf", SerializeDeterministic(files)};
}

std::string FoxgloveImage::Encode(const v1::FrameBatch& batch,
                                  v1::TaxelType type, double scale) const {
  const double half = kHalfGrey * layout_.onset_threshold;
  // As they were sent, without a rounding; loads scale as values do.
  std::vector<float> values(layout_.values());
  ScaleTaxels(type, batch.taxels().data(), 1, values);
  NormalLoads normal(layout_);
  const std::span<const float> loads = normal.Of(values);
  std::string pixels(static_cast<size_t>(layout_.taxels()), '\0');
  for (size_t i = 0; i < pixels.size(); ++i) {
    if (!layout_.mask.empty() && layout_.mask[i] == 0) continue;
    const double value = scale * loads[i];
    // NaN is black too.
    if (!(value > 0)) continue;
    const double grey = std::isinf(value) ? 255 : 255 * value / (value + half);
    pixels[i] = static_cast<char>(static_cast<uint8_t>(std::lround(grey)));
  }
  google::protobuf::Timestamp time;
  int64_t seconds = batch.first_capture_time_ns() / kNsPerSecond;
  int64_t ns = batch.first_capture_time_ns() % kNsPerSecond;
  if (ns < 0) {
    ns += kNsPerSecond;
    --seconds;
  }
  time.set_seconds(seconds);
  time.set_nanos(static_cast<int32_t>(ns));
  std::string bytes;
  {
    google::protobuf::io::StringOutputStream stream(&bytes);
    CodedOutputStream out(&stream);
    WriteBytes(kTimestamp, time.SerializeAsString(), out);
    WriteFixed(kWidth, static_cast<uint32_t>(layout_.columns), out);
    WriteFixed(kHeight, static_cast<uint32_t>(layout_.rows), out);
    WriteBytes(kEncoding, "mono8", out);
    WriteFixed(kStep, static_cast<uint32_t>(layout_.columns), out);
    WriteBytes(kData, pixels, out);
    WriteBytes(kFrameId, layout_.name, out);
  }
  return bytes;
}

}  // namespace tactus::internal
