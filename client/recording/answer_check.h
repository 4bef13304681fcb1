// File: answer_check.h
//
// AnswerCheck: compares the answers of a replay with those of the
// recording, bit for bit. Computing and waiting times are left out, and so is
// the number of interim answers that were dropped.
//
//   AnswerCheck check;
//   check.Expect(recorded);
//   check.Receive(answer);
//   check.Result().equal;  // 1
//
// An answer waits in memory until its counterpart comes. Thread-safe.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <utility>

#include "tactus/v1/contact.pb.h"

namespace tactus::internal::client {

class AnswerCheck {
 public:
  struct Counts {
    uint64_t equal = 0;
    uint64_t different = 0;
    // Sequence number of the first frame whose answers differ.
    uint64_t first_different = 0;
    // Without a counterpart: dropped by a slow reader, or after the end.
    uint64_t only_recorded = 0;
    uint64_t only_received = 0;
  };

  void Expect(const v1::Answer& recorded) { Add(recorded, 0); }
  void Receive(const v1::Answer& received) { Add(received, 1); }
  // The model of the recording and that of the replay, by their checksums.
  void ExpectModel(const std::string& sha256);
  void ReceiveModel(const std::string& sha256);

  Counts Result() const;
  // False if the replay used another model than the recording.
  bool SameModel() const;
  // For people: "40 of 40 answers equal the recording's".
  std::string Text() const;

 private:
  void Add(const v1::Answer& answer, int side);

  mutable std::mutex mutex_;
  std::string models_[2];
  // By sequence number and is_final, those of the recording and of the replay
  // that wait for their counterpart.
  std::map<std::pair<uint64_t, bool>, std::string> waiting_[2];
  Counts counts_;
};

}  // namespace tactus::internal::client
