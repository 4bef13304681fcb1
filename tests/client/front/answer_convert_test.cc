#include "client/front/answer_convert.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/allocation_counter.h"

namespace tactus::internal::client {
namespace {

using ::testing::ElementsAre;

v1::StreamStarted Started() {
  v1::StreamStarted started;
  started.set_model_version("models/m/versions/2");
  for (const char* name : {"HU", "HM"}) started.add_class_names(name);
  v1::Question* question = started.add_questions();
  question->set_name("mobility");
  question->set_kind(v1::Question::KIND_STATE);
  for (const char* value : {"unmoved", "moved"}) question->add_values(value);
  started.mutable_geometry()->set_rows(4);
  started.mutable_geometry()->set_columns(5);
  started.mutable_limits()->set_max_contacts(8);
  return started;
}

v1::Answer MovedContact() {
  v1::Answer answer;
  answer.set_sequence(31);
  answer.set_capture_time_ns(310);
  v1::Contact* contact = answer.add_contacts();
  contact->set_id(3);
  contact->set_state(v1::Contact::STATE_TOUCHING);
  contact->set_time_since_onset_ns(120'000'000);
  for (const double p : {0.25, 0.75}) contact->add_probability(p);
  v1::QuestionAnswer* question = contact->add_answers();
  for (const double p : {0.25, 0.75}) question->add_probability(p);
  question->mutable_decision()->set_value(1);
  question->mutable_decision()->set_sequence(30);
  contact->mutable_patch()->set_force(2);
  contact->mutable_patch()->add_taxels(6);
  v1::ContactEvent* event = answer.add_events();
  event->set_kind(v1::ContactEvent::KIND_DECIDED);
  event->set_contact_id(3);
  event->set_value(1);
  event = answer.add_events();
  event->set_kind(v1::ContactEvent::KIND_MERGED);
  event->set_contact_id(3);
  event->set_other_id(2);
  return answer;
}

TEST(AnswerConvertTest, IndicesBecomeNames) {
  const AnswerConverter converter(Started());
  EXPECT_EQ(converter.info().model_version, "models/m/versions/2");
  EXPECT_THAT(converter.info().classes, ElementsAre("HU", "HM"));
  ASSERT_EQ(converter.info().questions.size(), 1u);
  EXPECT_TRUE(converter.info().questions[0].is_state);
  Answer answer;
  converter.Convert(MovedContact(), answer);
  ASSERT_NE(answer.main(), nullptr);
  const Contact& contact = *answer.main();
  EXPECT_EQ(contact.classes[1].name, "HM");
  EXPECT_EQ(contact.classes[1].probability, 0.75);
  EXPECT_EQ(contact.Probability("mobility", "moved"), 0.75);
  EXPECT_EQ(contact.Probability("mobility", "asleep"), 0);
  EXPECT_EQ(contact.Probability("hardness", "hard"), 0);
  EXPECT_EQ(contact.Decided("mobility"), "moved");
  EXPECT_EQ(contact.Decided("hardness"), "");
  EXPECT_THAT(contact.patch->taxels, ElementsAre(6));
  ASSERT_EQ(answer.events.size(), 2u);
  EXPECT_EQ(ToText(answer.events[0]),
            "120 ms: contact 3 decided mobility: moved");
  EXPECT_EQ(ToText(answer.events[1]),
            "120 ms: contact 3 merged into contact 2");
}

TEST(AnswerConvertTest, ANoticeOfAnUnlikeSkinNamesItsTaxels) {
  v1::StreamNotice notice;
  notice.set_kind(v1::StreamNotice::KIND_SKIN_DIFFERS);
  notice.set_differing_taxels(5);
  for (uint32_t i = 0; i < 4; ++i) {
    v1::TaxelReading* taxel = notice.add_taxels();
    taxel->set_taxel(10 + i);
    taxel->set_load(40);
    taxel->set_least_trained(0.5);
    taxel->set_most_trained(2.25);
  }
  const auto converted = ToNotice(notice);
  ASSERT_TRUE(converted.has_value());
  EXPECT_EQ(converted->kind, Notice::Kind::kSkinDiffers);
  EXPECT_EQ(converted->text,
            "5 taxels read unlike any recording of training, in several "
            "contacts: taxel 10 40 (0.5 to 2.25 in training), taxel 11 40 (0.5 "
            "to 2.25 in training), taxel 12 40 (0.5 to 2.25 in training), ...");
}

TEST(AnswerConvertTest, WhatIsAbsentIsNotLeftFromBefore) {
  const AnswerConverter converter(Started());
  Answer answer;
  converter.Convert(MovedContact(), answer);
  v1::Answer bare;
  bare.add_contacts()->set_id(4);
  bare.mutable_contacts(0)->add_answers();
  bare.add_events()->set_kind(static_cast<v1::ContactEvent::Kind>(99));
  converter.Convert(bare, answer);
  ASSERT_EQ(answer.contacts.size(), 1u);
  EXPECT_FALSE(answer.contacts[0].patch);
  EXPECT_FALSE(answer.contacts[0].motion_m);
  EXPECT_FALSE(answer.contacts[0].object);
  EXPECT_EQ(answer.contacts[0].Decided("mobility"), "");
  EXPECT_TRUE(answer.events.empty());
}

TEST(AnswerConvertTest, AnAnswerLikeTheOneBeforeAllocatesNothing) {
  const AnswerConverter converter(Started());
  const v1::Answer from = MovedContact();
  Answer answer;
  converter.Convert(from, answer);
  const testing::AllocationCounter counter;
  converter.Convert(from, answer);
  EXPECT_EQ(counter.count(), 0u);
}

}  // namespace
}  // namespace tactus::internal::client
