#include "tools/load/load_tally.h"

#include <algorithm>

#include "core/base/errors.h"
#include "tools/common/json.h"

namespace tactus::internal::client {
namespace {

double Ms(const LatencyHistogram& histogram, double fraction) {
  return static_cast<double>(histogram.PercentileNs(fraction)) / 1e6;
}

Json DelaysToJson(const LatencyHistogram& histogram) {
  Json json = {{"max_ns", histogram.max_ns()}, {"buckets", Json::array()}};
  histogram.ForEachBucket([&json](size_t bucket, uint64_t count) {
    json["buckets"].push_back({bucket, count});
  });
  return json;
}

void ReadDelays(const Json& json, LatencyHistogram* histogram) {
  for (const Json& pair : json.at("buckets")) {
    histogram->AddToBucket(pair.at(0).get<size_t>(),
                           pair.at(1).get<uint64_t>());
  }
  histogram->RaiseMax(json.at("max_ns").get<int64_t>());
}

// The counts of a tally by name.
template <typename Tally, typename Visit>
void VisitCounts(Tally* tally, Visit visit) {
  visit("robots", tally->robots);
  visit("sent", tally->sent);
  visit("answered", tally->answered);
  visit("answers", tally->answers);
  visit("superseded", tally->superseded);
  visit("unannounced", tally->unannounced);
  visit("slow_superseded", tally->slow_superseded);
  visit("streams", tally->streams);
  visit("refused", tally->refused);
  visit("failed", tally->failed);
  visit("first_error", tally->first_error);
  visit("elapsed_s", tally->elapsed_s);
  visit("cpu_s", tally->cpu_s);
}

}  // namespace

void LoadTally::Add(const LoadTally& other) {
  AddCounts(other);
  superseded += other.superseded;
  answer_delay.Add(other.answer_delay);
  send_delay.Add(other.send_delay);
  final_delay.Add(other.final_delay);
}

void LoadTally::AddSlow(const LoadTally& slow) {
  AddCounts(slow);
  slow_superseded += slow.superseded;
}

void LoadTally::AddCounts(const LoadTally& other) {
  robots += other.robots;
  streams += other.streams;
  sent += other.sent;
  answered += other.answered;
  answers += other.answers;
  slow_superseded += other.slow_superseded;
  unannounced += other.unannounced;
  refused += other.refused;
  failed += other.failed;
  if (first_error.empty()) first_error = other.first_error;
  elapsed_s = std::max(elapsed_s, other.elapsed_s);
  cpu_s += other.cpu_s;
}

LoadReport ReportOf(const LoadTally& tally) {
  const double elapsed_s = std::max(tally.elapsed_s, 1e-9);
  return {.robots = tally.robots,
          .sent = tally.sent,
          .answered = tally.answered,
          .answers = tally.answers,
          .superseded = tally.superseded,
          .unannounced = tally.unannounced,
          .slow_superseded = tally.slow_superseded,
          .streams = tally.streams,
          .refused = tally.refused,
          .failed = tally.failed,
          .first_error = tally.first_error,
          .p50_ms = Ms(tally.answer_delay, 0.5),
          .p90_ms = Ms(tally.answer_delay, 0.9),
          .p99_ms = Ms(tally.answer_delay, 0.99),
          .p999_ms = Ms(tally.answer_delay, 0.999),
          .max_ms = Ms(tally.answer_delay, 1),
          .send_p99_ms = Ms(tally.send_delay, 0.99),
          .final_p50_ms = Ms(tally.final_delay, 0.5),
          .answers_per_s = static_cast<double>(tally.answers) / elapsed_s,
          .cpu_share = tally.cpu_s / elapsed_s};
}

std::string TallyToText(const LoadTally& tally) {
  Json json;
  VisitCounts(&tally, [&json](const char* name, const auto& value) {
    json[name] = value;
  });
  json["answer_delay"] = DelaysToJson(tally.answer_delay);
  json["send_delay"] = DelaysToJson(tally.send_delay);
  json["final_delay"] = DelaysToJson(tally.final_delay);
  return JsonText(json);
}

absl::Status ReadTally(const std::string& text, LoadTally* tally) {
  try {
    const Json json = Json::parse(text);
    VisitCounts(tally, [&json](const char* name, auto& value) {
      json.at(name).get_to(value);
    });
    ReadDelays(json.at("answer_delay"), &tally->answer_delay);
    ReadDelays(json.at("send_delay"), &tally->send_delay);
    ReadDelays(json.at("final_delay"), &tally->final_delay);
  } catch (const Json::exception& error) {
    return InvalidConfig("tally", error.what(), "a line of a generator");
  }
  return absl::OkStatus();
}

}  // namespace tactus::internal::client
