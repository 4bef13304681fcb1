// File: load_tally.h
//
// LoadTally: what a load test counted. Tallies of tests that ran at the same
// time can be added, because they hold all delays and no percentiles.
//
//   LoadTally all;
//   all.Add(tally);
//   const LoadReport report = ReportOf(all);
//
// Plain data. Not thread-safe.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "tools/load/latency_histogram.h"
#include "tools/load/load.h"

namespace tactus::internal::client {

struct LoadTally {
  int robots = 0;
  // As in LoadReport.
  uint64_t sent = 0;
  uint64_t answered = 0;
  uint64_t answers = 0;
  uint64_t superseded = 0;
  uint64_t unannounced = 0;
  uint64_t slow_superseded = 0;
  int streams = 0;
  int refused = 0;
  int failed = 0;
  std::string first_error = {};
  // From when a message was due to the answers to its frames, to its writing;
  // from when a stream was due to end to its last answer.
  LatencyHistogram answer_delay = {};
  LatencyHistogram send_delay = {};
  LatencyHistogram final_delay = {};
  // Length of the test, and processor time of its process, s.
  double elapsed_s = 0;
  double cpu_s = 0;

  // As if `other` had been part of the same test.
  void Add(const LoadTally& other);
  // The same of robots that read slowly on purpose: their delays and what they
  // made the server drop say nothing about the server.
  void AddSlow(const LoadTally& slow);

 private:
  void AddCounts(const LoadTally& other);
};

LoadReport ReportOf(const LoadTally& tally);

// One line, with each bucket of the delays, and what it said. INVALID_CONFIG if
// it is no such line.
std::string TallyToText(const LoadTally& tally);
absl::Status ReadTally(const std::string& text, LoadTally* tally);

}  // namespace tactus::internal::client
