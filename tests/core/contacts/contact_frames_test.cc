#include "core/contacts/contact_frames.h"

#include "core/base/random.h"
#include "gtest/gtest.h"

namespace tactus {
namespace {

bool Same(const ContactFrame& a, const ContactFrame& b) {
  return a.sample.features == b.sample.features &&
         a.sample.net_force == b.sample.net_force &&
         a.sample.profile == b.sample.profile && a.touched == b.touched;
}

// Against a plain vector, for any order of ordinary and special frames.
TEST(ContactFramesTest, KeepsEveryNumber) {
  Random random(1);
  for (int round = 0; round < 200; ++round) {
    std::vector<ContactFrame> plain;
    ContactFrames frames;
    for (int t = 0; t < 12; ++t) {
      ContactFrame frame;
      frame.sample.features = {random.Uniform(), random.Uniform(), -0.0};
      frame.sample.net_force = frame.sample.features[0];
      if (random.Index(12) == 0) frame.sample.net_force += 1;
      if (random.Index(12) == 0) frame.sample.profile[15] = random.Uniform();
      if (random.Index(12) == 0) frame.touched = false;
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

}  // namespace
}  // namespace tactus
