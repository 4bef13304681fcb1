// File: frame_encoder.h
//
// FrameEncoder: packs skin frames into a request message.
//
//   FrameEncoder encoder(info, {.sparse = true});
//   encoder.Add(frame);
//   TACTUS_RETURN_IF_ERROR(stream->Send(encoder.request()));
//   encoder.Clear();
//
// Sequence numbers count the frames added, from 1. Keeps its message's
// memory. Not thread-safe.
#pragma once

#include <cstdint>

#include "client/stream/skin_frame.h"
#include "tactus/v1/contact.pb.h"

namespace tactus::internal::client {

class FrameEncoder {
 public:
  struct Options {
    // List touched taxels only.
    bool sparse = false;
  };

  FrameEncoder(const SkinInfo& info, const Options& options);

  // Frames added to one message must be consecutive, one sample period apart.
  void Add(const SkinFrame& frame);
  // Leaves out `count` sequence numbers, e.g. of frames the skin lost; the
  // message must be empty.
  void Skip(uint64_t count) { next_sequence_ += count; }
  // Forgets the frames added, not their numbers.
  void Clear();

  const v1::ClassifyContactRequest& request() const { return request_; }
  uint32_t frames() const { return request_.frames().frame_count(); }
  // Bytes of the message so far, about.
  size_t bytes() const;
  // Number of the frame added last; 0 before the first.
  uint64_t last_sequence() const { return next_sequence_ - 1; }

 private:
  template <typename Value>
  void AddTaxels(const std::vector<Value>& taxels, v1::FrameBatch* batch);

  const v1::TaxelType type_;
  const bool with_poses_;
  const bool sparse_;
  uint64_t next_sequence_ = 1;
  v1::ClassifyContactRequest request_;
};

// The configuration of a stream for this skin: every frame answered, contacts
// end as the model says.
v1::StreamConfig MakeConfig(const SkinInfo& info);

}  // namespace tactus::internal::client
