// File: load_robot.h
//
// LoadRobot: a robot of a load test, which comes and goes: its streams, one
// after another.
//
//   LoadRobot robot(&shared, {.number = 3}, connect);
//   robot.Open();                  // then serve until shared.settled
//   robot.Offer(message, due_ns);  // each time a message is due
//   robot.Close(due_ns);           // then serve until shared.ended
//
// Messages are numbered over all of its streams. When a stream's time is over
// it is closed, and the next one takes the message that is due: what opening
// costs is part of that message's delay. Not thread-safe.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "core/base/random.h"
#include "tools/load/grpc_connection.h"
#include "tools/load/load_stream.h"

namespace tactus::internal::client {

class LoadRobot {
 public:
  struct Options {
    int number = 0;
    // How many messages it sends; Offer takes no more.
    uint64_t messages = 0;
    // Mean number of messages of a stream; 0: one stream takes all.
    double stream_messages = 0;
    bool reads_slowly = false;
    // Fixes when streams end.
    uint64_t seed = 1;
  };
  // The connection of a new stream.
  using Connect = std::function<std::shared_ptr<GrpcConnection>()>;

  LoadRobot(LoadShared* shared, const Options& options, Connect connect);

  LoadRobot(const LoadRobot&) = delete;
  LoadRobot& operator=(const LoadRobot&) = delete;

  // Opens its first stream.
  void Open();
  // The server accepted the stream that it has now.
  bool accepted() const { return stream_->accepted(); }
  int number() const { return options_.number; }
  uint64_t messages() const { return options_.messages; }

  void Offer(uint64_t message, int64_t due_ns);
  void Close(int64_t due_ns = 0);
  void Cancel();
  // A slow reader takes its next answer, and all that come.
  void ReadNext() { stream_->ReadNext(); }
  void ReadAll() { stream_->ReadAll(); }

  // Answers to all messages came, or must have been left out.
  bool processed() const;
  // Add what was sent and answered so far, and how streams ended, to the tally.
  // Each is called once, after the last Offer.
  void CountAnswers();
  void CountEnds();

 private:
  void OpenStream(uint64_t first_message);
  void CountAnswers(const LoadStream& stream);
  void CountEnd(const LoadStream& stream);
  // Counts old streams that are over, and deletes them.
  void Reap();
  // The length of the next stream in messages: `least` to 1.5 times the mean.
  uint64_t DrawLength(double least);

  LoadShared* const shared_;
  const Options options_;
  const Connect connect_;
  LoadTally* const tally_;
  Random random_;
  // The message that begins the next stream.
  uint64_t next_stream_ = 0;
  std::unique_ptr<LoadStream> stream_;
  // Those before it that are not over.
  std::vector<std::unique_ptr<LoadStream>> old_;
};

}  // namespace tactus::internal::client
