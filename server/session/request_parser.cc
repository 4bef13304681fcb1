#include "server/session/request_parser.h"

#include <cstdint>

#include "google/protobuf/io/coded_stream.h"
#include "google/protobuf/message.h"
#include "google/protobuf/unknown_field_set.h"
#include "google/protobuf/wire_format_lite.h"

namespace tactus::server {
namespace {

using google::protobuf::internal::WireFormatLite;

constexpr uint8_t kFramesTag =
    WireFormatLite::MakeTag(v1::ClassifyContactRequest::kFramesFieldNumber,
                            WireFormatLite::WIRETYPE_LENGTH_DELIMITED);

bool BeginsWithFrames(google::protobuf::io::ZeroCopyInputStream* bytes) {
  const void* data = nullptr;
  int size = 0;
  while (bytes->Next(&data, &size)) {
    if (size == 0) continue;
    const bool frames = *static_cast<const uint8_t*>(data) == kFramesTag;
    bytes->BackUp(size);
    return frames;
  }
  return false;
}

void ForgetUnknownFields(google::protobuf::Message* message) {
  const google::protobuf::Reflection& reflection = *message->GetReflection();
  if (reflection.GetUnknownFields(*message).empty()) return;
  reflection.MutableUnknownFields(message)->Clear();
}

// As if new, with its memory.
void Reuse(v1::FrameBatch* batch) {
  batch->set_first_sequence(0);
  batch->set_first_capture_time_ns(0);
  batch->set_frame_count(0);
  batch->mutable_taxels()->clear();
  batch->clear_sparse();
  batch->mutable_poses()->Clear();
  ForgetUnknownFields(batch);
}

}  // namespace

bool ParseRequest(google::protobuf::io::ZeroCopyInputStream* bytes,
                  v1::ClassifyContactRequest* request) {
  if (request->has_frames() && BeginsWithFrames(bytes)) {
    // What is merged into it now was sent.
    Reuse(request->mutable_frames());
    ForgetUnknownFields(request);
  } else {
    request->Clear();
  }
  google::protobuf::io::CodedInputStream input(bytes);
  return request->MergeFromCodedStream(&input) && input.ConsumedEntireMessage();
}

}  // namespace tactus::server
