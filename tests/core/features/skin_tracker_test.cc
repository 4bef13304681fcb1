#include "core/features/skin_tracker.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "core/base/random.h"
#include "gtest/gtest.h"
#include "tests/support/allocation_counter.h"
#include "tests/support/flat_layout.h"

namespace tactus::internal {
namespace {

// A rectangle of taxels that read `value`; columns may cross the seam.
struct Patch {
  int row = 0;
  int column = 0;
  int rows = 1;
  int columns = 1;
  float value = 3;
};

// 20 x 30 taxels of 10 mm, contact at 1, onset at 2, at 100 Hz.
class Scene {
 public:
  explicit Scene(bool wrap = false, int max_contacts = 8,
                 bool reuse_unchanged = true)
      : layout_(MakeLayout(wrap)),
        tracker_(layout_, {.max_contacts = max_contacts,
                           .reuse_unchanged = reuse_unchanged}),
        taxels_(layout_.taxels()) {}

  // The same with light touch, which feels the mean of 3 x 3 taxels from 0.05
  // on, after half a second of idle skin.
  static Scene WithLightTouch() {
    SkinLayout layout = MakeLayout(/*wrap=*/false);
    layout.light_touch = {.window_s = 0.1,
                          .rows = 3,
                          .columns = 3,
                          .contact_threshold = 0.05,
                          .onset_threshold = 0.07};
    Scene scene(layout);
    for (int t = 0; t < 50; ++t) scene.Step({});
    return scene;
  }

  static SkinLayout MakeLayout(bool wrap) {
    SkinLayout layout = testing::FlatLayout(20, 30);
    layout.onset_threshold = 2;
    layout.wrap_columns = wrap;
    return layout;
  }

  void Step(const std::vector<Patch>& patches, const Pose* pose = nullptr,
            uint64_t missing_before = 0) {
    std::ranges::fill(taxels_, 0.0F);
    for (const Patch& patch : patches) {
      for (int r = 0; r < patch.rows; ++r) {
        for (int c = 0; c < patch.columns; ++c) {
          taxels_[(patch.row + r) * layout_.columns +
                  (patch.column + c) % layout_.columns] = patch.value;
        }
      }
    }
    tracker_.Step({taxels_, pose, missing_before});
  }

  SkinTracker& tracker() { return tracker_; }
  std::vector<uint64_t> Ids() const {
    std::vector<uint64_t> ids;
    for (const TrackedContact* contact : tracker_.contacts()) {
      ids.push_back(contact->id());
    }
    return ids;
  }
  // The contact with this id in the last frame; null if there is none.
  const TrackedContact* Find(uint64_t id) const {
    for (const TrackedContact* contact : tracker_.contacts()) {
      if (contact->id() == id) return contact;
    }
    return nullptr;
  }
  // Frames until the contact is released, given that nothing touches the skin.
  int FramesToRelease(uint64_t id) {
    for (int frames = 1; frames < 1000; ++frames) {
      Step({});
      if (Find(id)->phase == TouchPhase::kReleased) return frames;
    }
    return -1;
  }

 private:
  explicit Scene(const SkinLayout& layout)
      : layout_(layout),
        tracker_(layout_, {.max_contacts = 8}),
        taxels_(layout_.taxels()) {}

  SkinLayout layout_;
  SkinTracker tracker_;
  std::vector<float> taxels_;
};

using Ids = std::vector<uint64_t>;

TEST(SkinTrackerTest, EachTouchHasItsNumberAndTheLargestIsFirst) {
  Scene scene;
  const Patch small = {.row = 2, .column = 3, .rows = 2, .columns = 2};
  const Patch large = {.row = 12, .column = 20, .rows = 3, .columns = 4};
  scene.Step({small});
  EXPECT_EQ(scene.Ids(), Ids({1}));
  scene.Step({small, large});
  // Noise does not last: a second contact is there from its second frame on.
  EXPECT_EQ(scene.Ids(), Ids({1}));
  EXPECT_EQ(scene.tracker().regions(), 2);
  scene.Step({small, large});
  EXPECT_EQ(scene.Ids(), Ids({2, 1}));
  EXPECT_TRUE(scene.Find(2)->onset);
  EXPECT_EQ(scene.Find(2)->parent, 0u);
  EXPECT_EQ(scene.Find(2)->features().area_taxels, 12);
  EXPECT_EQ(scene.Find(2)->features().net_force, 36);
  EXPECT_EQ(scene.Find(1)->features().area_taxels, 4);
  EXPECT_EQ(scene.Find(1)->features().centroid.row, 2.5);
  scene.Step({small, large});
  EXPECT_FALSE(scene.Find(2)->onset);
}

TEST(SkinTrackerTest, WithOneContactAllRegionsAreItsParts) {
  Scene scene(false, 1);
  const Patch small = {.row = 2, .column = 3, .rows = 2, .columns = 2};
  const Patch large = {.row = 12, .column = 20, .rows = 3, .columns = 4};
  for (int t = 0; t < 10; ++t) scene.Step({small, large});
  EXPECT_EQ(scene.Ids(), Ids({1}));
  EXPECT_EQ(scene.Find(1)->features().area_taxels, 12);
  // The largest region counts, wherever it is.
  scene.Step({small});
  EXPECT_EQ(scene.Find(1)->features().area_taxels, 4);
}

TEST(SkinTrackerTest, ARegionBelowTheOnsetThresholdIsNoContact) {
  Scene scene;
  const Patch strong = {.row = 2, .column = 3};
  const Patch weak = {.row = 12, .column = 20, .value = 1.5};
  for (int t = 0; t < 10; ++t) scene.Step({strong, weak});
  EXPECT_EQ(scene.Ids(), Ids({1}));
}

TEST(SkinTrackerTest, APartNearbyIsNoContact) {
  const Patch contact = {.row = 5, .column = 5, .rows = 3, .columns = 3};
  for (const int between : {2, 4}) {
    Scene scene;
    const Patch part = {.row = 5, .column = 8 + between, .rows = 2};
    for (int t = 0; t < 10; ++t) scene.Step({contact, part});
    EXPECT_EQ(scene.Ids(), between == 2 ? Ids({1}) : Ids({1, 2}));
  }
}

TEST(SkinTrackerTest, AShortLossDoesNotEndAContact) {
  Scene scene;
  const Patch a = {.row = 2, .column = 3, .rows = 2, .columns = 2};
  const Patch b = {.row = 12, .column = 20, .rows = 2, .columns = 2};
  for (int t = 0; t < 5; ++t) scene.Step({a, b});
  for (int t = 0; t < 10; ++t) scene.Step({b});
  EXPECT_FALSE(scene.Find(1)->features().touched);
  EXPECT_EQ(scene.Find(1)->phase, TouchPhase::kInContact);
  scene.Step({a, b});
  EXPECT_EQ(scene.Ids(), Ids({1, 2}));
  EXPECT_TRUE(scene.Find(1)->features().touched);
  // Frames that went missing between two touched ones say nothing.
  scene.Step({a, b}, nullptr, /*missing_before=*/500);
  EXPECT_EQ(scene.Ids(), Ids({1, 2}));
}

TEST(SkinTrackerTest, AContactElsewhereIsANewOneAtOnce) {
  Scene scene;
  for (int t = 0; t < 5; ++t) scene.Step({{.row = 2, .column = 3}});
  scene.Step({{.row = 12, .column = 20}});
  EXPECT_EQ(scene.Ids(), Ids({2, 1}));
  EXPECT_TRUE(scene.Find(2)->onset);
  EXPECT_FALSE(scene.Find(1)->features().touched);
}

// A contact is firm by a strong load, or by one of 0.1 s.
TEST(SkinTrackerTest, AFirmContactIsOverSoonerThanAWeakOne) {
  struct Case {
    float value;
    int frames;
    int frames_to_release;
  };
  for (const Case& c :
       {Case{20, 5, 25}, Case{19, 5, 50}, Case{19, 9, 50}, Case{19, 10, 25}}) {
    Scene scene;
    const Patch patch = {.row = 2, .column = 3, .value = c.value};
    for (int t = 0; t < c.frames; ++t) scene.Step({patch});
    EXPECT_EQ(scene.FramesToRelease(1), c.frames_to_release);
    EXPECT_TRUE(scene.Ids() == Ids({1}));
    scene.Step({});
    EXPECT_TRUE(scene.Ids().empty());
  }
}

// Two firm touches at one place with 0.3 s between them are two contacts. Brief
// weak ones come and go, but a load of 4 thresholds is another contact's.
TEST(SkinTrackerTest, TouchLetGoTouchAgain) {
  struct Case {
    int frames;
    float next;
    uint64_t id;
  };
  for (const Case& c : {Case{100, 3, 2}, Case{5, 3, 1}, Case{5, 4, 2}}) {
    Scene scene;
    Patch patch = {.row = 2, .column = 3, .value = 3};
    for (int t = 0; t < c.frames; ++t) scene.Step({patch});
    for (int t = 0; t < 30; ++t) scene.Step({});
    patch.value = c.next;
    scene.Step({patch});
    EXPECT_EQ(scene.Ids().front(), c.id) << c.frames << ", " << c.next;
  }
}

TEST(SkinTrackerTest, AContactIsOverWhenTheSkinHasDrawnBack) {
  Scene scene;
  Pose pose;
  for (int t = 0; t < 50; ++t) scene.Step({{.row = 2, .column = 3}}, &pose);
  // At 0.1 m/s: 5 mm take five frames; the estimate of the place follows.
  int frames = 0;
  while (scene.Find(1)->phase != TouchPhase::kReleased) {
    pose.position.z() -= 0.001;
    scene.Step({}, &pose);
    ASSERT_LT(++frames, 15);
  }
  EXPECT_GE(frames, 5);
  // An arm that presses on through a loss may only bounce.
  for (int t = 0; t < 50; ++t) scene.Step({{.row = 2, .column = 3}}, &pose);
  for (int t = 0; t < 20; ++t) {
    pose.position.z() += 0.001;
    scene.Step({}, &pose);
  }
  EXPECT_EQ(scene.Find(2)->phase, TouchPhase::kInContact);
}

// The means of light touch take 0.3 s to forget a load of the threshold.
TEST(SkinTrackerTest, WhatIsLeftOfALoadIsNoTouch) {
  Scene scene = Scene::WithLightTouch();
  const Patch patch = {.row = 5, .column = 5, .rows = 3, .columns = 3};
  for (int t = 0; t < 50; ++t) scene.Step({patch});
  EXPECT_EQ(scene.FramesToRelease(1), 25);
  EXPECT_TRUE(scene.tracker().touched());
  for (int t = 0; t < 100; ++t) scene.Step({});
  EXPECT_FALSE(scene.tracker().touched());
  EXPECT_EQ(scene.tracker().contacts_begun(), 1u);
}

TEST(SkinTrackerTest, WhatIsLeftOfALoadHidesNoTouch) {
  for (const Patch& next :
       {Patch{.row = 5, .column = 5, .rows = 3, .columns = 3},
        Patch{.row = 9, .column = 5, .rows = 3, .columns = 3},
        Patch{.row = 12, .column = 20, .rows = 3, .columns = 3}}) {
    Scene scene = Scene::WithLightTouch();
    for (int t = 0; t < 50; ++t) {
      scene.Step({{.row = 5, .column = 5, .rows = 3, .columns = 3}});
    }
    for (int t = 0; t < 25; ++t) scene.Step({});
    scene.Step({next});
    ASSERT_EQ(scene.Ids(), Ids({2})) << next.row;
    EXPECT_TRUE(scene.Find(2)->onset);
  }
}

// A load may fall below the threshold and still be felt.
TEST(SkinTrackerTest, ALightTouchThatIsLeftIsTheContact) {
  for (const float left : {0.2F, 0.5F, 0.9F}) {
    Scene scene = Scene::WithLightTouch();
    Patch patch = {.row = 5, .column = 5, .rows = 3, .columns = 3};
    for (int t = 0; t < 50; ++t) scene.Step({patch});
    patch.value = left;
    for (int t = 0; t < 300; ++t) scene.Step({patch});
    EXPECT_EQ(scene.Ids(), Ids({1})) << left;
    const int frames = scene.FramesToRelease(1);
    EXPECT_GE(frames, 25) << left;
    EXPECT_LE(frames, 51) << left;
  }
}

TEST(SkinTrackerTest, ALightTouchBesideAContactMustLast) {
  Scene scene = Scene::WithLightTouch();
  const Patch strong = {.row = 5, .column = 5, .rows = 3, .columns = 3};
  const Patch light = {
      .row = 12, .column = 20, .rows = 3, .columns = 3, .value = 0.5};
  for (int t = 0; t < 50; ++t) scene.Step({strong});
  int frames = 0;
  while (scene.Find(2) == nullptr) {
    scene.Step({strong, light});
    ASSERT_LT(++frames, 100);
  }
  EXPECT_GE(frames, 50);
  EXPECT_LE(frames, 60);
}

TEST(SkinTrackerTest, TheLargerPartKeepsTheNumber) {
  Scene scene;
  const Patch whole = {.row = 5, .column = 5, .rows = 3, .columns = 12};
  const Patch left = {.row = 5, .column = 5, .rows = 3, .columns = 3};
  const Patch right = {.row = 5, .column = 12, .rows = 3, .columns = 5};
  for (int t = 0; t < 5; ++t) scene.Step({whole});
  for (int t = 0; t < 2; ++t) {
    scene.Step({left, right});
    EXPECT_EQ(scene.Ids(), Ids({1}));
  }
  scene.Step({left, right});
  EXPECT_EQ(scene.Ids(), Ids({1, 2}));
  EXPECT_EQ(scene.Find(1)->features().area_taxels, 15);
  EXPECT_EQ(scene.Find(2)->features().area_taxels, 9);
  EXPECT_EQ(scene.Find(2)->parent, 1u);
  // One again.
  scene.Step({whole});
  EXPECT_EQ(scene.Find(2)->phase, TouchPhase::kReleased);
  EXPECT_EQ(scene.Find(2)->merged_into, 1u);
  scene.Step({whole});
  EXPECT_EQ(scene.Ids(), Ids({1}));
}

TEST(SkinTrackerTest, MergedContactsPauseAndReturn) {
  Scene scene;
  const auto at = [](int column) {
    return Patch{.row = 8, .column = column, .rows = 2, .columns = 2};
  };
  const Patch large = {.row = 6, .column = 14, .rows = 5, .columns = 4};
  for (int column = 2; column < 14; ++column) {
    scene.Step({large, at(column)});
  }
  // It touches the large one, and is in the end within it.
  for (int column = 14; column < 16; ++column) scene.Step({large, at(column)});
  EXPECT_EQ(scene.Find(1)->phase, TouchPhase::kInContact);
  EXPECT_EQ(scene.Find(2)->phase, TouchPhase::kMerged);
  EXPECT_EQ(scene.Find(2)->merged_into, 1u);
  EXPECT_FALSE(scene.Find(2)->features().touched);
  EXPECT_EQ(scene.Find(1)->features().area_taxels, 20);
  // A long time goes by.
  for (int t = 0; t < 200; ++t) scene.Step({large});
  EXPECT_EQ(scene.Find(2)->phase, TouchPhase::kMerged);
  // They part where they met.
  scene.Step({large, at(11)});
  EXPECT_EQ(scene.Find(2)->phase, TouchPhase::kInContact);
  EXPECT_EQ(scene.Find(2)->merged_into, 0u);
  EXPECT_EQ(scene.Find(2)->features().area_taxels, 4);
  EXPECT_EQ(scene.Find(1)->features().area_taxels, 20);
}

TEST(SkinTrackerTest, MergedContactsEndWithTheirHost) {
  Scene scene;
  const Patch large = {.row = 6, .column = 10, .rows = 5, .columns = 6};
  for (int column = 2; column < 12; ++column) {
    scene.Step({large, {.row = 8, .column = column, .rows = 2, .columns = 2}});
  }
  ASSERT_EQ(scene.Find(2)->phase, TouchPhase::kMerged);
  EXPECT_EQ(scene.FramesToRelease(1), 25);
  EXPECT_EQ(scene.Find(2)->phase, TouchPhase::kReleased);
}

TEST(SkinTrackerTest, AContactKeepsItsNumberAcrossTheSeam) {
  Scene scene(/*wrap=*/true);
  for (int t = 0; t < 90; ++t) {
    const Patch other = {.row = 15, .column = 10, .rows = 2, .columns = 2};
    scene.Step({{.row = 4, .column = t % 30, .rows = 2, .columns = 3}, other});
    if (t < 2) continue;
    ASSERT_EQ(scene.Ids(), Ids({1, 2})) << t;
  }
}

TEST(SkinTrackerTest, AFastContactKeepsItsNumber) {
  Scene scene;
  // Slow at first, then three taxels in a frame, more than its own size.
  int column = 2;
  for (int t = 0; column < 27; ++t) {
    scene.Step({{.row = 9, .column = column, .rows = 2, .columns = 2}});
    column += std::min(t / 3, 3);
  }
  EXPECT_EQ(scene.Ids(), Ids({1}));
}

TEST(SkinTrackerTest, OnlySoManyContactsAreFollowed) {
  Scene scene(false, 3);
  std::vector<Patch> patches;
  for (int i = 0; i < 5; ++i) patches.push_back({.row = 10, .column = 6 * i});
  for (int t = 0; t < 10; ++t) scene.Step(patches);
  EXPECT_EQ(scene.Ids().size(), 3u);
  EXPECT_EQ(scene.tracker().regions(), 5);
  EXPECT_EQ(scene.tracker().contacts_begun(), 3u);
}

TEST(SkinTrackerTest, ResetForgetsAllButTheCount) {
  Scene scene;
  for (int t = 0; t < 5; ++t) scene.Step({{.row = 2, .column = 3}});
  scene.tracker().Reset();
  EXPECT_TRUE(scene.Ids().empty());
  scene.Step({{.row = 2, .column = 3}});
  EXPECT_EQ(scene.Ids(), Ids({2}));
}

// Patches that wander, flicker and stay more than kGap taxels apart: each keeps
// its number, by the generator's own knowledge of which is which.
TEST(SkinTrackerTest, WanderingContactsNeverSwapNumbers) {
  Random random(5);
  int contacts = 0;
  for (int run = 0; run < 200; ++run) {
    const bool wrap = run % 2 == 0;
    Scene scene(wrap);
    const int count = 2 + static_cast<int>(random.Index(3));
    std::vector<Patch> patches;
    // Each keeps to its own rows.
    for (int i = 0; i < count; ++i) {
      patches.push_back({.row = 5 * i,
                         .column = static_cast<int>(random.Index(25)),
                         .rows = 1 + static_cast<int>(random.Index(2)),
                         .columns = 2 + static_cast<int>(random.Index(3)),
                         .value = static_cast<float>(random.Uniform(2, 40))});
    }
    std::map<int, uint64_t> id_of;
    std::vector<int> lost(count, 0);
    for (int t = 0; t < 150; ++t) {
      std::vector<Patch> seen;
      for (int i = 0; i < count; ++i) {
        Patch& patch = patches[i];
        const int step = static_cast<int>(random.Index(3)) - 1;
        patch.column += step;
        if (wrap) {
          patch.column = (patch.column + 30) % 30;
        } else {
          patch.column = std::clamp(patch.column, 0, 30 - patch.columns);
        }
        // The first ten frames without a loss; then at most three in a row.
        const bool flicker = t > 10 && lost[i] < 3 && random.Index(6) == 0;
        lost[i] = flicker ? lost[i] + 1 : 0;
        if (!flicker) seen.push_back(patch);
      }
      scene.Step(seen);
      for (const TrackedContact* contact : scene.tracker().contacts()) {
        if (!contact->features().touched) continue;
        const int which =
            static_cast<int>(contact->features().centroid.row) / 5;
        const auto [known, is_new] = id_of.emplace(which, contact->id());
        ASSERT_EQ(known->second, contact->id()) << run << " " << t;
      }
    }
    EXPECT_EQ(id_of.size(), static_cast<size_t>(count)) << run;
    EXPECT_EQ(scene.tracker().contacts_begun(), id_of.size()) << run;
    contacts += count;
  }
  EXPECT_GT(contacts, 500);
}

TEST(SkinTrackerTest, ReusingUnchangedFramesChangesNothing) {
  Random random(9);
  Scene reusing;
  Scene plain(false, 8, /*reuse_unchanged=*/false);
  int reused = 0;
  std::vector<Patch> patches;
  for (int t = 0; t < 20'000; ++t) {
    if (random.Index(60) == 0) {
      patches.clear();
      for (size_t i = random.Index(4); i > 0; --i) {
        patches.push_back({.row = static_cast<int>(random.Index(18)),
                           .column = static_cast<int>(random.Index(26)),
                           .rows = 1 + static_cast<int>(random.Index(2)),
                           .columns = 1 + static_cast<int>(random.Index(4)),
                           .value = static_cast<float>(random.Uniform(1, 40))});
      }
    }
    Pose pose;
    pose.position.z() = 1e-4 * random.Gaussian();
    reusing.Step(patches, &pose);
    plain.Step(patches, &pose);
    reused += reusing.tracker().reused();
    ASSERT_EQ(reusing.Ids(), plain.Ids()) << t;
    for (size_t i = 0; i < plain.tracker().contacts().size(); ++i) {
      const TrackedContact& a = *reusing.tracker().contacts()[i];
      const TrackedContact& b = *plain.tracker().contacts()[i];
      ASSERT_EQ(a.phase, b.phase) << t;
      ASSERT_EQ(a.onset, b.onset) << t;
      ASSERT_EQ(a.merged_into, b.merged_into) << t;
      ASSERT_EQ(a.features().sample().features, b.features().sample().features)
          << t;
      ASSERT_EQ(a.features().touched, b.features().touched) << t;
    }
  }
  EXPECT_GT(reused, 1000);
}

TEST(SkinTrackerTest, AFrameAllocatesNothing) {
  Scene scene;
  const Patch a = {.row = 2, .column = 3, .rows = 2, .columns = 2};
  const Patch b = {.row = 12, .column = 20, .rows = 2, .columns = 2};
  for (int t = 0; t < 10; ++t) scene.Step({a, b});
  std::vector<std::vector<Patch>> frames;
  for (int t = 0; t < 300; ++t) {
    Patch moved = b;
    moved.column += t / 20 % 5;
    frames.push_back(t % 30 < 3 ? std::vector<Patch>{a}
                                : std::vector<Patch>{a, moved});
  }
  const testing::AllocationCounter counter;
  for (const std::vector<Patch>& frame : frames) scene.Step(frame);
  EXPECT_EQ(counter.count(), 0);
  EXPECT_EQ(scene.tracker().contacts_begun(), 2u);
}

}  // namespace
}  // namespace tactus::internal
