#include "server/monitor/watched_stream.h"

#include <atomic>
#include <cstring>
#include <thread>

#include "gtest/gtest.h"
#include "server/monitor/open_streams.h"
#include "server/monitor/stream_watch.h"

namespace tactus::internal::server {
namespace {

constexpr int64_t kMs = 1'000'000;
constexpr int64_t kSecond = 1000 * kMs;

v1::OpenStream Description(const std::string& id, double rate_hz = 60) {
  v1::OpenStream stream;
  stream.set_stream_id(id);
  stream.set_client_id("arm");
  stream.set_sample_rate_hz(rate_hz);
  return stream;
}

// A frame of two taxels, whose answer has so many events.
void Show(WatchedStream& stream, uint64_t sequence, int events = 0) {
  stream.Ask();
  v1::Answer* answer = stream.Want(events > 0);
  if (answer == nullptr) return;
  answer->set_sequence(sequence);
  answer->clear_events();
  for (int e = 0; e < events; ++e) answer->add_events()->set_contact_id(e + 1);
  const std::vector<float> taxels = {static_cast<float>(sequence), 0.5F};
  stream.Take({.taxels = taxels}, *answer);
}

TEST(WatchedStreamTest, WantsFramesOnlyIfSomebodyAsks) {
  WatchedStream stream(Description("1"));
  stream.Ask();
  EXPECT_EQ(stream.Want(false), nullptr);
  EXPECT_EQ(stream.Want(true), nullptr);
  stream.AddWatcher();
  ASSERT_NE(stream.Want(false), nullptr);
  stream.Take({}, *stream.Want(false));
  EXPECT_EQ(stream.Want(false), nullptr);
  EXPECT_NE(stream.Want(true), nullptr);
  stream.Ask();
  EXPECT_NE(stream.Want(false), nullptr);
  stream.RemoveWatcher();
  EXPECT_EQ(stream.Want(true), nullptr);
}

TEST(WatchedStreamTest, TheNewestFrameReplacesWhatWaits) {
  WatchedStream stream(Description("1"));
  stream.AddWatcher();
  WatchedStream::Cursor cursor = stream.Now();
  stream.BeginMessage(5 * kMs);
  for (uint64_t s = 1; s <= 3; ++s) Show(stream, s);
  v1::StreamUpdate update;
  ASSERT_TRUE(stream.ReadNew(7 * kMs, true, &cursor, &update));
  EXPECT_EQ(update.frame().answer().sequence(), 3u);
  EXPECT_EQ(update.frame().age_us(), 2000);
  float taxels[2];
  ASSERT_EQ(update.frame().taxels().size(), sizeof(taxels));
  std::memcpy(taxels, update.frame().taxels().data(), sizeof(taxels));
  EXPECT_EQ(taxels[0], 3);
  EXPECT_EQ(taxels[1], 0.5F);
  update.Clear();
  EXPECT_FALSE(stream.ReadNew(8 * kMs, true, &cursor, &update));
  EXPECT_FALSE(update.has_frame());
}

TEST(WatchedStreamTest, EachWatcherGetsEachEventOnce) {
  WatchedStream stream(Description("1"));
  stream.AddWatcher();
  WatchedStream::Cursor early = stream.Now();
  Show(stream, 1, 2);
  WatchedStream::Cursor late = stream.Now();
  Show(stream, 2, 1);
  v1::StreamUpdate update;
  ASSERT_TRUE(stream.ReadNew(0, false, &early, &update));
  ASSERT_EQ(update.events_size(), 3);
  EXPECT_EQ(update.events(0).sequence(), 1u);
  EXPECT_EQ(update.events(2).sequence(), 2u);
  EXPECT_EQ(update.frame().answer().events_size(), 0);
  EXPECT_EQ(update.frame().taxels(), "");
  update.Clear();
  ASSERT_TRUE(stream.ReadNew(0, false, &late, &update));
  EXPECT_EQ(update.events_size(), 1);
  EXPECT_EQ(update.events_left_out(), 0u);
}

TEST(WatchedStreamTest, SaysHowManyEventsItLeftOut) {
  WatchedStream stream(Description("1"));
  stream.AddWatcher();
  WatchedStream::Cursor cursor = stream.Now();
  for (uint64_t s = 1; s <= 70; ++s) Show(stream, s, 1);
  v1::StreamUpdate update;
  ASSERT_TRUE(stream.ReadNew(0, false, &cursor, &update));
  ASSERT_EQ(update.events_size(), 64);
  EXPECT_EQ(update.events_left_out(), 6u);
  EXPECT_EQ(update.events(0).sequence(), 7u);
  EXPECT_EQ(update.events(63).sequence(), 70u);
}

TEST(WatchedStreamTest, CountsAndMeasuresTheRate) {
  WatchedStream stream(Description("1"));
  for (uint64_t i = 0; i <= 300; ++i) {
    stream.EndMessage({.frames = 1 + i,
                       .frames_missing = 2,
                       .superseded = 3,
                       .contacts = 4,
                       .contacts_now = 1},
                      kSecond + static_cast<int64_t>(i) * 10 * kMs);
  }
  const v1::StreamCounts counts = stream.Describe(5 * kSecond).counts();
  EXPECT_EQ(counts.frames(), 301u);
  EXPECT_EQ(counts.frames_missing(), 2u);
  EXPECT_EQ(counts.superseded(), 3u);
  EXPECT_EQ(counts.contacts(), 4u);
  EXPECT_EQ(counts.contacts_now(), 1u);
  EXPECT_DOUBLE_EQ(counts.measured_rate_hz(), 100);
  EXPECT_EQ(counts.silent_ms(), 1000);
}

// Under ThreadSanitizer this shows that the threads share nothing else.
TEST(WatchedStreamTest, AStreamNeverWaitsForItsWatchers) {
  WatchedStream stream(Description("1"));
  constexpr uint64_t kFrames = 20'000;
  stream.AddWatcher();
  std::atomic<bool> over = false;
  uint64_t events = 0;
  uint64_t left_out = 0;
  std::thread watcher([&] {
    WatchedStream::Cursor cursor;
    uint64_t last = 0;
    for (bool more = true; more;) {
      more = !over;
      v1::StreamUpdate update;
      if (!stream.ReadNew(0, true, &cursor, &update)) continue;
      left_out += update.events_left_out();
      for (const auto& event : update.events()) {
        EXPECT_GT(event.sequence(), last);
        last = event.sequence();
        ++events;
      }
    }
  });
  for (uint64_t s = 1; s <= kFrames; ++s) Show(stream, s, 1);
  // What waits comes with the next frame that finds the lock free.
  const WatchedStream::Cursor before = stream.Now();
  for (uint64_t s = kFrames + 1; stream.Now().frames == before.frames; ++s) {
    Show(stream, s, 1);
  }
  over = true;
  watcher.join();
  EXPECT_GE(events + left_out, kFrames);
}

TEST(OpenStreamsTest, ListsTheOldestFirstAndFindsById) {
  OpenStreams streams;
  const auto first = streams.Add(Description("9"));
  const auto second = streams.Add(Description("10"));
  ASSERT_EQ(streams.List().size(), 2u);
  EXPECT_EQ(streams.List()[0], first);
  EXPECT_LT(first->number(), second->number());
  EXPECT_EQ(streams.Find("10"), second);
  EXPECT_EQ(streams.Find("1"), nullptr);
  streams.Remove(first.get());
  EXPECT_TRUE(first->ended());
  EXPECT_EQ(streams.Find("9"), nullptr);
  EXPECT_EQ(streams.List().size(), 1u);
}

TEST(StreamWatchTest, DescribesThenShowsThenEnds) {
  OpenStreams streams;
  const auto stream = streams.Add(Description("1"));
  StreamWatch watch(stream, {.frames_per_second = 10});
  int64_t now = 100 * kSecond;
  v1::StreamUpdate update;
  ASSERT_TRUE(watch.Update(now, &update));
  EXPECT_EQ(update.stream_id(), "1");
  EXPECT_EQ(update.opened().client_id(), "arm");
  update.Clear();
  EXPECT_FALSE(watch.Update(now, &update));
  Show(*stream, 1, 1);
  ASSERT_TRUE(watch.Update(now, &update));
  EXPECT_FALSE(update.has_opened());
  EXPECT_EQ(update.frame().answer().sequence(), 1u);
  // Not before a tenth of a second has passed.
  Show(*stream, 2, 1);
  update.Clear();
  EXPECT_FALSE(watch.Update(now + 99 * kMs, &update));
  ASSERT_TRUE(watch.Update(now + 101 * kMs, &update));
  EXPECT_EQ(update.frame().answer().sequence(), 2u);
  // Counts alone, after a second.
  update.Clear();
  EXPECT_FALSE(watch.Update(now + kSecond, &update));
  ASSERT_TRUE(watch.Update(now + 2 * kSecond, &update));
  EXPECT_TRUE(update.has_counts());
  EXPECT_FALSE(update.has_frame());
  // The end comes with what was not seen yet.
  Show(*stream, 3, 1);
  streams.Remove(stream.get());
  update.Clear();
  ASSERT_TRUE(watch.Update(now + 2 * kSecond, &update));
  EXPECT_TRUE(update.ended());
  EXPECT_EQ(update.events_size(), 1);
  EXPECT_TRUE(watch.ended());
}

// Between its first frame and the look of whoever watches all streams, a stream
// without limit has had whole contacts.
TEST(StreamWatchTest, AStreamThatIsFollowedIsSeenFromItsFirstFrame) {
  OpenStreams streams;
  streams.AddFollower();
  const auto stream = streams.Add(Description("1"));
  Show(*stream, 1, 2);
  {
    StreamWatch watch(stream, {.from_start = true});
    stream->Found();
    stream->Found();
    Show(*stream, 2, 1);
    v1::StreamUpdate update;
    ASSERT_TRUE(watch.Update(100 * kSecond, &update));
    EXPECT_EQ(update.events_size(), 3);
    EXPECT_EQ(update.frame().answer().sequence(), 2u);
  }
  EXPECT_EQ(stream->Want(true), nullptr);
  streams.RemoveFollower();
  EXPECT_EQ(streams.Add(Description("2"))->Want(true), nullptr);
}

// A watcher that reads just when the last frame comes does not keep its events
// from the others.
TEST(StreamWatchTest, EventsOfTheLastFrameAreSeenThoughTheLockWasHeld) {
  OpenStreams streams;
  const auto stream = streams.Add(Description("1"));
  StreamWatch watch(stream, {});
  std::atomic<bool> stop = false;
  std::thread other([&] {
    while (!stop) stream->Now();
  });
  uint64_t sequence = 0;
  for (int i = 0; i < 20'000; ++i) Show(*stream, ++sequence, 1);
  stop = true;
  other.join();
  streams.Remove(stream.get());
  uint64_t last = 0;
  v1::StreamUpdate update;
  for (int64_t now = kSecond; !watch.ended(); now += kSecond) {
    update.Clear();
    ASSERT_TRUE(watch.Update(now, &update));
    for (const v1::WatchedEvent& event : update.events()) {
      last = event.sequence();
    }
  }
  EXPECT_EQ(last, sequence);
}

TEST(StreamWatchTest, WithoutFramesOnlyCounts) {
  OpenStreams streams;
  const auto stream = streams.Add(Description("1"));
  StreamWatch watch(stream, {.frames_per_second = 0});
  EXPECT_EQ(stream->Want(true), nullptr);
  v1::StreamUpdate update;
  ASSERT_TRUE(watch.Update(100 * kSecond, &update));
  EXPECT_TRUE(update.has_opened());
  EXPECT_FALSE(update.has_frame());
}

}  // namespace
}  // namespace tactus::internal::server
