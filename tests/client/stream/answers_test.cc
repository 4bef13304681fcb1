// What a program asks of an answer, about contacts whose decisions are written
// by hand.
#include "client/stream/answers.h"

#include <cstdint>
#include <initializer_list>
#include <optional>

#include "gtest/gtest.h"
#include "tests/support/scripted_server.h"

namespace tactus::internal::client {
namespace {

constexpr int64_t kMs = 1'000'000;

// Hardness and mobility of HU, HM, SU and SM.
v1::StreamStarted Started() { return testing::GoodStarted().started(); }

// No question is decided.
v1::Contact Undecided() { return testing::GoodAnswer(1).answer().contacts(0); }

void Decide(int question, uint32_t value, int64_t after_ns,
            v1::Contact* contact) {
  v1::Decision* decision =
      contact->mutable_answers(question)->mutable_decision();
  decision->set_value(value);
  decision->set_time_since_onset_ns(after_ns);
}

TEST(AnswersTest, TheMainContactIsTheFirst) {
  v1::Answer answer;
  EXPECT_EQ(MainContact(answer), nullptr);
  answer.add_contacts()->set_id(7);
  answer.add_contacts()->set_id(3);
  EXPECT_EQ(MainContact(answer), &answer.contacts(0));
}

TEST(AnswersTest, OnlyAReleasedContactHasEnded) {
  v1::Contact contact;
  for (const auto state : {v1::Contact::STATE_TOUCHING, v1::Contact::STATE_LOST,
                           v1::Contact::STATE_MERGED}) {
    contact.set_state(state);
    EXPECT_TRUE(IsOpen(contact)) << v1::Contact::State_Name(state);
  }
  contact.set_state(v1::Contact::STATE_RELEASED);
  EXPECT_FALSE(IsOpen(contact));
}

TEST(AnswersTest, TheBestClassIsTheFirstOfTheMostProbable) {
  const auto best = [](std::initializer_list<double> probability) {
    v1::Contact contact;
    for (const double p : probability) contact.add_probability(p);
    return BestClass(contact);
  };
  EXPECT_EQ(best({1}), 0);
  EXPECT_EQ(best({0.1, 0.2, 0.6, 0.1}), 2);
  EXPECT_EQ(best({0.1, 0.2, 0.1, 0.6}), 3);
  EXPECT_EQ(best({0.4, 0.1, 0.4, 0.1}), 0);
}

TEST(AnswersTest, EachPairOfValuesIsAClass) {
  for (int hardness = 0; hardness < 2; ++hardness) {
    for (int mobility = 0; mobility < 2; ++mobility) {
      v1::Contact contact = Undecided();
      Decide(0, hardness, 50 * kMs, &contact);
      Decide(1, mobility, 40 * kMs, &contact);
      const auto decided = DecidedClassOf(Started(), contact);
      ASSERT_TRUE(decided);
      EXPECT_EQ(decided->class_index, 2 * hardness + mobility);
      EXPECT_EQ(decided->time_since_onset_ns, 50 * kMs);
    }
  }
}

TEST(AnswersTest, AnUndecidedQuestionDecidesNoClass) {
  v1::Contact contact = Undecided();
  EXPECT_EQ(DecidedClassOf(Started(), contact), std::nullopt);
  // Both values of the other question fit.
  Decide(0, 1, kMs, &contact);
  EXPECT_EQ(DecidedClassOf(Started(), contact), std::nullopt);
  contact = Undecided();
  // A decision for value 0 differs from none.
  Decide(1, 0, kMs, &contact);
  EXPECT_EQ(DecidedClassOf(Started(), contact), std::nullopt);
}

TEST(AnswersTest, ADecisionThatChangesCountsFromItsChange) {
  v1::Contact contact = Undecided();
  Decide(0, 0, 120 * kMs, &contact);
  Decide(1, 1, 30 * kMs, &contact);
  v1::Decision* mobility = contact.mutable_answers(1)->mutable_decision();
  mobility->set_changes(1);
  mobility->set_changed_time_since_onset_ns(90 * kMs);
  EXPECT_EQ(DecidedClassOf(Started(), contact)->time_since_onset_ns, 120 * kMs);
  mobility->set_changed_time_since_onset_ns(400 * kMs);
  EXPECT_EQ(DecidedClassOf(Started(), contact)->time_since_onset_ns, 400 * kMs);
}

TEST(AnswersTest, ValuesOfNoClassDecideNone) {
  v1::StreamStarted started = Started();
  // No class is soft and moved.
  started.mutable_class_names()->RemoveLast();
  started.mutable_questions(0)->mutable_value_of_class()->RemoveLast();
  started.mutable_questions(1)->mutable_value_of_class()->RemoveLast();
  v1::Contact contact = Undecided();
  Decide(0, 1, kMs, &contact);
  Decide(1, 1, kMs, &contact);
  EXPECT_EQ(DecidedClassOf(started, contact), std::nullopt);
  Decide(1, 0, kMs, &contact);
  EXPECT_EQ(DecidedClassOf(started, contact)->class_index, 2);
}

TEST(AnswersTest, ValuesOfTwoClassesDecideNone) {
  v1::StreamStarted started = Started();
  // Nobody asked for mobility.
  started.mutable_questions()->RemoveLast();
  v1::Contact contact = Undecided();
  contact.mutable_answers()->RemoveLast();
  Decide(0, 0, kMs, &contact);
  EXPECT_EQ(DecidedClassOf(started, contact), std::nullopt);
}

}  // namespace
}  // namespace tactus::internal::client
