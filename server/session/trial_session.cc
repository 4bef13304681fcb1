#include "server/session/trial_session.h"

#include <cstdint>
#include <utility>

#include "core/base/errors.h"
#include "core/base/limits.h"
#include "google/protobuf/io/coded_stream.h"
#include "google/protobuf/io/zero_copy_stream_impl_lite.h"
#include "google/protobuf/wire_format_lite.h"

namespace tactus::internal::server {
namespace {

using google::protobuf::internal::WireFormatLite;

constexpr uint32_t Tag(int field) {
  return WireFormatLite::MakeTag(field,
                                 WireFormatLite::WIRETYPE_LENGTH_DELIMITED);
}

constexpr uint32_t kConfigTag =
    Tag(v1::ClassifyTrialRequest::kConfigFieldNumber);
constexpr uint32_t kTrialFramesTag =
    Tag(v1::ClassifyTrialRequest::kFramesFieldNumber);

// A part's bytes are also a ClassifyContactRequest with this one field.
static_assert(kConfigTag ==
                  Tag(v1::ClassifyContactRequest::kConfigFieldNumber) &&
              kTrialFramesTag ==
                  Tag(v1::ClassifyContactRequest::kFramesFieldNumber));

}  // namespace

TrialSession::TrialSession(const ModelSource* models,
                           StreamSession::Options options, std::string bytes)
    : session_(models, std::move(options)), bytes_(std::move(bytes)) {}

void TrialSession::Step(v1::ClassifyContactRequest* request) {
  if (bytes_.size() > limits::kMaxTrialBytes) {
    session_.Finish(MessageTooLarge(bytes_.size(), limits::kMaxTrialBytes));
  } else if (position_ < bytes_.size()) {
    TakePart(request);
  } else {
    request->mutable_end_of_trial();
    session_.OnRequest(*request).IgnoreError();
    session_.OnHalfClose();
  }
  KeepAnswers();
  done_ = session_.state() == StreamSession::State::kDone;
}

void TrialSession::TakePart(v1::ClassifyContactRequest* request) {
  const char* begin = bytes_.data() + position_;
  google::protobuf::io::CodedInputStream rest(
      reinterpret_cast<const uint8_t*>(begin),
      static_cast<int>(bytes_.size() - position_));
  const uint32_t tag = rest.ReadTag();
  if (tag == 0 || !WireFormatLite::SkipField(&rest, tag)) {
    session_.Finish(MalformedRequest(bytes_.size()));
    return;
  }
  const int size = rest.CurrentPosition();
  position_ += size;
  // Fields of a newer contract are ignored, as protobuf does.
  if (tag != kConfigTag && tag != kTrialFramesTag) return;
  google::protobuf::io::ArrayInputStream part(begin, size);
  session_.OnMessage(&part, size, request).IgnoreError();
}

void TrialSession::KeepAnswers() {
  ResponseQueue& answers = session_.responses();
  while (const v1::ClassifyContactResponse* answer = answers.StartWrite(0)) {
    if (answer->has_started()) {
      *response_.mutable_started() = answer->started();
    } else if (answer->notice().kind() == v1::StreamNotice::KIND_RATE_DIFFERS) {
      *response_.mutable_notice() = answer->notice();
    } else if (answer->answer().is_final()) {
      *response_.mutable_answer() = answer->answer();
    } else {
      KeepEnded(answer->answer());
    }
    answers.FinishWrite();
  }
}

void TrialSession::KeepEnded(const v1::Answer& answer) {
  auto* ended = response_.mutable_ended_contacts();
  for (const v1::Contact& contact : answer.contacts()) {
    if (contact.state() != v1::Contact::STATE_RELEASED) continue;
    if (ended->size() == limits::kMaxTrialContacts) {
      ended->DeleteSubrange(0, 1);
    }
    *ended->Add() = contact;
  }
}

}  // namespace tactus::internal::server
