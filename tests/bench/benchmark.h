// File: benchmark.h
//
// The interface of the sub-benchmarks of tactus-bench (benchmarks.h), and the
// rows that they print. A row measures our code and, in the same run, a peer.
//
//   class HmmBenchmark : public Benchmark { ... };
//   app.Add(std::make_unique<HmmBenchmark>());
//
// A benchmark fails on a wrong answer, never on a slow machine. If a peer is
// not installed, its columns are empty. Not thread-safe.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace CLI {
class App;
}  // namespace CLI

namespace tactus::internal::client {

struct BenchRow {
  // "hmm/forward".
  std::string name;
  // Unit of `ours` and `peer`: "ns", "s", "ms", "1/s", "KiB".
  std::string unit;
  double ours = 0;
  // Absent if there is no peer, or if it is not installed.
  std::optional<double> peer = {};
  std::string peer_name = {};
  // Largest difference from the reference; error_reference says in which terms.
  std::optional<double> error = {};
  std::string error_reference = {};
  // Fraction of right answers, for rows of classifiers.
  std::optional<double> accuracy = {};

  // How many times better our value is: peer over ours for times and sizes,
  // ours over peer for rates. Absent without a peer.
  std::optional<double> Ratio() const;
};

class Benchmark {
 public:
  virtual ~Benchmark() = default;

  // The sub-command.
  virtual const char* name() const = 0;
  virtual const char* description() const = 0;
  virtual void AddFlags(CLI::App& /*command*/) {}
  // `quick`: a short run that only shows that the benchmark works.
  virtual absl::StatusOr<std::vector<BenchRow>> Run(bool quick) = 0;
};

// One JSON array: name, unit, ours, peer, peer_name, ratio, error,
// error_reference, accuracy; null where absent.
std::string RowsToJson(const std::vector<BenchRow>& rows);

// The same as aligned text for people.
std::string RowsToText(const std::vector<BenchRow>& rows);

}  // namespace tactus::internal::client
