#include "server/rpc/answer_pacing.h"

#include "gtest/gtest.h"

namespace tactus::internal::server {
namespace {

TEST(AnswerPacingTest, EverySixteenthReadComesFirst) {
  AnswerPacing pacing;
  for (int i = 0; i < 64; ++i) {
    EXPECT_EQ(pacing.ReadsFirst(), i % 16 == 0) << i;
    pacing.OnReadStarted();
  }
}

TEST(AnswerPacingTest, AnswersAreHeldOnlyForAClientThatIsAhead) {
  AnswerPacing pacing;
  pacing.OnReadEnded(/*ok=*/true, /*writing=*/false);
  EXPECT_FALSE(pacing.Holds(/*reading=*/true));
  pacing.OnReadEnded(/*ok=*/true, /*writing=*/true);
  EXPECT_TRUE(pacing.Holds(/*reading=*/true));
  EXPECT_FALSE(pacing.Holds(/*reading=*/false));
  EXPECT_FALSE(pacing.ReadsFirst());
  // A half-close.
  pacing.OnReadEnded(/*ok=*/false, /*writing=*/true);
  EXPECT_FALSE(pacing.Holds(/*reading=*/true));
}

TEST(AnswerPacingTest, AHoldEndsWithTheNextMessageOrInIdleness) {
  AnswerPacing pacing;
  pacing.OnReadEnded(true, true);
  EXPECT_TRUE(pacing.BeginHold());
  EXPECT_FALSE(pacing.BeginHold());
  EXPECT_TRUE(pacing.held());
  // A message while answers are held: still ahead.
  pacing.OnReadEnded(true, false);
  EXPECT_TRUE(pacing.Holds(true));
  pacing.EndHold(/*idle=*/false);
  EXPECT_FALSE(pacing.held());
  EXPECT_TRUE(pacing.Holds(true));
  pacing.BeginHold();
  pacing.EndHold(/*idle=*/true);
  EXPECT_FALSE(pacing.Holds(true));
}

TEST(AnswerPacingTest, UpToFourAnswersShareAFlush) {
  AnswerPacing pacing;
  EXPECT_TRUE(pacing.Flushes(/*more=*/false));
  for (int round = 0; round < 3; ++round) {
    EXPECT_FALSE(pacing.Flushes(/*more=*/true));
    EXPECT_FALSE(pacing.Flushes(/*more=*/true));
    EXPECT_FALSE(pacing.Flushes(/*more=*/true));
    EXPECT_TRUE(pacing.Flushes(/*more=*/true));
  }
  EXPECT_FALSE(pacing.Flushes(/*more=*/true));
  EXPECT_TRUE(pacing.Flushes(/*more=*/false));
}

}  // namespace
}  // namespace tactus::internal::server
