// A ContactLog with little room, little time, or many callers at once.
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "server/contact_log/contact_log.h"
#include "tests/server/contact_log/logged_streams.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal::server {
namespace {

class ContactLogLoadTest : public ::testing::Test {
 protected:
  std::unique_ptr<ContactLog> Open(const std::function<int64_t()>& free_bytes,
                                   size_t chunks = 2000) {
    auto log = ContactLog::Open({.folder = scratch_ / "contacts",
                                 .max_bytes = limits::kMinContactLogBytes,
                                 .chunks = chunks,
                                 .free_bytes = free_bytes});
    EXPECT_TRUE(log.ok()) << log.status();
    return log.ok() ? *std::move(log) : nullptr;
  }

  const ScratchDir scratch_;
};

TEST_F(ContactLogLoadTest, RefusesWhatItCannotOpen) {
  EXPECT_EQ(
      ReasonOf(ContactLog::Open({.folder = scratch_ / "small",
                                 .max_bytes = limits::kMinContactLogBytes - 1})
                   .status()),
      "INVALID_CONFIG");
  EXPECT_EQ(
      ReasonOf(ContactLog::Open({.folder = scratch_ / "a/b",
                                 .max_bytes = limits::kMinContactLogBytes})
                   .status()),
      "IO");
  const auto log = Open([] { return -1; });
  EXPECT_EQ(
      ReasonOf(ContactLog::Open({.folder = scratch_ / "contacts",
                                 .max_bytes = limits::kMinContactLogBytes})
                   .status()),
      "IO");
}

// Another program fills the disk.
TEST_F(ContactLogLoadTest, GivesRoomBackWhenTheDiskIsAlmostFull) {
  std::atomic<int> drops = 0;
  // That many times there is too little room.
  const auto log = Open([&]() -> int64_t {
    return drops > 0 && drops-- > 0 ? limits::kContactLogSpareBytes - 1
                                    : limits::kContactLogSpareBytes;
  });
  LoggedStream stream(*log);
  constexpr int kContacts = 9;
  for (int i = 0; i < kContacts; ++i) stream.Contact(300, true);
  log->Flush();
  size_t contacts = log->totals().contacts;
  ASSERT_EQ(contacts, size_t{kContacts});
  int64_t bytes = log->totals().bytes;
  for (int i = 1; i <= 2; ++i) {
    drops = 1;
    stream.Contact(3);
    log->Flush();
    EXPECT_LT(log->totals().bytes, bytes);
    // Two large ones less, and a small one more.
    EXPECT_EQ(log->totals().contacts, contacts - 1);
    contacts = log->totals().contacts;
    bytes = log->totals().bytes;
  }
  EXPECT_GT(contacts, 2u);
  EXPECT_EQ(log->totals().left_out, 0u);
  // If it does not help, all is given; what is recorded then is still kept.
  drops = 1000;
  stream.Contact(3);
  log->Flush();
  EXPECT_EQ(log->totals().contacts, 1u);
  drops = 0;
  stream.Contact(3);
  log->Flush();
  EXPECT_EQ(log->totals().contacts, 2u);
}

TEST_F(ContactLogLoadTest, ARecordThatIsTooLargeIsLeftOut) {
  const auto log = Open([] { return -1; });
  LoggedStream stream(*log);
  stream.Contact(30);
  // Some 1.5 MB of noise; a record has a sixteenth of the log.
  stream.Contact(1300, true);
  stream.Contact(30);
  log->Flush();
  v1::ListContactsRequest request;
  const auto list = log->List(request);
  ASSERT_TRUE(list.ok());
  EXPECT_EQ(list->contacts_size(), 2);
  EXPECT_EQ(list->left_out(), 1u);
  EXPECT_EQ(list->contacts(0).contact_id(), 3u);
}

// The disk takes no bytes for as long as the gate is closed.
TEST_F(ContactLogLoadTest, ASlowDiskLeavesContactsOutAndNeverBlocks) {
  std::mutex mutex;
  std::condition_variable changed;
  bool is_open = true;
  bool waits = false;
  const auto log = Open([&]() -> int64_t {
    std::unique_lock lock(mutex);
    waits = !is_open;
    changed.notify_all();
    changed.wait(lock, [&] { return is_open; });
    return -1;
  });
  {
    std::unique_lock lock(mutex);
    is_open = false;
    changed.wait(lock, [&] { return waits; });
  }
  // The writer took what waited, and that is nothing.
  constexpr uint64_t kRoom = limits::kMaxWaitingRecordings;
  auto first = std::make_unique<LoggedStream>(*log);
  for (uint64_t i = 0; i < kRoom; ++i) first->Contact(1);
  EXPECT_EQ(log->totals().left_out, 0u);
  // One waits in its stream until there is room, or until the next.
  first->Contact(1);
  EXPECT_EQ(log->totals().left_out, 0u);
  first->Contact(1);
  EXPECT_EQ(log->totals().left_out, 1u);
  {
    LoggedStream second(*log);
    second.Contact(1);
    EXPECT_EQ(log->totals().left_out, 1u);
  }
  EXPECT_EQ(log->totals().left_out, 2u);
  {
    const std::lock_guard lock(mutex);
    is_open = true;
  }
  changed.notify_all();
  log->Flush();
  first.reset();
  log->Flush();
  EXPECT_EQ(log->totals().contacts, kRoom + 1);
  EXPECT_EQ(log->totals().left_out, 2u);
}

// Also under ThreadSanitizer.
TEST_F(ContactLogLoadTest, ManyRecordAndListAtOnce) {
  constexpr int kRobots = 4;
  constexpr int kContacts = 30;
  constexpr size_t kFewChunks = 6;
  const auto log = Open([] { return -1; }, kFewChunks);
  std::atomic<bool> done = false;
  std::atomic<uint64_t> read = 0;
  std::vector<std::thread> readers;
  for (int i = 0; i < 2; ++i) {
    readers.emplace_back([&, i] {
      while (!done) {
        v1::ListContactsRequest request;
        request.set_page_size(5);
        request.set_with_pictures(i == 0);
        const auto list = log->List(request);
        ASSERT_TRUE(list.ok()) << list.status();
        v1::StoredLabels labels;
        for (const v1::LoggedContact& contact : list->contacts()) {
          const auto stored = log->Read(*ParseContactName(contact.name()));
          ASSERT_TRUE(stored.ok()) << stored.status();
          ++read;
          v1::StoredLabel& label = *labels.add_labels();
          label.set_contact(contact.name());
          label.mutable_given()->set_label(contact.robot());
        }
        ASSERT_TRUE(log->AddLabels(labels).ok());
        EXPECT_LE(log->totals().contacts, size_t{kRobots * kContacts});
        log->Flush();
      }
    });
  }
  std::vector<std::thread> robots;
  for (int robot = 0; robot < kRobots; ++robot) {
    robots.emplace_back([&, robot] {
      LoggedStream stream(*log, absl::StrCat("robot ", robot));
      for (int i = 0; i < kContacts; ++i) stream.Contact(5, true);
    });
  }
  for (std::thread& robot : robots) robot.join();
  log->Flush();
  while (read == 0 && log->totals().contacts > 0) std::this_thread::yield();
  done = true;
  for (std::thread& reader : readers) reader.join();
  const ContactLog::Totals totals = log->totals();
  EXPECT_EQ(totals.contacts + totals.left_out, uint64_t{kRobots * kContacts});
  EXPECT_GT(totals.contacts, 0u);
  v1::ListContactsRequest labelled;
  labelled.set_labelled(true);
  const auto list = log->List(labelled);
  ASSERT_TRUE(list.ok()) << list.status();
  for (const auto& contact : list->contacts()) {
    EXPECT_EQ(contact.given().label(), contact.robot());
  }
}

}  // namespace
}  // namespace tactus::internal::server
