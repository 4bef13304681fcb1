#include "core/eval/question_outcome.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tactus::internal {

QuestionWatch::QuestionWatch(const QuestionTruth& truth, Question::Kind kind)
    : truth_(truth) {
  if (kind == Question::kProperty) {
    from_ = 0;
    watched_ = true;
  } else if (truth.history_known()) {
    from_ = truth.change();
    watched_ = !from_;
  }
}

void QuestionWatch::Step(size_t frame,
                         std::span<const double> value_probability) {
  const int right = truth_.at(frame);
  const auto best = std::ranges::max_element(value_probability);
  const int answer = static_cast<int>(best - value_probability.begin());
  const bool sure = *best > kSure;
  if (sure && answer != right) alarm_ = true;
  if (!from_) return;
  if (frame < *from_) {
    if (sure && answer == truth_.final_value()) early_ = true;
    return;
  }
  if (sure && answer == right && !sure_) sure_ = frame;
  if (answer != right) {
    settled_.reset();
  } else if (!settled_) {
    settled_ = frame;
  }
}

QuestionTiming QuestionWatch::Finish(double sample_rate_hz) const {
  const auto since = [&](size_t from, const std::optional<size_t>& frame) {
    return frame ? std::optional(static_cast<double>(*frame - from) /
                                 sample_rate_hz)
                 : std::nullopt;
  };
  QuestionTiming timing;
  if (from_) {
    timing.from_s = since(0, from_);
    timing.delay_s = since(*from_, sure_);
    timing.settled_s = since(*from_, settled_);
  }
  if (watched_) timing.false_alarm = alarm_;
  timing.early = early_;
  return timing;
}

DelaySummary SummariseDelays(std::vector<std::optional<double>> delays) {
  DelaySummary summary;
  summary.count = static_cast<int>(delays.size());
  summary.missed = static_cast<int>(std::ranges::count_if(
      delays, [](const auto& delay) { return !delay.has_value(); }));
  if (delays.empty()) return summary;
  const auto value = [](const std::optional<double>& delay) {
    return delay.value_or(std::numeric_limits<double>::infinity());
  };
  std::ranges::sort(delays, {}, value);
  const auto quantile = [&](int percent) {
    // Integers, because 0.9 x 10 is above 9 in floating point.
    const size_t rank = (delays.size() * percent + 99) / 100;
    return delays[rank - 1];
  };
  summary.median = quantile(50);
  summary.p90 = quantile(90);
  summary.p99 = quantile(99);
  return summary;
}

QuestionSummary Summarise(const Question& question,
                          std::span<const QuestionOutcome> outcomes) {
  QuestionSummary summary;
  std::vector<std::optional<double>> delays;
  std::vector<std::optional<double>> late;
  std::vector<std::optional<double>> settled;
  std::vector<int> right_if_constant(question.values.size());
  for (const QuestionOutcome& outcome : outcomes) {
    const QuestionTiming& timing = outcome.timing;
    if (timing.from_s) {
      delays.push_back(timing.delay_s);
      settled.push_back(timing.settled_s);
      if (*timing.from_s > kLateS) late.push_back(timing.delay_s);
    }
    summary.watched += timing.false_alarm.has_value();
    summary.false_alarms += timing.false_alarm.value_or(false);
    summary.early += timing.early;
    summary.changed += outcome.changes > 0;
    if (!outcome.decision) continue;
    ++summary.made;
    summary.right += outcome.decision->value == outcome.decision->truth;
    ++right_if_constant[outcome.decision->truth];
  }
  summary.delay = SummariseDelays(std::move(delays));
  summary.delay_late = SummariseDelays(std::move(late));
  summary.settled = SummariseDelays(std::move(settled));
  const auto most = std::ranges::max_element(right_if_constant);
  summary.constant_value = static_cast<int>(most - right_if_constant.begin());
  summary.constant_right = *most;
  return summary;
}

}  // namespace tactus::internal
