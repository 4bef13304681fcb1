#include "client/front/event_queue.h"

#include "core/base/limits.h"
#include "gtest/gtest.h"
#include "tests/support/allocation_counter.h"

namespace tactus::internal::client {
namespace {

Event Numbered(uint64_t contact) {
  Event event;
  event.contact = contact;
  return event;
}

TEST(EventQueueTest, EventsComeInTheirOrder) {
  EventQueue events;
  Event event;
  EXPECT_FALSE(events.Poll(event));
  uint64_t polled = 0;
  uint64_t added = 0;
  // Grows while its ring begins somewhere.
  for (int round = 0; round < 50; ++round) {
    for (int i = 0; i < 7; ++i) events.Add(Numbered(++added));
    for (int i = 0; i < 3; ++i) {
      ASSERT_TRUE(events.Poll(event));
      EXPECT_EQ(event.contact, ++polled);
    }
  }
  while (events.Poll(event)) EXPECT_EQ(event.contact, ++polled);
  EXPECT_EQ(polled, added);
  EXPECT_EQ(events.dropped(), 0u);
}

TEST(EventQueueTest, TheOldestGiveWayToNewOnes) {
  EventQueue events;
  for (uint64_t i = 1; i <= limits::kMaxPolledEvents + 5; ++i) {
    events.Add(Numbered(i));
  }
  EXPECT_EQ(events.dropped(), 5u);
  Event event;
  uint64_t polled = 5;
  while (events.Poll(event)) EXPECT_EQ(event.contact, ++polled);
  EXPECT_EQ(polled, limits::kMaxPolledEvents + 5);
}

TEST(EventQueueTest, KeepsItsMemory) {
  EventQueue events;
  Event event = Numbered(1);
  event.question = "a question whose name is no short string";
  Event next;
  const auto run = [&] {
    for (int i = 0; i < 10; ++i) events.Add(event);
    while (events.Poll(next)) continue;
  };
  for (int i = 0; i < 10; ++i) run();
  const testing::AllocationCounter counter;
  for (int i = 0; i < 10; ++i) run();
  EXPECT_EQ(counter.count(), 0u);
}

}  // namespace
}  // namespace tactus::internal::client
