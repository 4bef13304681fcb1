// File: response_queue.h
//
// ResponseQueue: answers of one stream that wait to be written, in order and
// bounded. Interim posteriors that a slow reader left waiting give way to
// those of the next request message; everything else stays until written.
//
//   queue.BeginRequest();
//   WriteInto(queue.AddInterim());
//   queue.EndRequest(elapsed_ns, now_ns);
//   if (const auto* response = queue.StartWrite(now_ns)) { ... }
//   queue.FinishWrite();
//
// Messages are kept and used again, so that a stream in its stride allocates
// nothing here. Not thread-safe: one per stream.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "tactus/v1/contact.pb.h"

namespace tactus::server {

class ResponseQueue {
 public:
  // Opens a request message: interim posteriors added now supersede those
  // that wait from messages before.
  void BeginRequest();

  // Places to write to. The posterior holds old values: overwrite every field
  // but server_compute_ns, queue_ns and superseded. Valid until written out.
  v1::Posterior* AddInterim();
  v1::Posterior* AddFinal();
  v1::ClassifyContactResponse* AddMessage();

  // Closes a request message that took `elapsed_ns` to compute and ended at
  // `now_ns`; shares the time among the posteriors it brought.
  void EndRequest(int64_t elapsed_ns, int64_t now_ns);

  // The next answer, which stays in place until FinishWrite; null if none
  // waits or one is being written.
  const v1::ClassifyContactResponse* StartWrite(int64_t now_ns);
  void FinishWrite();

  // Nothing waits and nothing is being written.
  bool empty() const { return waiting_.empty() && writing_ == nullptr; }
  // As many finals wait as a stream may owe: read no further request.
  bool full() const;
  // Interim posteriors dropped so far.
  uint64_t superseded() const { return superseded_; }
  // Answers that wait; for tests of the bound.
  size_t size() const { return waiting_.size(); }

 private:
  struct Entry {
    v1::ClassifyContactResponse response;
    bool interim = false;
    uint64_t request = 0;
    int64_t ready_ns = 0;
  };

  v1::Posterior* AddPosterior(bool interim);
  void Supersede();
  void Recycle(std::unique_ptr<Entry> entry);

  // In the order of writing.
  std::vector<std::unique_ptr<Entry>> waiting_;
  std::unique_ptr<Entry> writing_;
  // Written posteriors, for use again.
  std::vector<std::unique_ptr<Entry>> spare_;
  size_t waiting_finals_ = 0;
  uint64_t request_ = 0;
  uint64_t superseded_ = 0;
  // Compute time of requests that brought no posterior.
  int64_t carried_ns_ = 0;
};

}  // namespace tactus::server
