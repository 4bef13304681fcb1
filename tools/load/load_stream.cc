#include "tools/load/load_stream.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

namespace tactus::internal::client {
namespace {

constexpr char kMethod[] = "/tactus.v1.ContactService/ClassifyContact";
// Spreads the robots over the script, whatever its length.
constexpr double kGoldenRatio = 0.6180339887498949;

size_t OffsetOf(int robot, size_t script_size) {
  const double place = kGoldenRatio * robot;
  return static_cast<size_t>((place - std::floor(place)) *
                             static_cast<double>(script_size));
}

}  // namespace

int64_t LoadClockNs() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

LoadStream::LoadStream(LoadShared* shared, const Options& options)
    : shared_(shared),
      options_(options),
      tally_(options.reads_slowly ? &shared->slow_tally : &shared->tally),
      script_offset_(OffsetOf(options.robot, shared->script->size()) +
                     options.first_message),
      call_(this, kMethod) {}

void LoadStream::Open(std::shared_ptr<GrpcConnection> connection) {
  connection_ = std::move(connection);
  ++shared_->opened;
  // A slow reader, too, has to know whether it was accepted.
  if (reads_slowly()) {
    call_.ReadOne();
  } else {
    call_.ReadAll();
  }
  connection_->Start(&call_);
}

void LoadStream::Offer() {
  ++offered_;
  call_.Resume();
}

GrpcCall::Next LoadStream::TakeMessage(std::string* out) {
  if (!std::exchange(configured_, true)) {
    v1::ClassifyContactRequest request;
    *request.mutable_config() = shared_->script->config();
    request.mutable_config()->set_cadence(shared_->cadence);
    out->append(request.SerializeAsString());
    return GrpcCall::Next::kMessage;
  }
  if (sent_ == offered_) {
    return closing_ ? GrpcCall::Next::kNoMore : GrpcCall::Next::kLater;
  }
  const uint64_t message = sent_++;
  const uint64_t frames = message * shared_->frames_per_message;
  const int64_t due_ns = DueNs(message);
  if (due_ns >= shared_->measure_from_ns) {
    tally_->send_delay.Add(LoadClockNs() - due_ns);
  }
  shared_->script->AppendMessage(script_offset_ + message, frames + 1, out);
  return GrpcCall::Next::kMessage;
}

void LoadStream::OnMessage(absl::string_view message) {
  const int64_t now_ns = LoadClockNs();
  if (!response_.ParseFromArray(message.data(),
                                static_cast<int>(message.size()))) {
    Cancel();
  } else if (response_.has_answer() && accepted_) {
    OnAnswer(response_.answer(), now_ns);
  } else if (response_.has_started()) {
    accepted_ = true;
    Settle();
  } else if (!accepted_) {
    // No Tactus server begins like that.
    Cancel();
  }
}

void LoadStream::OnAnswer(const v1::Answer& answer, int64_t now_ns) {
  const uint64_t frames = shared_->frames_per_message;
  const uint64_t sequence = answer.sequence();
  if (sequence > sent_ * frames) {
    // No Tactus server answers frames that were never sent.
    Cancel();
    return;
  }
  superseded_ = answer.superseded();
  CountContacts(answer);
  const bool is_new = sequence > last_sequence_;
  last_sequence_ = std::max(sequence, last_sequence_);
  if (answer.is_final()) {
    OnFinal(now_ns);
    return;
  }
  if (!is_new) return;
  const int64_t due_ns = DueNs((sequence - 1) / frames);
  if (due_ns >= shared_->measure_from_ns) {
    tally_->answer_delay.Add(now_ns - due_ns);
  }
  ++answers_;
  if (sequence % frames == 0) ++answered_;
}

void LoadStream::OnFinal(int64_t now_ns) {
  if (close_due_ns_ >= shared_->measure_from_ns && close_due_ns_ > 0) {
    tally_->final_delay.Add(now_ns - close_due_ns_);
  }
}

void LoadStream::CountContacts(const v1::Answer& answer) {
  for (const v1::Contact& contact : answer.contacts()) {
    newest_contact_ = std::max(newest_contact_, contact.id());
  }
  for (const v1::ContactEvent& event : answer.events()) {
    if (event.kind() == v1::ContactEvent::KIND_TOUCHED) ++touches_;
  }
}

void LoadStream::Settle() {
  if (std::exchange(settled_, true)) return;
  ++shared_->settled;
}

void LoadStream::Close(int64_t due_ns) {
  if (closing_) return;
  closing_ = true;
  close_due_ns_ = due_ns;
  ReadAll();
  call_.Resume();
}

void LoadStream::OnEnded(const absl::Status& status) {
  ended_ = true;
  status_ = status;
  Settle();
  ++shared_->ended;
}

}  // namespace tactus::internal::client
