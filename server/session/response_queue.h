// File: response_queue.h
//
// ResponseQueue: the answers of one stream that wait to be written, in order.
// Its size is bounded: interim answers that still wait are dropped when a
// later request message adds its own. All others are kept until they are
// written.
//
//   queue.BeginRequest();
//   WriteInto(has_events ? queue.AddKept() : queue.AddInterim());
//   queue.EndRequest(elapsed_ns, now_ns);
//   if (const auto* response = queue.StartWrite(now_ns)) Write(*response);
//   queue.FinishWrite();
//
// Messages are reused, so a running stream allocates nothing here. Not
// thread-safe: one per stream.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/stream/answer_sink.h"
#include "tactus/v1/contact.pb.h"

namespace tactus::internal::server {

class ResponseQueue : public AnswerSink {
 public:
  // Starts a request message: interim answers added from now on replace
  // those of earlier messages that still wait.
  void BeginRequest();

  // Add an answer and return it for writing. It holds old values: overwrite
  // every field except `superseded` and the times of its diagnostics. The
  // pointer is valid until FinishWrite.
  v1::Answer* AddInterim() override;
  v1::Answer* AddKept() override;
  v1::StreamNotice* AddNotice() override;
  v1::ClassifyContactResponse* AddMessage();

  // Ends a request message that took `elapsed_ns` to compute and ended at
  // `now_ns`. Divides the time among its answers.
  void EndRequest(int64_t elapsed_ns, int64_t now_ns);

  // The next answer, valid until FinishWrite; null if none waits or one is
  // being written.
  const v1::ClassifyContactResponse* StartWrite(int64_t now_ns);
  void FinishWrite();
  // Nanoseconds that the answer which is being written has waited.
  int64_t waited_ns() const { return waited_ns_; }

  // True if nothing waits and nothing is being written.
  bool empty() const { return waiting_.empty() && writing_ == nullptr; }
  // True if the maximum number of kept answers waits: read no further request.
  bool full() const;
  // Interim answers dropped so far.
  uint64_t superseded() const { return superseded_; }
  // Number of answers that wait.
  size_t size() const { return waiting_.size(); }

 private:
  struct Entry {
    v1::ClassifyContactResponse response;
    bool interim = false;
    uint64_t request = 0;
    // 0 until the request message has ended.
    int64_t ready_ns = 0;
  };

  v1::Answer* AddAnswer(bool interim);
  void Supersede();
  void Recycle(std::unique_ptr<Entry> entry);

  // In the order of writing.
  std::vector<std::unique_ptr<Entry>> waiting_;
  std::unique_ptr<Entry> writing_;
  // Written answers, for reuse.
  std::vector<std::unique_ptr<Entry>> spare_;
  size_t waiting_kept_ = 0;
  uint64_t request_ = 0;
  uint64_t superseded_ = 0;
  int64_t waited_ns_ = 0;
  // Compute time of earlier requests without an answer.
  int64_t carried_ns_ = 0;
};

}  // namespace tactus::internal::server
