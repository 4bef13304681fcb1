#include "server/metrics/answer_metrics.h"

#include <algorithm>

namespace tactus::internal::server {
namespace {

using v1::ContactEvent;

// A contact is unknown if this is more likely than not.
constexpr double kUnknown = 0.5;
constexpr char kOther[] = "other";

void Increment(AnswerMetrics::Counter* counter) {
  counter->fetch_add(1, std::memory_order_relaxed);
}

void CountEnd(const v1::Contact& contact, const AnswerMetrics::Series& series) {
  const auto& probability = contact.probability();
  if (contact.unknown() >= kUnknown) {
    Increment(series.unknown);
  } else if (!probability.empty()) {
    Increment(series.ended[std::ranges::max_element(probability) -
                           probability.begin()]);
  }
}

void AddAll(const std::map<Labels, AnswerMetrics::Counter>& counters,
            Family family, Families* families) {
  for (const auto& [labels, counter] : counters) {
    Add(labels, static_cast<double>(counter), &family);
  }
  families->push_back(std::move(family));
}

}  // namespace

AnswerMetrics::Counter* AnswerMetrics::Find(std::map<Labels, Counter>& counters,
                                            Labels labels) {
  if (!counters.contains(labels) && ++count_ > kMaxSeries) {
    for (auto& [name, value] : labels) value = kOther;
  }
  return &counters[labels];
}

Histogram* AnswerMetrics::FindSeconds(const std::string& question) {
  const bool has_room = seconds_.contains(question) || ++count_ <= kMaxSeries;
  return &seconds_.try_emplace(has_room ? question : kOther, kCallSeconds)
              .first->second;
}

AnswerMetrics::Series AnswerMetrics::SeriesOf(
    const v1::StreamStarted& started) {
  const std::lock_guard lock(mutex_);
  Series series;
  series.begun = &begun_;
  series.unknown = &unknown_;
  for (const std::string& name : started.class_names()) {
    series.ended.push_back(Find(ended_, {{"class", name}}));
  }
  for (const v1::Question& question : started.questions()) {
    Series::Question& of = series.questions.emplace_back();
    of.seconds = FindSeconds(question.name());
    for (const std::string& value : question.values()) {
      const Labels labels = {{"question", question.name()}, {"value", value}};
      of.values.push_back({Find(decided_, labels), Find(changed_, labels)});
    }
  }
  return series;
}

void AnswerMetrics::Count(const v1::Answer& answer, const Series& series) {
  for (const ContactEvent& event : answer.events()) {
    const auto contact = std::ranges::find(
        answer.contacts(), event.contact_id(), &v1::Contact::id);
    switch (event.kind()) {
      case ContactEvent::KIND_TOUCHED:
        Increment(series.begun);
        break;
      case ContactEvent::KIND_RELEASED:
        if (contact != answer.contacts().end()) CountEnd(*contact, series);
        break;
      case ContactEvent::KIND_DECIDED: {
        const Series::Question& question = series.questions[event.question()];
        Increment(question.values[event.value()].decided);
        if (contact == answer.contacts().end()) break;
        question.seconds->Observe(
            static_cast<double>(contact->time_since_onset_ns()) * 1e-9);
        break;
      }
      case ContactEvent::KIND_CHANGED:
        Increment(
            series.questions[event.question()].values[event.value()].changed);
        break;
      default:
        break;
    }
  }
}

void AnswerMetrics::Collect(Families* families) const {
  const std::lock_guard lock(mutex_);
  Family begun =
      CounterFamily("tactus_contacts_begun_total", "Contacts that began.");
  Add({}, static_cast<double>(begun_), &begun);
  families->push_back(std::move(begun));
  AddAll(ended_,
         CounterFamily("tactus_contacts_total",
                       "Contacts that ended, by their most probable class; "
                       "without those that are unknown."),
         families);
  Family unknown = CounterFamily(
      "tactus_contacts_unknown_total",
      "Contacts that ended as unlike anything that the model has learned.");
  Add({}, static_cast<double>(unknown_), &unknown);
  families->push_back(std::move(unknown));
  AddAll(decided_,
         CounterFamily("tactus_decisions_total",
                       "Questions that were decided, by value."),
         families);
  AddAll(changed_,
         CounterFamily("tactus_decision_changes_total",
                       "Decided values that changed, by the new value: "
                       "mobility to moved is a slip."),
         families);
  Family seconds = HistogramFamily("tactus_decision_seconds",
                                   "Time from onset to a decision.");
  for (const auto& [question, histogram] : seconds_) {
    Add({{"question", question}}, histogram.Read(), histogram.bounds(),
        &seconds);
  }
  families->push_back(std::move(seconds));
}

}  // namespace tactus::internal::server
