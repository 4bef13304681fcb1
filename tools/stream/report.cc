#include "tools/stream/report.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <limits>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "core/base/errors.h"
#include "tools/common/class_words.h"
#include "tools/common/percentile.h"

namespace tactus::internal::client {
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

Json Report::Counts::ToJson() const {
  return {{"trials", trials},
          {"felt", felt},
          {"never_felt", never_felt()},
          {"right", right},
          {"wrong", wrong},
          {"decided_right", decided_right},
          {"decided_wrong", decided_wrong},
          {"undecided", undecided()}};
}

void Report::Add(const TrialResult& result) {
  results_[result.index] = result;
  for (auto due = results_.find(next_); due != results_.end();
       due = results_.find(next_)) {
    PrintContact(due->second);
    ++next_;
  }
}

void Report::AddTotals(const TrialPlayer::Totals& totals) {
  totals_.frames += totals.frames;
  totals_.lost += totals.lost;
  totals_.resumed += totals.resumed;
  totals_.rtt_us.insert(totals_.rtt_us.end(), totals.rtt_us.begin(),
                        totals.rtt_us.end());
}

std::string Report::Words(int class_index) const {
  return ClassWords(names_[class_index]);
}

int Report::WordWidth() const {
  size_t longest = std::strlen("answer");
  for (const std::string& name : names_) {
    longest = std::max(longest, ClassWords(name).size());
  }
  return static_cast<int>(longest);
}

void Report::PrintContact(const TrialResult& result) {
  constexpr int kIdWidth = 8;
  const int width = WordWidth();
  if (!has_header_) {
    std::fprintf(out_, "%-*s  %-*s  %-*s  %-5s  %-5s  %s\n", kIdWidth, "trial",
                 width, "label", width, "answer", "", "prob.", "decision");
    has_header_ = true;
  }
  std::fprintf(out_, "%-*s  %-*s  ", kIdWidth, result.id.c_str(), width,
               Words(result.label).c_str());
  if (!result.detected) {
    std::fprintf(out_, "never felt\n");
    return;
  }
  const std::string decision =
      result.decision
          ? absl::StrFormat("%s after %.0f ms%s", Words(*result.decision),
                            result.decision_ms,
                            *result.decision == result.label ? "" : "  WRONG")
          : "undecided";
  std::fprintf(out_, "%-*s  %-5s  %.3f  %s\n", width,
               Words(result.answer).c_str(),
               result.answer == result.label ? "" : "WRONG",
               result.probability[result.answer], decision.c_str());
}

std::vector<Report::Counts> Report::Count() const {
  std::vector<Counts> counts(names_.size() + 1);
  for (const auto& [index, result] : results_) {
    for (Counts* const count : {&counts[result.label], &counts.back()}) {
      ++count->trials;
      if (!result.detected) continue;
      ++count->felt;
      ++(result.answer == result.label ? count->right : count->wrong);
      if (!result.decision) continue;
      ++(*result.decision == result.label ? count->decided_right
                                          : count->decided_wrong);
    }
  }
  return counts;
}

void Report::PrintClasses(const std::vector<Counts>& counts) const {
  const int width = WordWidth();
  std::fprintf(out_, "\n%-*s  %6s  %6s  %10s  %6s  %6s  %13s  %13s  %9s\n",
               width, "class", "trials", "felt", "never felt", "right", "wrong",
               "decided right", "decided wrong", "undecided");
  for (size_t k = 0; k < counts.size(); ++k) {
    const bool all = k + 1 == counts.size();
    const Counts& c = counts[k];
    if (c.trials == 0 && !all) continue;
    std::fprintf(out_, "%-*s  %6d  %6d  %10d  %6d  %6d  %13d  %13d  %9d\n",
                 width, all ? "all" : Words(static_cast<int>(k)).c_str(),
                 c.trials, c.felt, c.never_felt(), c.right, c.wrong,
                 c.decided_right, c.decided_wrong, c.undecided());
  }
}

void Report::PrintConfusion() const {
  constexpr int kMaxWidth = 100;
  const int width = WordWidth();
  // Too wide for a terminal: --json has the matrix.
  if ((width + 2) * (static_cast<int>(names_.size()) + 1) > kMaxWidth) return;
  const auto confusion = Confusion();
  std::fprintf(out_,
               "\nlabel (rows) and last answer (columns) of what was felt"
               "\n%-*s",
               width, "");
  for (size_t k = 0; k < names_.size(); ++k) {
    std::fprintf(out_, "  %*s", width, Words(static_cast<int>(k)).c_str());
  }
  std::fprintf(out_, "\n");
  for (size_t k = 0; k < names_.size(); ++k) {
    std::fprintf(out_, "%-*s", width, Words(static_cast<int>(k)).c_str());
    for (const int count : confusion[k]) {
      std::fprintf(out_, "  %*d", width, count);
    }
    std::fprintf(out_, "\n");
  }
}

void Report::PrintSummary() {
  for (const auto& [index, result] : results_) {
    if (index >= next_) PrintContact(result);
  }
  next_ = results_.empty() ? 0 : results_.rbegin()->first + 1;
  const std::vector<Counts> counts = Count();
  const Counts& all = counts.back();
  PrintClasses(counts);
  PrintConfusion();
  const auto part = [](int count, int of) {
    return of == 0 ? absl::StrCat("0 of 0")
                   : absl::StrFormat("%d of %d (%.1f %%)", count, of,
                                     100.0 * count / of);
  };
  std::fprintf(out_, "\nfelt: %s; never felt: %d\n",
               part(all.felt, all.trials).c_str(), all.never_felt());
  std::fprintf(out_, "right at the end of the contact: %s of those felt\n",
               part(all.right, all.felt).c_str());
  const auto times = DecisionTimes();
  std::fprintf(out_,
               "decided rightly: %s of those felt; decided wrongly: %d; "
               "undecided: %d\n",
               part(all.decided_right, all.felt).c_str(), all.decided_wrong,
               all.undecided());
  if (!times.empty()) {
    std::fprintf(out_,
                 "time to the decision as it stood in the end: median %.0f ms, "
                 "90 %% within %.0f ms\n",
                 Percentile(times, 0.5), Percentile(times, 0.9));
  }
  std::fprintf(out_,
               "round trip: median %.0f us, 99 %% within %.0f us\n"
               "frames: %llu, lost: %llu\n",
               Percentile(totals_.rtt_us, 0.5),
               Percentile(totals_.rtt_us, 0.99),
               static_cast<unsigned long long>(totals_.frames),
               static_cast<unsigned long long>(totals_.lost));
  if (totals_.resumed == 0) return;
  std::fprintf(out_, "lost streams that went on: %llu\n",
               static_cast<unsigned long long>(totals_.resumed));
}

Json Report::ToJson() const {
  const auto times = DecisionTimes();
  const std::vector<Counts> counts = Count();
  Json json = counts.back().ToJson();
  json["accuracy"] = NumberOrNull(
      counts.back().felt == 0
          ? std::numeric_limits<double>::quiet_NaN()
          : static_cast<double>(counts.back().right) / counts.back().felt);
  json["classes"] = Json::array();
  for (size_t k = 0; k < names_.size(); ++k) {
    Json of_class = counts[k].ToJson();
    of_class["name"] = names_[k];
    of_class["words"] = Words(static_cast<int>(k));
    json["classes"].push_back(std::move(of_class));
  }
  json["confusion"] = Confusion();
  json["decision_ms"] = {{"p50", NumberOrNull(Percentile(times, 0.5))},
                         {"p90", NumberOrNull(Percentile(times, 0.9))}};
  json["rtt_us"] = {{"p50", NumberOrNull(Percentile(totals_.rtt_us, 0.5))},
                    {"p99", NumberOrNull(Percentile(totals_.rtt_us, 0.99))}};
  json["frames"] = totals_.frames;
  json["lost"] = totals_.lost;
  json["undetectable"] = counts.back().never_felt();
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

}  // namespace tactus::internal::client
