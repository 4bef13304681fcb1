#include "core/contacts/contact_frames.h"

#include "core/base/random.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

bool Same(const ContactFrame& a, const ContactFrame& b) {
  return a.sample.features == b.sample.features &&
         a.sample.net_force == b.sample.net_force &&
         a.sample.profile == b.sample.profile &&
         a.sample.spread == b.sample.spread &&
         a.sample.shear == b.sample.shear && a.touched == b.touched;
}

// A frame of ideal signals, now and then with a net force of its own or without
// touch.
ContactFrame SometimesSpecial(Random& random) {
  ContactFrame frame;
  frame.sample.features = {random.Uniform(), random.Uniform(), -0.0};
  frame.sample.net_force = frame.sample.features[0];
  if (random.Index(12) == 0) frame.sample.net_force += 1;
  if (random.Index(12) == 0) frame.touched = false;
  if (random.Index(12) == 0) frame.sample.spread = {1e-4F, 0};
  if (random.Index(12) == 0) frame.sample.shear = {0, -2.5F};
  return frame;
}

// Against a plain vector, for any order of ordinary and special frames.
TEST(ContactFramesTest, KeepsEveryNumber) {
  Random random(1);
  for (int round = 0; round < 200; ++round) {
    std::vector<ContactFrame> plain;
    ContactFrames frames;
    for (int t = 0; t < 12; ++t) {
      ContactFrame frame = SometimesSpecial(random);
      if (random.Index(12) == 0) frame.sample.profile[15] = random.Uniform();
      if (t > 6) {
        frames.Set(t - 6, frame);
        plain[t - 6] = frame;
      }
      frames.push_back(frame);
      plain.push_back(frame);
    }
    ASSERT_EQ(frames.size(), plain.size());
    size_t t = 0;
    for (const ContactFrame& frame : frames) {
      ASSERT_TRUE(Same(frame, plain[t]));
      ASSERT_EQ(frames.net_force(t), plain[t].sample.net_force);
      ASSERT_EQ(frames.touched(t), plain[t].touched);
      ++t;
    }
    EXPECT_TRUE(Same(frames.back(), plain.back()));
    frames.clear();
    EXPECT_TRUE(frames.empty());
  }
}

// Without a whole skin, numbers() is all there is of a frame.
TEST(ContactFramesTest, NumbersMakeTheSameFrames) {
  Random random(2);
  for (int round = 0; round < 200; ++round) {
    ContactFrames frames;
    ContactFrames copy;
    for (int t = 0; t < 12; ++t) {
      const ContactFrame frame = SometimesSpecial(random);
      frames.push_back(frame);
      copy.push_back_numbers({frame.sample.features, frame.sample.net_force,
                              frame.touched, frame.sample.spread,
                              frame.sample.shear});
      if (t > 6) {
        frames.Set(t - 6, frame);
        copy.SetNumbers(t - 6, frames.numbers(t));
      }
    }
    EXPECT_TRUE(copy.plain());
    ASSERT_EQ(copy.size(), frames.size());
    for (size_t t = 0; t < frames.size(); ++t) {
      ASSERT_TRUE(Same(copy[t], frames[t])) << t;
    }
    EXPECT_EQ(copy.bytes(), frames.bytes());
  }
}

// The numbers of a frame are replaced, and its place on the skin stays.
TEST(ContactFramesTest, NumbersLeaveTheWholeSkinAlone) {
  ContactFrames frames;
  const TaxelLoad load = {.taxel = 7, .root = 0.5f};
  ContactFrame frame;
  frame.sample.loads = std::span(&load, 1);
  frame.sample.profile[3] = 1;
  frames.push_back(frame);
  EXPECT_FALSE(frames.plain());
  frames.SetNumbers(0, {{1, 2, 3}, 4, true, {}});
  EXPECT_EQ(frames.features(0), (FeatureVector{1, 2, 3}));
  EXPECT_EQ(frames.net_force(0), 4);
  EXPECT_EQ(frames[0].sample.profile[3], 1);
  ASSERT_EQ(frames.loads(0).size(), 1u);
  EXPECT_EQ(frames.loads(0)[0].taxel, 7u);
}

}  // namespace
}  // namespace tactus::internal
