// File: load_run.h
//
// LoadRun: one load test, or the part of it that this process simulates.
//
//   LoadRun run(options, script);
//   TACTUS_RETURN_IF_ERROR(run.Open());
//   const LoadTally& tally = run.Send(LoadClockNs() + LoadRun::kLeadNs);
//
// Processes that share a test open their streams first; then all begin at the
// same moment. Large: keep it on the heap. Not thread-safe; used once.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "tools/load/connection_loop.h"
#include "tools/load/grpc_connection.h"
#include "tools/load/load.h"
#include "tools/load/load_robot.h"
#include "tools/load/load_stream.h"
#include "tools/load/load_tally.h"
#include "tools/load/schedule.h"
#include "tools/load/server_place.h"

namespace tactus::internal::client {

class LoadRun {
 public:
  // Time that a process has until it sends the first message.
  static constexpr int64_t kLeadNs = 20'000'000;

  // INVALID_CONFIG if it could not be run.
  static absl::Status Check(const LoadOptions& options);

  // Both must outlive it; `options` pass Check.
  LoadRun(const LoadOptions& options, const FrameScript& script);

  // Opens a stream for each robot and waits until the server has accepted or
  // refused it. An error if an address is wrong or unknown.
  absl::Status Open();
  // Sends from `start_ns` on, waits for answers and ends all streams.
  const LoadTally& Send(int64_t start_ns);

 private:
  // What its streams share, one after another of `share`; a new one if the old
  // one is lost.
  std::shared_ptr<GrpcConnection> Shared(size_t place);
  std::shared_ptr<GrpcConnection> NewConnection(int server);
  absl::Status FindServers();
  void OpenRobots();
  void SendAll(int64_t start_ns);
  // How many messages each robot of all processes sends.
  std::vector<uint64_t> DrawEnds() const;
  // Takes what has come meanwhile, once a tick, even when late.
  void WaitUntilDue(int64_t due_ns);
  void ReadSlowly(int64_t now_ns);
  void AwaitAnswers();
  void CloseAll();

  const LoadOptions& options_;
  LoadShared shared_;
  int64_t period_ns_ = 0;
  uint64_t messages_ = 0;
  // Outlives all connections.
  ConnectionLoop loop_;
  std::vector<ServerPlace> places_;
  // What robots share; empty if each stream has its own connection.
  std::vector<std::shared_ptr<GrpcConnection>> connections_;
  // How far sending has come.
  int64_t tick_ns_ = 0;
  std::unique_ptr<Schedule> schedule_;
  // In the order of their phases.
  std::vector<std::unique_ptr<LoadRobot>> robots_;
  // Those the server accepted.
  std::vector<LoadRobot*> senders_;
  // Those of them that read slowly, and when they do next.
  std::vector<LoadRobot*> slow_;
  int64_t next_slow_read_ns_ = 0;
};

}  // namespace tactus::internal::client
