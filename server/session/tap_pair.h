// File: tap_pair.h
//
// TapPair: two who see the frames of one stream.
//
//   TapPair taps(&watched, &recorder);
//   session.SetTap(&taps);
//
// Not thread-safe: one per stream. Both must outlive it.
#pragma once

#include "core/stream/stream_tap.h"

namespace tactus::internal::server {

class TapPair final : public StreamTap {
 public:
  TapPair(StreamTap* first, StreamTap* second)
      : first_(first), second_(second) {}

  v1::Answer* Want(bool has_events) override {
    v1::Answer* first = first_->Want(has_events);
    v1::Answer* second = second_->Want(has_events);
    first_wants_ = first != nullptr;
    second_wants_ = second != nullptr;
    return first_wants_ ? first : second;
  }
  void Take(const FrameView& frame, const v1::Answer& answer) override {
    // The answer is the first one's, who may take it apart.
    if (second_wants_) second_->Take(frame, answer);
    if (first_wants_) first_->Take(frame, answer);
  }

 private:
  StreamTap* const first_;
  StreamTap* const second_;
  bool first_wants_ = false;
  bool second_wants_ = false;
};

}  // namespace tactus::internal::server
