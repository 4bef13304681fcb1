#include <atomic>
#include <condition_variable>
#include <filesystem>
#include <limits>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "server/contact_log/contact_log.h"
#include "tests/server/contact_log/logged_streams.h"
#include "tests/support/crash_file_system.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal::server {
namespace {

using internal::testing::CrashFileSystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

// With noise, two of them fill a segment of the smallest log.
constexpr int kLargeFrames = 300;

class ContactLogTest : public ::testing::Test {
 protected:
  std::unique_ptr<ContactLog> Open(
      FileSystem& files = PosixFileSystem(),
      const std::function<int64_t()>& free_bytes = [] { return -1; }) {
    auto log = ContactLog::Open({.folder = folder_,
                                 .max_bytes = limits::kMinContactLogBytes,
                                 .chunks = 2000,
                                 .free_bytes = free_bytes},
                                files);
    EXPECT_TRUE(log.ok()) << log.status();
    return log.ok() ? *std::move(log) : nullptr;
  }

  static v1::ListContactsResponse All(const ContactLog& log) {
    v1::ListContactsRequest request;
    request.set_page_size(200);
    const auto response = log.List(request);
    EXPECT_TRUE(response.ok()) << response.status();
    return response.value_or(v1::ListContactsResponse());
  }

  // The newest first.
  static std::vector<std::string> Names(const ContactLog& log) {
    std::vector<std::string> names;
    const v1::ListContactsResponse all = All(log);
    for (const auto& contact : all.contacts()) {
      names.push_back(contact.name());
    }
    return names;
  }

  // All that the list names can be read, and has its frames.
  static void ExpectReadable(const ContactLog& log) {
    for (const std::string& name : Names(log)) {
      const auto stored = log.Read(*ParseContactName(name));
      ASSERT_TRUE(stored.ok()) << stored.status();
      EXPECT_EQ(stored->contacts(0).name(), name);
      EXPECT_TRUE(RecordingOf(*stored).ok());
    }
  }

  static v1::StoredLabels LabelFor(const std::string& contact) {
    v1::StoredLabels labels;
    labels.add_labels()->set_contact(contact);
    labels.mutable_labels(0)->mutable_given()->set_label("label of " + contact);
    return labels;
  }

  ScratchDir scratch_;
  const std::string folder_ = scratch_ / "contacts";
};

TEST_F(ContactLogTest, ListsAndReadsWhatWasRecorded) {
  const auto log = Open();
  EXPECT_EQ(log->totals().contacts, 0u);
  EXPECT_THAT(Names(*log), IsEmpty());
  {
    LoggedStream stream(*log, "arm 1");
    stream.Contact(30);
    stream.Contact(40);
  }
  log->Flush();
  EXPECT_THAT(Names(*log), ElementsAre("contacts/2", "contacts/1"));
  const auto all = All(*log);
  EXPECT_EQ(all.contacts(0).robot(), "arm 1");
  EXPECT_EQ(all.matching(), 2u);
  EXPECT_EQ(all.kept(), 2u);
  EXPECT_EQ(all.left_out(), 0u);
  EXPECT_GT(all.bytes(), 500);
  EXPECT_EQ(all.max_bytes(), limits::kMinContactLogBytes);
  EXPECT_FALSE(all.contacts(0).has_picture());
  ExpectReadable(*log);
  const auto stored = log->Read({1, 0});
  ASSERT_TRUE(stored.ok());
  EXPECT_EQ(RecordingOf(*stored)->frames_size(), 32);
  EXPECT_EQ(stored->stream().config().client_id(), "arm 1");
  for (const ContactName name : {ContactName{3, 0}, {1, 1}, {0, 0}}) {
    EXPECT_EQ(ReasonOf(log->Read(name).status()), "CONTACT_NOT_FOUND");
  }
  v1::ListContactsRequest bad;
  bad.set_page_size(-1);
  EXPECT_EQ(ReasonOf(log->List(bad).status()), "INVALID_CONFIG");
}

TEST_F(ContactLogTest, ListsPicturesIfAsked) {
  const auto log = Open();
  {
    LoggedStream stream(*log);
    stream.Contact(30);
    stream.Contact(40);
  }
  log->Flush();
  v1::ListContactsRequest request;
  request.set_with_pictures(true);
  const auto response = log->List(request);
  ASSERT_TRUE(response.ok());
  ASSERT_EQ(response->contacts_size(), 2);
  for (const v1::LoggedContact& contact : response->contacts()) {
    ASSERT_EQ(contact.picture().loads().size(), 16u * 24);
    for (int i = 0; i < 16 * 24; ++i) {
      const bool is_pressed = i >= 127 && i < 130;
      EXPECT_EQ(contact.picture().loads()[i], is_pressed ? '\xFF' : '\0') << i;
    }
    EXPECT_EQ(contact.picture().most(), 2);
  }
}

TEST_F(ContactLogTest, ARestartKeepsContactsAndLabels) {
  std::string before;
  {
    const auto log = Open();
    {
      LoggedStream stream(*log);
      for (int i = 0; i < 3; ++i) stream.Contact(30);
    }
    log->Flush();
    ASSERT_TRUE(log->AddLabels(LabelFor("contacts/2")).ok());
    ASSERT_TRUE(log->AddLabels(LabelFor("contacts/99")).ok());
    EXPECT_EQ(All(*log).contacts(1).given().label(), "label of contacts/2");
    before = All(*log).SerializeAsString();
  }
  for (int i = 0; i < 2; ++i) {
    const auto log = Open();
    EXPECT_THAT(log->damage(), IsEmpty());
    v1::ListContactsResponse all = All(*log);
    v1::ListContactsResponse expected;
    expected.ParseFromString(before);
    // It ends with a mark.
    all.clear_bytes();
    expected.clear_bytes();
    EXPECT_EQ(all.SerializeAsString(), expected.SerializeAsString());
    EXPECT_EQ(log->Read({2, 0})->contacts(0).given().label(),
              "label of contacts/2");
    ExpectReadable(*log);
  }
  const auto log = Open();
  LoggedStream(*log).Contact(30);
  log->Flush();
  EXPECT_THAT(Names(*log), ElementsAre("contacts/6", "contacts/3", "contacts/2",
                                       "contacts/1"));
}

// What recorders have handed over is written before it closes.
TEST_F(ContactLogTest, ClosingWritesWhatWaits) {
  {
    const auto log = Open();
    LoggedStream stream(*log);
    for (int i = 0; i < 20; ++i) stream.Contact(3);
  }
  EXPECT_THAT(Names(*Open()), SizeIs(20));
}

// A killed process leaves the files as they are.
TEST_F(ContactLogTest, AKillLosesNothingThatWasListed) {
  const std::string running = folder_;
  const std::string killed = scratch_ / "killed";
  {
    const auto log = Open();
    for (int i = 1; i <= 4; ++i) {
      LoggedStream(*log).Contact(30);
      log->Flush();
      ASSERT_TRUE(log->AddLabels(LabelFor(Names(*log)[0])).ok());
      std::filesystem::remove_all(killed);
      std::filesystem::copy(running, killed,
                            std::filesystem::copy_options::recursive);
      const auto copy = ContactLog::Open(
          {.folder = killed, .max_bytes = limits::kMinContactLogBytes});
      ASSERT_TRUE(copy.ok()) << copy.status();
      EXPECT_EQ(Names(**copy), Names(*log));
      EXPECT_EQ((*copy)->totals().contacts, static_cast<size_t>(i));
      ExpectReadable(**copy);
      const v1::ListContactsResponse all = All(**copy);
      for (const auto& contact : all.contacts()) {
        EXPECT_EQ(contact.given().label(), "label of " + contact.name());
      }
    }
  }
}

TEST_F(ContactLogTest, DamageIsReportedAndTheRestRemains) {
  {
    const auto log = Open();
    for (int i = 0; i < 3; ++i) LoggedStream(*log).Contact(30, true);
  }
  std::string bytes;
  std::string segment;
  for (const auto& file : std::filesystem::directory_iterator(folder_)) {
    if (file.file_size() > bytes.size()) {
      segment = file.path();
      bytes = ReadBytes(segment);
    }
  }
  // In the middle of the second of three records.
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  const auto damage = [&] { WriteBytes(segment, bytes); };
  damage();
  {
    const auto log = Open();
    EXPECT_THAT(Names(*log), ElementsAre("contacts/3", "contacts/1"));
    EXPECT_THAT(log->damage(), ::testing::Contains(HasSubstr("record 2")));
    EXPECT_EQ(ReasonOf(log->Read({2, 0}).status()), "CONTACT_NOT_FOUND");
    ExpectReadable(*log);
  }
  // Damage that comes while the log is open.
  const auto log = Open();
  std::string more = ReadBytes(segment);
  more[more.size() / 2 + more.size() / 3] ^= 1;
  WriteBytes(segment, more);
  EXPECT_EQ(ReasonOf(log->Read({3, 0}).status()), "DATA_LOST");
  v1::ListContactsRequest request;
  request.set_with_pictures(true);
  const auto list = log->List(request);
  ASSERT_TRUE(list.ok()) << list.status();
  ASSERT_EQ(list->contacts_size(), 2);
  EXPECT_FALSE(list->contacts(0).has_picture());
  EXPECT_TRUE(list->contacts(1).has_picture());
}

TEST_F(ContactLogTest, IsNeverLargerThanItMayBe) {
  const auto log = Open();
  LoggedStream stream(*log);
  for (int i = 1; i <= 45; ++i) {
    stream.Contact(kLargeFrames, true);
    if (i % 5 != 0) continue;
    log->Flush();
    EXPECT_LE(log->totals().bytes, limits::kMinContactLogBytes);
    EXPECT_EQ(Names(*log)[0], absl::StrCat("contacts/", i));
  }
  EXPECT_EQ(log->totals().left_out, 0u);
  EXPECT_LT(log->totals().contacts, 40u);
  EXPECT_GT(log->totals().contacts, 20u);
  ExpectReadable(*log);
  // The oldest are gone.
  EXPECT_EQ(Names(*log).back(),
            absl::StrCat("contacts/", 46 - log->totals().contacts));
  EXPECT_EQ(ReasonOf(log->Read({1, 0}).status()), "CONTACT_NOT_FOUND");
}

TEST_F(ContactLogTest, AFullDiskDropsTheOldest) {
  CrashFileSystem files;
  const auto log = Open(files);
  LoggedStream stream(*log);
  for (int i = 0; i < 9; ++i) stream.Contact(kLargeFrames, true);
  log->Flush();
  ASSERT_THAT(Names(*log), SizeIs(9));
  files.FailAt(1, StorageFull("disk", "is full"));
  stream.Contact(kLargeFrames, true);
  log->Flush();
  EXPECT_TRUE(files.failed());
  EXPECT_EQ(log->totals().left_out, 0u);
  const auto names = Names(*log);
  EXPECT_EQ(names.front(), "contacts/10");
  EXPECT_LT(names.size(), 10u);
  EXPECT_GE(names.size(), 7u);
  EXPECT_EQ(names.back(), absl::StrCat("contacts/", 11 - names.size()));
  ExpectReadable(*log);
  // Labels, too.
  files.FailAt(1, StorageFull("disk", "is full"));
  ASSERT_TRUE(log->AddLabels(LabelFor("contacts/10")).ok());
  EXPECT_LT(Names(*log).size(), names.size());
  EXPECT_EQ(All(*log).contacts(0).given().label(), "label of contacts/10");
  ExpectReadable(*log);
}

// A disk on which nothing can be written: the list names what can be read.
TEST_F(ContactLogTest, WhatADiskLosesIsNotListed) {
  CrashFileSystem files;
  const auto log = Open(files);
  LoggedStream stream(*log);
  for (int i = 0; i < 9; ++i) stream.Contact(kLargeFrames, true);
  log->Flush();
  files.StopAt(1);
  stream.Contact(kLargeFrames, true);
  log->Flush();
  EXPECT_EQ(log->totals().left_out, 1u);
  ExpectReadable(*log);
  files.Heal();
  for (int i = 0; i < 14; ++i) {
    stream.Contact(kLargeFrames, true);
    log->Flush();
    // Each of the operations of an Append fails once.
    files.FailAt(1 + i % 7, i < 7 ? StorageFull("disk", "is full")
                                  : IoError("disk", "fails"));
    stream.Contact(kLargeFrames, true);
    log->Flush();
    ExpectReadable(*log);
    files.Heal();
  }
  EXPECT_GT(log->totals().contacts, 5u);
}

// An error of another kind is no reason to drop anything.
TEST_F(ContactLogTest, ADiskThatFailsDropsNothing) {
  CrashFileSystem files;
  const auto log = Open(files);
  LoggedStream stream(*log);
  for (int i = 0; i < 9; ++i) stream.Contact(kLargeFrames, true);
  log->Flush();
  uint64_t left_out = 0;
  for (const absl::Status& error :
       {IoError("disk", "fails"), absl::InternalError("without a reason")}) {
    files.FailAt(1, error);
    stream.Contact(kLargeFrames, true);
    log->Flush();
    EXPECT_TRUE(files.failed());
    files.Heal();
    EXPECT_EQ(log->totals().left_out, ++left_out);
    EXPECT_THAT(Names(*log), SizeIs(9));
    ExpectReadable(*log);
  }
  stream.Contact(kLargeFrames, true);
  log->Flush();
  EXPECT_THAT(Names(*log), SizeIs(10));
}

}  // namespace
}  // namespace tactus::internal::server
