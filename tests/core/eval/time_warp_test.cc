#include "core/eval/time_warp.h"

#include "gtest/gtest.h"

namespace tactus {
namespace {

// Motion is the place in the contact, force its square.
Contact Press(int frames) {
  Contact contact;
  contact.label = "HM";
  for (int t = 0; t < frames; ++t) {
    const double x = t;
    contact.frames.push_back({IdealSample({x * x, 1, x})});
    contact.object_motion.push_back(3 * x);
  }
  return contact;
}

double Motion(const ContactFrame& frame) {
  return frame.sample.features[static_cast<int>(Feature::kMotion)];
}

TEST(AtPaceTest, PlaysTheSameSignalsFasterOrSlower) {
  const Contact contact = Press(101);
  for (double pace : {0.7, 1.4, 2.0}) {
    const Contact warped = AtPace(contact, pace);
    EXPECT_EQ(warped.label, "HM");
    for (size_t t = 0; t < warped.frames.size(); ++t) {
      const double place = pace * static_cast<double>(t);
      EXPECT_NEAR(Motion(warped.frames[t]), place, 1e-12);
      EXPECT_NEAR(warped.object_motion[t], 3 * place, 1e-12);
      // A chord of a parabola is at most a quarter above it.
      EXPECT_NEAR(warped.frames[t].sample.net_force, place * place, 0.2501);
    }
  }
}

TEST(AtPaceTest, LastsAsLongAsThereIsSomethingToPlay) {
  const Contact contact = Press(101);
  EXPECT_EQ(AtPace(contact, 2).frames.size(), 50u);
  EXPECT_EQ(AtPace(contact, 0.5).frames.size(), 101u);
  EXPECT_TRUE(AtPace(Press(1), 2).frames.empty());
}

TEST(AtPaceTest, MixesNothingIntoLostTouch) {
  Contact contact = Press(9);
  contact.frames[2] = {.sample = {}, .touched = false};
  const Contact warped = AtPace(contact, 0.5);
  EXPECT_TRUE(warped.frames[3].touched);
  EXPECT_EQ(Motion(warped.frames[3]), 1);
  EXPECT_FALSE(warped.frames[4].touched);
  EXPECT_FALSE(warped.frames[5].touched);
  EXPECT_TRUE(warped.frames[6].touched);
}

}  // namespace
}  // namespace tactus
