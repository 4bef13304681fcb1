// File: load_stream.h
//
// LoadStream: one robot of a load test, on a completion queue, so that
// thousands need no separate threads.
//
//   LoadStream stream(&shared, {.robot = 3});
//   stream.Open(channel, loop.queue());  // then serve until shared.settled
//   stream.Offer();                // each time a message is due
//   stream.Close();                // then serve until shared.ended
//
// A message that comes due while the one before is still being written waits
// its turn; its delay counts from when it was due. A slow reader takes an
// answer only when told to, until it is closed. Must live until it is over() or
// its EventLoop is gone. Not thread-safe.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>

#include "absl/status/status.h"
#include "core/base/call_event.h"
#include "grpcpp/channel.h"
#include "grpcpp/client_context.h"
#include "grpcpp/generic/generic_stub.h"
#include "tactus/v1/contact.pb.h"
#include "tools/load/frame_script.h"
#include "tools/load/load_tally.h"
#include "tools/load/schedule.h"

namespace tactus::internal::client {

// What the streams of one test share.
struct LoadShared {
  const FrameScript* script = nullptr;
  uint32_t frames_per_message = 1;
  v1::ResultCadence cadence = v1::RESULT_CADENCE_EVERY_FRAME;
  // Set before the first Offer.
  const Schedule* schedule = nullptr;
  // What was due earlier is not put into the histograms.
  int64_t measure_from_ns = 0;

  // Streams add their delays: those that read slowly to the second.
  LoadTally tally = {};
  LoadTally slow_tally = {};

  // False if the cadence leaves frames unanswered.
  bool answers_all() const {
    return cadence == v1::RESULT_CADENCE_EVERY_FRAME ||
           cadence == v1::RESULT_CADENCE_EVERY_N_FRAMES;
  }

  // Streams that were opened, that the server accepted or refused, that ended.
  int opened = 0;
  int settled = 0;
  int ended = 0;
};

class LoadStream {
 public:
  struct Options {
    int robot = 0;
    // Number of its first message among those of the robot.
    uint64_t first_message = 0;
    bool reads_slowly = false;
  };

  // `shared` must outlive the stream.
  LoadStream(LoadShared* shared, const Options& options);

  LoadStream(const LoadStream&) = delete;
  LoadStream& operator=(const LoadStream&) = delete;

  void Open(const std::shared_ptr<grpc::Channel>& channel,
            grpc::CompletionQueue* queue);
  void Offer();
  // Half-closes once all is written. The delay of the last answer counts from
  // `due_ns`; 0: from nowhere.
  void Close(int64_t due_ns = 0);

  // Lets a slow reader take its next answer.
  void ReadNext();
  // It reads slowly no more.
  void ReadAll();

  void Cancel() { context_.TryCancel(); }

  bool reads_slowly() const { return options_.reads_slowly; }
  bool accepted() const { return accepted_; }
  uint64_t offered() const { return offered_; }
  // See LoadReport.
  uint64_t answered() const {
    return shared_->answers_all() && !reads_slowly() ? answered_ : processed();
  }
  // Messages up to the last one of which an answer names the last frame.
  uint64_t processed() const {
    return last_sequence_ / shared_->frames_per_message;
  }
  uint64_t answers() const { return answers_; }
  // Answers the server dropped because this client read slowly.
  uint64_t superseded() const { return superseded_; }
  uint64_t unannounced() const {
    return newest_contact_ - std::min(newest_contact_, touches_);
  }
  // Once it ended.
  const absl::Status& status() const { return status_; }
  // It ended, and no event of it is to come.
  bool over() const { return ended_ && in_flight_ == 0; }

 private:
  using Event = MemberEvent<LoadStream>;

  void OnStarted(bool ok);
  void OnWritten(bool ok);
  void OnRead(bool ok);
  void OnHalfClosed(bool) { --in_flight_; }
  void HalfCloseIfWritten();
  void OnFinished(bool ok);

  void Write(const grpc::ByteBuffer& message);
  void WriteNext();
  void StartRead();
  int64_t DueNs(uint64_t message) const {
    return shared_->schedule->DueNs(options_.robot,
                                    options_.first_message + message);
  }
  // Accepted or refused.
  void Settle();
  void OnAnswer(const v1::Answer& answer, int64_t now_ns);
  void OnFinal(int64_t now_ns);
  void CountContacts(const v1::Answer& answer);

  LoadShared* const shared_;
  const Options options_;
  LoadTally* const tally_;
  // Where in the script this stream begins.
  const size_t script_offset_;
  grpc::ClientContext context_;
  std::unique_ptr<grpc::GenericClientAsyncReaderWriter> call_;
  Event started_{this, &LoadStream::OnStarted};
  Event write_done_{this, &LoadStream::OnWritten};
  Event read_done_{this, &LoadStream::OnRead};
  Event half_closed_{this, &LoadStream::OnHalfClosed};
  Event finished_{this, &LoadStream::OnFinished};

  // Messages that are due and not written yet; the configuration is the first.
  uint32_t pending_ = 1;
  bool closing_ = false;
  int64_t close_due_ns_ = 0;
  // The server has sent all that it will; its status came.
  bool read_all_ = false;
  bool ended_ = false;
  // Operations whose events have not come yet.
  int in_flight_ = 0;
  // A slow reader reads at once from now on; it waits to be told to read.
  bool hurries_ = false;
  bool read_waits_ = false;
  uint64_t offered_ = 0;
  uint64_t written_ = 0;
  grpc::ByteBuffer read_;
  v1::ClassifyContactResponse response_;
  bool settled_ = false;
  uint64_t last_sequence_ = 0;
  bool accepted_ = false;
  uint64_t answered_ = 0;
  uint64_t answers_ = 0;
  uint64_t superseded_ = 0;
  // The largest id of a contact, and touches reported.
  uint64_t newest_contact_ = 0;
  uint64_t touches_ = 0;
  grpc::Status grpc_status_;
  absl::Status status_;
};

// Nanoseconds of the clock that schedules are in.
int64_t LoadClockNs();

}  // namespace tactus::internal::client
