#include "server/metrics/answer_metrics.h"

#include "absl/strings/str_cat.h"
#include "gtest/gtest.h"

namespace tactus::internal::server {
namespace {

using v1::ContactEvent;

v1::StreamStarted Started() {
  v1::StreamStarted started;
  for (const char* name : {"hard", "soft"}) started.add_class_names(name);
  v1::Question& hardness = *started.add_questions();
  hardness.set_name("hardness");
  for (const char* value : {"hard", "soft"}) hardness.add_values(value);
  return started;
}

v1::Contact* AddContact(uint64_t id, double soft, v1::Answer* answer) {
  v1::Contact* contact = answer->add_contacts();
  contact->set_id(id);
  contact->add_probability(1 - soft);
  contact->add_probability(soft);
  contact->set_time_since_onset_ns(150'000'000);
  return contact;
}

void AddEvent(ContactEvent::Kind kind, uint64_t id, int value,
              v1::Answer* answer) {
  ContactEvent* event = answer->add_events();
  event->set_kind(kind);
  event->set_contact_id(id);
  event->set_value(value);
}

// The value of a counter with these labels; -1 if there is none.
double ValueOf(const AnswerMetrics& metrics, const std::string& name,
               const Labels& labels) {
  Families families;
  metrics.Collect(&families);
  for (const Family& family : families) {
    if (family.name != name) continue;
    for (const auto& metric : family.metric) {
      Labels has;
      for (const auto& label : metric.label)
        has.emplace_back(label.name, label.value);
      if (has == labels) return metric.counter.value;
    }
  }
  return -1;
}

TEST(AnswerMetricsTest, CountsWhatRobotsWereTold) {
  AnswerMetrics metrics;
  const auto series = metrics.SeriesOf(Started());
  v1::Answer answer;
  AddContact(1, 0.9, &answer);
  AddContact(2, 0.2, &answer)->set_unknown(0.7);
  AddEvent(ContactEvent::KIND_TOUCHED, 1, 0, &answer);
  AddEvent(ContactEvent::KIND_TOUCHED, 2, 0, &answer);
  AddEvent(ContactEvent::KIND_DECIDED, 1, 1, &answer);
  AddEvent(ContactEvent::KIND_CHANGED, 1, 0, &answer);
  AddEvent(ContactEvent::KIND_RELEASED, 1, 0, &answer);
  AddEvent(ContactEvent::KIND_RELEASED, 2, 0, &answer);
  AnswerMetrics::Count(answer, series);
  AnswerMetrics::Count(v1::Answer(), series);
  EXPECT_EQ(ValueOf(metrics, "tactus_contacts_begun_total", {}), 2);
  EXPECT_EQ(ValueOf(metrics, "tactus_contacts_total", {{"class", "soft"}}), 1);
  EXPECT_EQ(ValueOf(metrics, "tactus_contacts_total", {{"class", "hard"}}), 0);
  EXPECT_EQ(ValueOf(metrics, "tactus_contacts_unknown_total", {}), 1);
  const Labels soft = {{"question", "hardness"}, {"value", "soft"}};
  const Labels hard = {{"question", "hardness"}, {"value", "hard"}};
  EXPECT_EQ(ValueOf(metrics, "tactus_decisions_total", soft), 1);
  EXPECT_EQ(ValueOf(metrics, "tactus_decision_changes_total", hard), 1);
  EXPECT_EQ(series.questions[0].seconds->Read().count, 1u);
  EXPECT_DOUBLE_EQ(series.questions[0].seconds->Read().sum, 0.15);
}

// Models come from users: their names must not fill the memory.
TEST(AnswerMetricsTest, HasRoomForSoManySeries) {
  AnswerMetrics metrics;
  for (int model = 0; model < 100; ++model) {
    v1::StreamStarted started;
    for (int k = 0; k < 20; ++k) {
      started.add_class_names(absl::StrCat("class ", model, " ", k));
    }
    const auto series = metrics.SeriesOf(started);
    v1::Answer answer;
    AddContact(1, 0.9, &answer);
    AddEvent(ContactEvent::KIND_RELEASED, 1, 0, &answer);
    AnswerMetrics::Count(answer, series);
  }
  Families families;
  metrics.Collect(&families);
  size_t series = 0;
  for (const Family& family : families) series += family.metric.size();
  EXPECT_LE(series, AnswerMetrics::kMaxSeries + 8);
  EXPECT_EQ(ValueOf(metrics, "tactus_contacts_total", {{"class", "class 0 1"}}),
            1);
  // Those of the models that came too late.
  EXPECT_EQ(ValueOf(metrics, "tactus_contacts_total", {{"class", "other"}}),
            100 - 13);
}

}  // namespace
}  // namespace tactus::internal::server
