// File: answer_metrics.h
//
// AnswerMetrics: what the server has told robots: contacts by what they were,
// decisions by question and value, and how long these took.
//
//   const AnswerMetrics::Series series = metrics.SeriesOf(started);
//   AnswerMetrics::Count(answer, series);   // answers with events
//   metrics.Collect(&families);
//
// There are at most kMaxSeries series, whatever models are served: contacts and
// decisions beyond are counted as "other". Thread-safe. SeriesOf takes a lock,
// once per stream; Count takes none.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "server/metrics/families.h"
#include "server/metrics/histogram.h"
#include "tactus/v1/contact.pb.h"

namespace tactus::internal::server {

class AnswerMetrics {
 public:
  static constexpr size_t kMaxSeries = 256;
  using Counter = std::atomic<uint64_t>;

  // Where the events of a stream are counted; valid as long as the metrics are.
  struct Series {
    struct Value {
      Counter* decided = nullptr;
      Counter* changed = nullptr;
    };
    struct Question {
      std::vector<Value> values;
      Histogram* seconds = nullptr;
    };
    Counter* begun = nullptr;
    Counter* unknown = nullptr;
    // Contacts that ended, by class.
    std::vector<Counter*> ended;
    std::vector<Question> questions;
  };

  Series SeriesOf(const v1::StreamStarted& started);
  // `answer` is of the stream that the series is of.
  static void Count(const v1::Answer& answer, const Series& series);
  void Collect(Families* families) const;

 private:
  // The counter of these labels, made if there is room.
  Counter* Find(std::map<Labels, Counter>& counters, Labels labels);
  Histogram* FindSeconds(const std::string& question);

  mutable std::mutex mutex_;
  size_t count_ = 0;
  std::map<Labels, Counter> ended_;
  std::map<Labels, Counter> decided_;
  std::map<Labels, Counter> changed_;
  std::map<std::string, Histogram> seconds_;
  Counter begun_ = 0;
  Counter unknown_ = 0;
};

}  // namespace tactus::internal::server
