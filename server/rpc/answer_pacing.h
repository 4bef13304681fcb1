// File: answer_pacing.h
//
// AnswerPacing: decides when the answers of one stream leave.
//
// A client is ahead if it sends faster than it is answered: its next message is
// here before the answer to this one is out. Each flush costs as much as all
// other work for a message, so answers to such a client are held back until the
// queue shows whether another answer goes with them, and several leave in one
// flush. Answers to any other client leave at once.
//
//   AnswerPacing pacing;
//   if (pacing.ReadsFirst()) StartRead();
//   if (pacing.Holds(reading)) {
//     if (pacing.BeginHold()) queue->Defer(&nothing_more);
//   } else if (!pacing.Flushes(more_follow)) {
//     options.set_buffer_hint();
//   }
//
// Not thread-safe: belongs to the thread of its stream.
#pragma once

#include <cstdint>
#include <utility>

namespace tactus::internal::server {

class AnswerPacing {
 public:
  // A read was started.
  void OnReadStarted() { ++reads_; }
  // A read has ended: with a message, or not (`ok`), while an answer was being
  // written or not. Only a read that was started before the write shows this
  // way that the message was here already.
  void OnReadEnded(bool ok, bool writing) { ahead_ = ok && (writing || held_); }

  // True if the next read must be started before the next write. Every 16th
  // is, to find out whether the client is ahead.
  bool ReadsFirst() const { return !ahead_ && reads_ % kReadsPerProbe == 0; }

  // True if the next answer waits for more answers. Without a read in flight
  // there will be none.
  bool Holds(bool reading) const { return ahead_ && reading; }
  // False if answers are held already.
  bool BeginHold() { return !std::exchange(held_, true); }
  // `idle`: nothing else was to be done, so the client is not ahead any more.
  void EndHold(bool idle) {
    held_ = false;
    if (idle) ahead_ = false;
  }
  bool held() const { return held_; }

  // True if the write that starts now must be flushed. `more`: another answer
  // follows it.
  bool Flushes(bool more) {
    if (more && ++unflushed_ < kAnswersPerFlush) return false;
    unflushed_ = 0;
    return true;
  }

 private:
  // Few enough that a client that is ahead need not wait for answers while
  // there are messages of it to be answered.
  static constexpr int kAnswersPerFlush = 4;
  static constexpr uint32_t kReadsPerProbe = 16;

  bool ahead_ = false;
  bool held_ = false;
  uint32_t reads_ = 0;
  int unflushed_ = 0;
};

}  // namespace tactus::internal::server
