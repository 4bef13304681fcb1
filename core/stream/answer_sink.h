// File: answer_sink.h
//
// AnswerSink: where a ContactSession puts what it has to say, such as a queue
// to a network.
//
//   writer.Write(pipeline, false, sink.AddInterim());
//   sink.AddNotice()->set_kind(v1::StreamNotice::KIND_RATE_DIFFERS);
//
// Not thread-safe: one per stream.
#pragma once

#include "tactus/v1/contact.pb.h"

namespace tactus::internal {

class AnswerSink {
 public:
  virtual ~AnswerSink() = default;

  // The next answer for writing: one that a newer one may replace, and one that
  // may not be lost. It holds old values: overwrite every field except
  // `superseded` and the times of its diagnostics. The pointer is valid until
  // the next call.
  virtual v1::Answer* AddInterim() = 0;
  virtual v1::Answer* AddKept() = 0;
  // An empty notice.
  virtual v1::StreamNotice* AddNotice() = 0;
};

}  // namespace tactus::internal
