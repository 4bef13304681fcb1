// File: mock.h
//
// MockStream: a Stream for the tests of a robot's program, without a server and
// without a model. The test gives the answers, and sees the frames.
//
//   MockStream stream({.on_event = [](const Event& event) { Use(event); }});
//   if (!stream.Push(frame).ok()) return;
//   Contact contact;
//   contact.id = 1;
//   contact.answers = {{.question = "hardness",
//                       .values = {{"hard", 0.9}, {"soft", 0.1}},
//                       .decided = DecidedValue{.value = "hard"}}};
//   Answer answer;
//   answer.contacts = {contact};
//   answer.events = {{.kind = EventKind::kTouched, .contact = 1}};
//   stream.Give(answer);
//   stream.Fail(absl::UnavailableError("the cable is pulled"));
//
// Callbacks run within Give, and within EndTrial, which gives the last answer
// again as the final one. Poll may be called from any thread; all else belongs
// to one.
#pragma once

#include <memory>
#include <vector>

#include "tactus/stream.h"

namespace tactus {

class MockStream : public Stream {
 public:
  explicit MockStream(const StreamOptions& options = {}, StreamInfo info = {});
  ~MockStream() override;

  // As if the answer had come: events, then the answer.
  void Give(const Answer& answer);
  void Give(const Notice& notice);
  // From now on all calls return `status`, as after a lost connection.
  void Fail(absl::Status status);
  void SetResuming(bool resuming);

  // What was pushed, in all trials.
  const std::vector<Frame>& frames() const;
  int trials_ended() const;
  bool closed() const;

  const StreamInfo& info() const override;
  absl::Status Push(const Frame& frame) override;
  absl::StatusOr<Answer> EndTrial() override;
  absl::Status Close() override;
  bool Poll(Event& event) override;
  bool ended() override;
  bool resuming() override;
  StreamStatistics statistics() override;
  void Cancel() override;

 private:
  class Impl;
  const std::unique_ptr<Impl> impl_;
};

}  // namespace tactus
