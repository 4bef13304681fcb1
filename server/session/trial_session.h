// File: trial_session.h
//
// TrialSession: one ClassifyTrial call without its transport. It runs a
// StreamSession on the parts of the request, so that a trial in one call gets
// the bits that a stream gives.
//
//   TrialSession trial(models, {.stream_id = "7"}, bytes);
//   while (!trial.done()) trial.Step(&request);
//   if (trial.status().ok()) Send(trial.response());
//
// Each step takes one part: the config or one FrameBatch. The caller can serve
// streams between two steps. The request is never parsed as a whole, so memory
// is its bytes and one batch. No threads, no clock: the caller serialises
// calls.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "server/session/stream_session.h"
#include "tactus/v1/contact.pb.h"

namespace tactus::internal::server {

class TrialSession {
 public:
  // `bytes` is a serialised ClassifyTrialRequest. `models` must outlive the
  // session.
  TrialSession(const ModelSource* models, StreamSession::Options options,
               std::string bytes);

  // Takes the next part; after the last one, ends the trial. The part is
  // parsed into `request`, which sessions of one thread may share.
  void Step(v1::ClassifyContactRequest* request);

  bool done() const { return done_; }
  // How the trial ended; meaningful once done.
  const absl::Status& status() const { return session_.final_status(); }
  // The answer; complete once done with an OK status.
  const v1::ClassifyTrialResponse& response() const { return response_; }
  const StreamSession& session() const { return session_; }

 private:
  void TakePart(v1::ClassifyContactRequest* request);
  void KeepAnswers();
  void KeepEnded(const v1::Answer& answer);

  StreamSession session_;
  const std::string bytes_;
  // Where the next part begins in `bytes_`.
  size_t position_ = 0;
  bool done_ = false;
  v1::ClassifyTrialResponse response_;
};

}  // namespace tactus::internal::server
