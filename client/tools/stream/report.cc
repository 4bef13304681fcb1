#include "client/tools/stream/report.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "client/tools/common/percentile.h"
#include "core/base/errors.h"

namespace tactus::client {
namespace {

// JSON has no NaN.
Json NumberOrNull(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

std::string ExactList(const std::vector<double>& values) {
  return absl::StrCat("[",
                      absl::StrJoin(values, ",",
                                    [](std::string* out, double value) {
                                      absl::StrAppendFormat(out, "%.17g",
                                                            value);
                                    }),
                      "]");
}

}  // namespace

void Report::Add(const TrialResult& result) { results_[result.index] = result; }

void Report::AddTotals(const TrialPlayer::Totals& totals) {
  totals_.frames += totals.frames;
  totals_.lost += totals.lost;
  totals_.resumed += totals.resumed;
  totals_.rtt_us.insert(totals_.rtt_us.end(), totals.rtt_us.begin(),
                        totals.rtt_us.end());
}

void Report::PrintLive(const TrialResult& result,
                       const std::vector<std::string>& names) const {
  const std::string head =
      absl::StrFormat("%s  %s", result.id, names[result.label]);
  if (!result.detected) {
    std::fprintf(out_, "%s  never felt\n", head.c_str());
    return;
  }
  const std::string decision =
      result.decision
          ? absl::StrFormat("decided %s after %.0f ms", names[*result.decision],
                            result.decision_ms)
          : "undecided";
  std::fprintf(out_, "%s -> %s %s  p %.3f  %s\n", head.c_str(),
               names[result.answer].c_str(),
               result.answer == result.label ? "ok   " : "WRONG",
               result.probability[result.answer], decision.c_str());
}

void Report::PrintConfusion() const {
  constexpr size_t kMinWidth = 8;
  constexpr size_t kMaxWidth = 100;
  size_t longest = kMinWidth;
  for (const std::string& name : names_) {
    longest = std::max(longest, name.size() + 1);
  }
  const auto confusion = Confusion();
  const int width = static_cast<int>(longest);
  std::fprintf(out_, "\n");
  // Too wide for a terminal: only what is right. --json has the matrix.
  if (longest * (names_.size() + 1) > kMaxWidth) {
    for (size_t k = 0; k < names_.size(); ++k) {
      std::fprintf(
          out_, "%-*s %4d of %d right\n", width, names_[k].c_str(),
          confusion[k][k],
          std::accumulate(confusion[k].begin(), confusion[k].end(), 0));
    }
    return;
  }
  std::fprintf(out_, "%-*s", width, "");
  for (const std::string& name : names_) {
    std::fprintf(out_, "%*s", width, name.c_str());
  }
  std::fprintf(out_, "   <- answer\n");
  for (size_t k = 0; k < names_.size(); ++k) {
    std::fprintf(out_, "%-*s", width, names_[k].c_str());
    for (const int count : confusion[k])
      std::fprintf(out_, "%*d", width, count);
    std::fprintf(out_, "\n");
  }
}

void Report::PrintTables() const {
  PrintConfusion();
  const auto times = DecisionTimes();
  std::fprintf(out_,
               "\naccuracy %.4f of %zu contacts (%d of %zu trials never felt)\n"
               "time to decision p50 %.0f ms, p90 %.0f ms (%zu decided)\n"
               "round trip p50 %.0f us, p99 %.0f us\n"
               "frames %llu, lost %llu\n",
               Accuracy(), results_.size() - Undetectable(), Undetectable(),
               results_.size(), Percentile(times, 0.5), Percentile(times, 0.9),
               times.size(), Percentile(totals_.rtt_us, 0.5),
               Percentile(totals_.rtt_us, 0.99),
               static_cast<unsigned long long>(totals_.frames),
               static_cast<unsigned long long>(totals_.lost));
  if (totals_.resumed == 0) return;
  std::fprintf(out_, "lost streams that went on %llu\n",
               static_cast<unsigned long long>(totals_.resumed));
}

Json Report::ToJson() const {
  const auto times = DecisionTimes();
  Json json;
  json["trials"] = results_.size();
  json["accuracy"] = NumberOrNull(Accuracy());
  json["confusion"] = Confusion();
  json["decision_ms"] = {{"p50", NumberOrNull(Percentile(times, 0.5))},
                         {"p90", NumberOrNull(Percentile(times, 0.9))}};
  json["rtt_us"] = {{"p50", NumberOrNull(Percentile(totals_.rtt_us, 0.5))},
                    {"p99", NumberOrNull(Percentile(totals_.rtt_us, 0.99))}};
  json["frames"] = totals_.frames;
  json["lost"] = totals_.lost;
  json["undetectable"] = Undetectable();
  json["resumed"] = totals_.resumed;
  return json;
}

absl::Status Report::WritePosteriors(const std::string& path) const {
  std::FILE* file = std::fopen(path.c_str(), "w");
  if (file == nullptr) return IoError(path, std::strerror(errno));
  bool good = true;
  for (const auto& [index, result] : results_) {
    const std::string line = absl::StrFormat(
        "{\"trial\":%s,\"probability\":%s,\"log_likelihood\":%s}\n",
        JsonText(result.id), ExactList(result.probability),
        ExactList(result.log_likelihood));
    good &= std::fputs(line.c_str(), file) >= 0;
  }
  good &= std::fclose(file) == 0;
  return good ? absl::OkStatus() : IoError(path, std::strerror(errno));
}

double Report::Accuracy() const {
  int detected = 0;
  int right = 0;
  for (const auto& [index, result] : results_) {
    detected += result.detected;
    right += result.detected && result.answer == result.label;
  }
  return detected == 0 ? std::numeric_limits<double>::quiet_NaN()
                       : static_cast<double>(right) / detected;
}

int Report::Undetectable() const {
  return static_cast<int>(
      std::count_if(results_.begin(), results_.end(),
                    [](const auto& entry) { return !entry.second.detected; }));
}

std::vector<std::vector<int>> Report::Confusion() const {
  std::vector<std::vector<int>> table(names_.size(),
                                      std::vector<int>(names_.size(), 0));
  for (const auto& [index, result] : results_) {
    if (result.detected) ++table[result.label][result.answer];
  }
  return table;
}

std::vector<double> Report::DecisionTimes() const {
  std::vector<double> times;
  for (const auto& [index, result] : results_) {
    if (result.detected && result.decision) times.push_back(result.decision_ms);
  }
  return times;
}

}  // namespace tactus::client
