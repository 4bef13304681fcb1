// File: load_stream.h
//
// LoadStream: one stream of a robot in a load test; thousands share a thread.
//
//   LoadStream stream(&shared, {.robot = 3});
//   stream.Open(connection);       // then serve until shared.settled
//   stream.Offer();                // each time a message is due
//   stream.Close();                // then serve until shared.ended
//
// A message that comes due while the server's flow-control window is full waits
// its turn; its delay counts from when it was due. A slow reader takes an
// answer only when told to, until it is closed. Not thread-safe.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "tactus/v1/contact.pb.h"
#include "tools/load/frame_script.h"
#include "tools/load/grpc_call.h"
#include "tools/load/grpc_connection.h"
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

class LoadStream final : private GrpcCall::Listener {
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

  void Open(std::shared_ptr<GrpcConnection> connection);
  void Offer();
  // Half-closes once all is written. The delay of the last answer counts from
  // `due_ns`; 0: from nowhere.
  void Close(int64_t due_ns = 0);

  // Lets a slow reader take its next answer.
  void ReadNext() { call_.ReadOne(); }
  // It reads slowly no more.
  void ReadAll() { call_.ReadAll(); }

  void Cancel() { call_.Cancel(); }

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
  bool over() const { return ended_; }

 private:
  GrpcCall::Next TakeMessage(std::string* out) override;
  void OnMessage(absl::string_view message) override;
  void OnEnded(const absl::Status& status) override;

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
  bool configured_ = false;
  bool closing_ = false;
  int64_t close_due_ns_ = 0;
  bool ended_ = false;
  // Messages that came due, and those of them that were sent.
  uint64_t offered_ = 0;
  uint64_t sent_ = 0;
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
  absl::Status status_;
  // The call ends before its connection.
  std::shared_ptr<GrpcConnection> connection_;
  GrpcCall call_;
};

// Nanoseconds of the clock that schedules are in.
int64_t LoadClockNs();

}  // namespace tactus::internal::client
