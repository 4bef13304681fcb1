#include "server/session/request_parser.h"

#include <cstdint>

#include "google/protobuf/io/coded_stream.h"
#include "google/protobuf/message.h"
#include "google/protobuf/unknown_field_set.h"
#include "google/protobuf/wire_format_lite.h"

namespace tactus::internal::server {
namespace {

using google::protobuf::internal::WireFormatLite;
using google::protobuf::io::CodedInputStream;

constexpr uint8_t kFramesTag =
    WireFormatLite::MakeTag(v1::ClassifyContactRequest::kFramesFieldNumber,
                            WireFormatLite::WIRETYPE_LENGTH_DELIMITED);

constexpr uint8_t kSparseTag =
    WireFormatLite::MakeTag(v1::FrameBatch::kSparseFieldNumber,
                            WireFormatLite::WIRETYPE_LENGTH_DELIMITED);

// Fields that the first block of a message contains.
struct FirstBlock {
  bool frames = false;
  bool sparse = false;
};

FirstBlock ReadFirstBlock(google::protobuf::io::ZeroCopyInputStream* bytes) {
  const void* data = nullptr;
  int size = 0;
  do {
    if (!bytes->Next(&data, &size)) return {};
  } while (size == 0);
  bytes->BackUp(size);
  CodedInputStream block(static_cast<const uint8_t*>(data), size);
  uint32_t batch_size = 0;
  FirstBlock first;
  first.frames = block.ReadTag() == kFramesTag;
  if (!first.frames || !block.ReadVarint32(&batch_size)) return first;
  const auto limit = block.PushLimit(static_cast<int>(batch_size));
  for (uint32_t tag = block.ReadTag(); tag != 0; tag = block.ReadTag()) {
    if (tag == kSparseTag) first.sparse = true;
    if (first.sparse || !WireFormatLite::SkipField(&block, tag)) break;
  }
  block.PopLimit(limit);
  return first;
}

void ClearUnknownFields(google::protobuf::Message* message) {
  const google::protobuf::Reflection& reflection = *message->GetReflection();
  if (reflection.GetUnknownFields(*message).empty()) return;
  reflection.MutableUnknownFields(message)->Clear();
}

// Clears the batch but keeps its memory. With `sparse`, the field `sparse`
// stays set and empty, because the next message has it too.
void Reuse(bool sparse, v1::FrameBatch* batch) {
  batch->set_first_sequence(0);
  batch->set_first_capture_time_ns(0);
  batch->set_frame_count(0);
  // The first mutable access of a field that was never set allocates.
  if (!batch->taxels().empty()) batch->mutable_taxels()->clear();
  if (sparse && batch->has_sparse()) {
    v1::SparseFrames* frames = batch->mutable_sparse();
    frames->mutable_counts()->Clear();
    if (!frames->indices().empty()) frames->mutable_indices()->clear();
    if (!frames->values().empty()) frames->mutable_values()->clear();
    ClearUnknownFields(frames);
  } else {
    batch->clear_sparse();
  }
  batch->mutable_poses()->Clear();
  ClearUnknownFields(batch);
}

}  // namespace

bool ParseRequest(google::protobuf::io::ZeroCopyInputStream* bytes,
                  v1::ClassifyContactRequest* request) {
  const FirstBlock first = ReadFirstBlock(bytes);
  if (request->has_frames() && first.frames) {
    Reuse(first.sparse, request->mutable_frames());
    ClearUnknownFields(request);
  } else {
    request->Clear();
  }
  CodedInputStream input(bytes);
  return request->MergeFromCodedStream(&input) && input.ConsumedEntireMessage();
}

}  // namespace tactus::internal::server
