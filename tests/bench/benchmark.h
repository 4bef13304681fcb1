// File: benchmark.h
//
// What every sub-benchmark of tactus-bench is: flags of its own, and rows of
// one form. A row measures ours and, in the same run, a peer.
//
//   class HmmBenchmark : public Benchmark { ... };
//   app.Add(std::make_unique<HmmBenchmark>());
//
// A benchmark fails on a wrong answer, never on a slow machine; what is not
// installed is absent from its row, never invented. Not thread-safe.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace CLI {
class App;
}  // namespace CLI

namespace tactus::client {

struct BenchRow {
  // "hmm/forward".
  std::string name;
  // Of `ours` and `peer`: "ns", "s", "ms", "1/s", "KiB".
  std::string unit;
  double ours = 0;
  // Absent where there is none, or where it is not installed.
  std::optional<double> peer = {};
  std::string peer_name = {};
  // Largest difference from the reference, in the reference's own terms.
  std::optional<double> error = {};
  std::string error_reference = {};
  // Share of answers that are right, where the row is of a classifier.
  std::optional<double> accuracy = {};

  // How many times better ours is: peer over ours for times and sizes, ours
  // over peer for rates. Nothing without a peer.
  std::optional<double> Ratio() const;
};

class Benchmark {
 public:
  virtual ~Benchmark() = default;

  // The sub-command.
  virtual const char* name() const = 0;
  virtual const char* description() const = 0;
  virtual void AddFlags(CLI::App& /*command*/) {}
  // `quick`: so little that it only shows that the benchmark works.
  virtual absl::StatusOr<std::vector<BenchRow>> Run(bool quick) = 0;
};

// One JSON array: name, unit, ours, peer, peer_name, ratio, error,
// error_reference, accuracy; null where absent.
std::string RowsToJson(const std::vector<BenchRow>& rows);

// The same as aligned text for people.
std::string RowsToText(const std::vector<BenchRow>& rows);

}  // namespace tactus::client
