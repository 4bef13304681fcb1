// File: stream_tap.h
//
// StreamTap: lets someone beside the robot see the frames of a stream with
// their answers.
//
//   session.SetTap(&tap);
//
// Called by the session within OnFrames and OnEndOfTrial. Not thread-safe: one
// per stream.
#pragma once

#include <cstdint>

#include "core/skin/frame.h"
#include "tactus/v1/contact.pb.h"

namespace tactus::internal {

class StreamTap {
 public:
  virtual ~StreamTap() = default;

  // After each frame. Returns an answer to be filled, or null if nobody looks.
  // It holds old values, as those of an AnswerSink do.
  virtual v1::Answer* Want(bool has_events) = 0;
  // The answer is filled: all contacts have their taxels. That of the end of a
  // trial has no frame.
  virtual void Take(const FrameView& frame, const v1::Answer& answer) = 0;
};

}  // namespace tactus::internal
