#include "tools/load/load_stream.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "client/stream/status.h"
#include "grpcpp/impl/codegen/proto_utils.h"
#include "grpcpp/support/proto_buffer_reader.h"

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
                     options.first_message) {}

void LoadStream::Open(const std::shared_ptr<grpc::Channel>& channel,
                      grpc::CompletionQueue* queue) {
  call_ = grpc::GenericStub(channel).PrepareCall(&context_, kMethod, queue);
  ++shared_->opened;
  ++in_flight_;
  call_->StartCall(started_.tag());
}

void LoadStream::OnStarted(bool ok) {
  --in_flight_;
  // If the call failed, the read reports it.
  StartRead();
  if (!ok) return;
  v1::ClassifyContactRequest request;
  *request.mutable_config() = shared_->script->config();
  request.mutable_config()->set_cadence(shared_->cadence);
  const grpc::Slice bytes(request.SerializeAsString());
  Write(grpc::ByteBuffer(&bytes, 1));
}

void LoadStream::Write(const grpc::ByteBuffer& message) {
  ++in_flight_;
  call_->Write(message, write_done_.tag());
}

void LoadStream::StartRead() {
  ++in_flight_;
  call_->Read(&read_, read_done_.tag());
}

void LoadStream::ReadNext() {
  if (std::exchange(read_waits_, false)) StartRead();
}

void LoadStream::ReadAll() {
  hurries_ = true;
  ReadNext();
}

void LoadStream::Offer() {
  ++offered_;
  if (pending_++ == 0) WriteNext();
}

void LoadStream::WriteNext() {
  const uint64_t message = written_++;
  const uint64_t frames = message * shared_->frames_per_message;
  const int64_t due_ns = DueNs(message);
  if (due_ns >= shared_->measure_from_ns) {
    tally_->send_delay.Add(LoadClockNs() - due_ns);
  }
  Write(shared_->script->Message(script_offset_ + message, frames + 1));
}

void LoadStream::OnWritten(bool ok) {
  --in_flight_;
  // After a failure or the stream's end nothing will ever be written again. A
  // write may outlast the end, and the queue is shut down by then.
  if (!ok || read_all_) return;
  if (--pending_ > 0) {
    WriteNext();
  } else {
    HalfCloseIfWritten();
  }
}

void LoadStream::OnRead(bool ok) {
  --in_flight_;
  const int64_t now_ns = LoadClockNs();
  if (!ok) {
    read_all_ = true;
    Settle();
    ++in_flight_;
    call_->Finish(&grpc_status_, finished_.tag());
    return;
  }
  grpc::ProtoBufferReader bytes(&read_);
  if (!response_.ParseFromZeroCopyStream(&bytes)) {
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
  if (accepted_ && reads_slowly() && !hurries_) {
    read_waits_ = true;
  } else {
    StartRead();
  }
}

void LoadStream::OnAnswer(const v1::Answer& answer, int64_t now_ns) {
  const uint64_t frames = shared_->frames_per_message;
  const uint64_t sequence = answer.sequence();
  if (sequence > written_ * frames) {
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
  HalfCloseIfWritten();
}

void LoadStream::HalfCloseIfWritten() {
  if (!closing_ || pending_ > 0) return;
  ++in_flight_;
  call_->WritesDone(half_closed_.tag());
}

void LoadStream::OnFinished(bool) {
  --in_flight_;
  ended_ = true;
  status_ = FromGrpcStatus(grpc_status_);
  ++shared_->ended;
}

}  // namespace tactus::internal::client
