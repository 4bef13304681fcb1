#include "client/stream/frame_encoder.h"

#include <bit>

#include "core/skin/layout_proto.h"

namespace tactus::internal::client {
namespace {

static_assert(std::endian::native == std::endian::little,
              "values are copied to the wire as they are");

template <typename Value>
void Append(const Value* values, size_t count, std::string* bytes) {
  bytes->append(reinterpret_cast<const char*>(values), count * sizeof(Value));
}

}  // namespace

FrameEncoder::FrameEncoder(const SkinInfo& info, const Options& options)
    : type_(info.taxel_type),
      with_poses_(info.with_poses),
      sparse_(options.sparse) {
  request_.mutable_frames();
}

void FrameEncoder::Add(const SkinFrame& frame) {
  v1::FrameBatch* batch = request_.mutable_frames();
  if (batch->frame_count() == 0) {
    batch->set_first_sequence(next_sequence_);
    batch->set_first_capture_time_ns(frame.capture_time_ns);
  }
  batch->set_frame_count(batch->frame_count() + 1);
  ++next_sequence_;
  if (type_ == v1::TAXEL_TYPE_UINT16) {
    AddTaxels(frame.u16, batch);
  } else if (type_ == v1::TAXEL_TYPE_INT16) {
    AddTaxels(frame.i16, batch);
  } else {
    AddTaxels(frame.f32, batch);
  }
  if (!with_poses_) return;
  for (const double value : frame.pose.position) batch->add_poses(value);
  batch->add_poses(frame.pose.orientation.x());
  batch->add_poses(frame.pose.orientation.y());
  batch->add_poses(frame.pose.orientation.z());
  batch->add_poses(frame.pose.orientation.w());
}

template <typename Value>
void FrameEncoder::AddTaxels(const std::vector<Value>& taxels,
                             v1::FrameBatch* batch) {
  if (!sparse_) {
    Append(taxels.data(), taxels.size(), batch->mutable_taxels());
    return;
  }
  v1::SparseFrames* sparse = batch->mutable_sparse();
  uint32_t count = 0;
  for (size_t i = 0; i < taxels.size(); ++i) {
    if (taxels[i] == Value{0}) continue;
    const auto index = static_cast<uint16_t>(i);
    Append(&index, 1, sparse->mutable_indices());
    Append(&taxels[i], 1, sparse->mutable_values());
    ++count;
  }
  sparse->add_counts(count);
}

void FrameEncoder::Clear() {
  // Field by field: clearing the whole message would give its memory back.
  v1::FrameBatch* batch = request_.mutable_frames();
  batch->set_frame_count(0);
  batch->mutable_taxels()->clear();
  batch->mutable_poses()->Clear();
  if (!batch->has_sparse()) return;
  batch->mutable_sparse()->mutable_counts()->Clear();
  batch->mutable_sparse()->mutable_indices()->clear();
  batch->mutable_sparse()->mutable_values()->clear();
}

size_t FrameEncoder::bytes() const { return request_.ByteSizeLong(); }

v1::StreamConfig MakeConfig(const SkinInfo& info) {
  v1::StreamConfig config;
  *config.mutable_geometry() = LayoutToProto(info.layout);
  config.set_taxel_type(info.taxel_type);
  config.set_scale(info.scale);
  config.set_sample_rate_hz(info.sample_rate_hz);
  config.set_with_poses(info.with_poses);
  return config;
}

}  // namespace tactus::internal::client
