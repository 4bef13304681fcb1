// File: report.h
//
// Report: what a run of tactus-stream prints: a line per contact, in the order
// of the trials, and a summary of what was felt, answered and decided.
//
//   Report report(stdout);
//   report.SetClassNames(names);
//   report.Add(result);        // prints the lines that are due
//   report.PrintSummary();
//
// Not thread-safe.
#pragma once

#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "tools/common/json.h"
#include "tools/stream/trial_player.h"

namespace tactus::internal::client {

class Report {
 public:
  // Contacts and summary go to `out`.
  explicit Report(std::FILE* out) : out_(out) {}

  // Class names are known with the first stream.
  void SetClassNames(const std::vector<std::string>& names) { names_ = names; }
  // After the class names. A contact whose turn it is not yet is printed when
  // those before it are there, or by PrintSummary().
  void Add(const TrialResult& result);
  void AddTotals(const TrialPlayer::Totals& totals);

  void PrintSummary();
  Json ToJson() const;
  // One JSON object a line and trial, numbers with 17 significant digits. IO
  // if the file cannot be written.
  absl::Status WritePosteriors(const std::string& path) const;

 private:
  // Numbers of trials: of one class, or of all.
  struct Counts {
    int trials = 0;
    int felt = 0;
    // Felt, and the last answer names the label or another class.
    int right = 0;
    int wrong = 0;
    // Felt, and the decision names the label or another class.
    int decided_right = 0;
    int decided_wrong = 0;

    int never_felt() const { return trials - felt; }
    int undecided() const { return felt - decided_right - decided_wrong; }
    Json ToJson() const;
  };

  // Counts of each class, and of all classes at the end.
  std::vector<Counts> Count() const;
  std::string Words(int class_index) const;
  // The width of a column of classes.
  int WordWidth() const;
  void PrintContact(const TrialResult& result);
  void PrintClasses(const std::vector<Counts>& counts) const;
  void PrintConfusion() const;
  std::vector<std::vector<int>> Confusion() const;
  std::vector<double> DecisionTimes() const;

  std::FILE* const out_;
  std::vector<std::string> names_;
  // By place in the driver's list.
  std::map<size_t, TrialResult> results_;
  // Place of the next trial to print; its header stands above the first.
  size_t next_ = 0;
  bool has_header_ = false;
  TrialPlayer::Totals totals_;
};

}  // namespace tactus::internal::client
