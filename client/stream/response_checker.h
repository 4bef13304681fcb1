// File: response_checker.h
//
// ResponseChecker: checks every message of a server before a program uses it:
// the order of messages, the sizes of lists, class indices, finite numbers and
// sequence numbers. A server that breaks the contract then causes an error,
// not a crash.
//
//   ResponseChecker checker;
//   checker.OnSent(request);  // before the request is written
//   TACTUS_RETURN_IF_ERROR(checker.Check(response));
//
// OnSent and Check may run on different threads; each on one thread at a time.
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "absl/status/status.h"
#include "tactus/v1/contact.pb.h"

namespace tactus::internal::client {

class ResponseChecker {
 public:
  // Notes the frames and the ends of trials that the server may answer.
  void OnSent(const v1::ClassifyContactRequest& request);

  // OK, or INVALID_RESPONSE naming the field, its value and the valid values.
  // Responses must be given in the order of their arrival. After an error the
  // stream cannot be used any more. Unknown notices and unknown kinds of
  // responses pass, because later versions of the contract may add some.
  absl::Status Check(const v1::ClassifyContactResponse& response);

 private:
  absl::Status CheckStarted(const v1::StreamStarted& started);
  absl::Status CheckQuestions(const v1::StreamStarted& started);
  absl::Status CheckAnswer(const v1::Answer& answer);
  absl::Status CheckContact(const v1::Contact& contact, uint64_t sequence);
  absl::Status CheckOrder(const v1::Answer& answer);

  // Written by OnSent.
  std::atomic<uint64_t> sent_sequence_ = 0;
  std::atomic<uint64_t> trials_ended_ = 0;
  // 0 until `started` has arrived.
  int classes_ = 0;
  int taxels_ = 0;
  // How many values each question has.
  std::vector<int> values_;
  uint64_t last_sequence_ = 0;
  uint64_t finals_ = 0;
};

}  // namespace tactus::internal::client
