// File: report.h
//
// Report: what a run of tactus-stream prints.
//
//   Report report(class_names, trials);
//   report.Add(result);       // a live line each
//   report.Print(totals);
//
// Not thread-safe.
#pragma once

#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "client/tools/json.h"
#include "client/tools/stream/trial_player.h"

namespace tactus::client {

class Report {
 public:
  // Live lines and tables go to `out`.
  explicit Report(std::FILE* out) : out_(out) {}

  // Class names are known with the first stream.
  void SetClassNames(const std::vector<std::string>& names) { names_ = names; }
  void Add(const TrialResult& result);
  void AddTotals(const TrialPlayer::Totals& totals);

  void PrintLive(const TrialResult& result,
                 const std::vector<std::string>& names) const;
  void PrintTables() const;
  Json ToJson() const;
  // One JSON object a line and trial, numbers with 17 significant digits. IO
  // if the file cannot be written.
  absl::Status WritePosteriors(const std::string& path) const;

 private:
  double Accuracy() const;
  int Undetectable() const;
  void PrintConfusion() const;
  std::vector<std::vector<int>> Confusion() const;
  std::vector<double> DecisionTimes() const;

  std::FILE* const out_;
  std::vector<std::string> names_;
  // By place in the driver's list.
  std::map<size_t, TrialResult> results_;
  TrialPlayer::Totals totals_;
};

}  // namespace tactus::client
