// File: load.h
//
// An open-loop load test: robots that send frames at their rate whether or not
// answers come, as robots do. A delay counts from the moment a message was due
// by the schedule, not from when it could be sent, so that a server that
// stalls is charged for all that waited (no coordinated omission).
//
//   TACTUS_ASSIGN_OR_RETURN(const LoadReport report,
//                           RunLoad({.servers = {"127.0.0.1:50051"}}));
//   report.lost();
//
// One thread sends and takes the answers, every half millisecond; what
// waits for that counts as delay. Thread-safe: a free function without state.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "tactus/v1/contact.pb.h"
#include "tools/load/frame_script.h"

namespace tactus::internal::client {

struct LoadOptions {
  // Robots are spread over them.
  std::vector<std::string> servers = {};
  // As in client/stream/channel.h.
  std::optional<std::string> tls_roots = {};
  int robots = 200;
  double rate_hz = 100;
  double seconds = 10;
  // First part of `seconds`, whose messages are counted, but in no percentile.
  double warm_up_seconds = 1;
  uint32_t frames_per_message = 1;
  // When the server answers. RESULT_CADENCE_EVERY_N_FRAMES: once a message.
  v1::ResultCadence cadence = v1::RESULT_CADENCE_EVERY_FRAME;
  bool sparse = false;
  // Before each contact: how often skins are touched.
  double untouched_seconds = 1;
  // If set, contacts are such a fraction of all frames, 0 or 0.02 to 1, and
  // untouched_seconds has no meaning.
  std::optional<double> touched_fraction = {};
  // Mean seconds after which a stream ends and the robot opens the next; 0: one
  // stream for the whole test.
  double arrivals_seconds = 0;
  // So many robots take one answer a second.
  int slow_readers = 0;
  // Shared by the robots, at least one to each server; 0: one for each stream.
  int connections = 0;
  uint64_t seed = 1;
  // This process simulates the robots whose number modulo `parts` is `part`.
  int part = 0;
  int parts = 1;
};

struct LoadReport {
  int robots = 0;
  // Messages due by the schedule, and those of them answered: the answer to
  // their last frame came. Where the cadence leaves frames unanswered, those
  // that the server has certainly processed: an answer names their last frame
  // or a later one. The last answer of a stream names its last frame.
  uint64_t sent = 0;
  uint64_t answered = 0;
  uint64_t lost() const { return sent - answered; }
  // Answers that came, without those at the ends of streams.
  uint64_t answers = 0;
  // Answers that the server dropped because this client read slowly.
  uint64_t superseded = 0;
  // Contacts that answers name although no answer reported their touch. Such
  // answers are owed at every cadence.
  uint64_t unannounced = 0;
  // The same of robots that read slowly on purpose.
  uint64_t slow_superseded = 0;
  // Streams opened; those that were never accepted, and that ended with an
  // error later.
  int streams = 0;
  int refused = 0;
  int failed = 0;
  // Error of the first of these.
  std::string first_error = {};

  // From when a message was due to the answers to its frames, in ms; slow
  // readers are left out.
  double p50_ms = 0;
  double p90_ms = 0;
  double p99_ms = 0;
  double p999_ms = 0;
  double max_ms = 0;
  // From when it was due until it was on its way: the generator's own.
  double send_p99_ms = 0;
  // From when a stream was due to end to its last answer, which comes after all
  // others: how far behind the server was. 0 if every frame is answered.
  double final_p50_ms = 0;
  // Answers a second, and processor time of this process a second.
  double answers_per_s = 0;
  double cpu_share = 0;

  bool ok() const {
    return lost() == 0 && superseded == 0 && unannounced == 0 && refused == 0 &&
           failed == 0;
  }
};

// INVALID_CONFIG for options out of range. The report states whether the server
// was slow, refused streams or was absent. `script` comes from the same
// options.
absl::StatusOr<LoadReport> RunLoad(const LoadOptions& options,
                                   const FrameScript& script);
absl::StatusOr<LoadReport> RunLoad(const LoadOptions& options);

// Makes the frames that `options` ask for. This takes about a second of
// simulation, so callers that run several tests make them once.
absl::StatusOr<FrameScript> MakeScript(const LoadOptions& options);

std::string LoadToText(const LoadReport& report);
// One JSON object with the report's fields. `max_robots` is one more: what a
// search found.
std::string LoadToJson(const LoadReport& report,
                       std::optional<int> max_robots = std::nullopt);

}  // namespace tactus::internal::client
