// File: answer_convert.h
//
// AnswerConverter: makes the public Answer (tactus/answer.h), which has names,
// of a message, which has indices.
//
//   const AnswerConverter converter(started);
//   Answer out;
//   converter.Convert(answer, out);
//   Use(out);
//
// `out` keeps its memory: it allocates when there are more contacts or events
// than before. The answers' sizes are right, as those that a ContactStream
// returned. Thread-safe once made.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "client/stream/skin_frame.h"
#include "tactus/answer.h"
#include "tactus/stream.h"
#include "tactus/v1/contact.pb.h"

namespace tactus::internal::client {

class AnswerConverter {
 public:
  explicit AnswerConverter(const v1::StreamStarted& started);

  const StreamInfo& info() const { return info_; }

  // Overwrites all fields of `to`.
  void Convert(const v1::Answer& from, Answer& to) const;

 private:
  void ConvertContact(const v1::Contact& from, Contact& to) const;
  void ConvertQuestion(size_t question, const v1::QuestionAnswer& from,
                       QuestionAnswer& to) const;
  void ConvertEvent(const v1::Answer& answer, const v1::ContactEvent& from,
                    Event& to) const;

  StreamInfo info_;
};

// Nothing for kinds of a newer contract.
std::optional<Notice> ToNotice(const v1::StreamNotice& notice);

// The configuration of a stream. INVALID_CONFIG if a number is negative that
// the message cannot hold.
absl::StatusOr<v1::StreamConfig> ToConfig(const SkinInfo& skin,
                                          const StreamOptions& options);

}  // namespace tactus::internal::client
