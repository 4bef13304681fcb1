#include "server/contact_log/contact_log.h"

#include <chrono>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits_contact_log.h"
#include "core/base/status_macros.h"
#include "core/base/thread_priority.h"
#include "core/store/disk_use.h"
#include "server/contact_log/contact_facts.h"
#include "server/contact_log/contact_replay.h"

namespace tactus::internal::server {
namespace {

// How often the writer looks for work: nobody wakes it, because that would
// take a stream's time.
constexpr std::chrono::milliseconds kLook{100};

}  // namespace

absl::StatusOr<std::unique_ptr<ContactLog>> ContactLog::Open(
    const Options& options, FileSystem& files) {
  if (options.max_bytes < limits::kMinContactLogBytes) {
    return InvalidConfig(
        "size of the contact log", options.max_bytes,
        absl::StrCat("at least ", limits::kMinContactLogBytes, " bytes"));
  }
  TACTUS_ASSIGN_OR_RETURN(
      auto ring, RecordRing::Open(options.folder, options.max_bytes, files));
  std::unique_ptr<ContactLog> log(new ContactLog(std::move(ring), options));
  TACTUS_RETURN_IF_ERROR(log->ReadAll());
  log->writer_ = std::thread([log = log.get()] { log->Run(); });
  return log;
}

ContactLog::ContactLog(std::unique_ptr<RecordRing> ring, const Options& options)
    : models_(options.models),
      free_bytes_(
          options.free_bytes
              ? options.free_bytes
              : [folder = options.folder] { return FreeBytes(folder); }),
      pool_(options.chunks),
      damage_(ring->damage()),
      ring_(std::move(ring)) {
  waiting_.reserve(limits::kMaxWaitingRecordings);
}

ContactLog::~ContactLog() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  if (writer_.joinable()) writer_.join();
}

absl::Status ContactLog::ReadAll() {
  return ring_->ForEach(
      [&](uint64_t id, absl::string_view bytes) {
        v1::LogRecord record;
        if (!record.ParseFromArray(bytes.data(),
                                   static_cast<int>(bytes.size()))) {
          damage_.push_back(
              absl::StrCat("record ", id, " of the contact log is no message"));
          return;
        }
        AddToIndex(id, record);
      },
      [&](uint64_t id, const absl::Status& error) {
        damage_.push_back(absl::StrCat("record ", id, ": ", error.message()));
      });
}

void ContactLog::AddToIndex(uint64_t id, const v1::LogRecord& record) {
  const std::lock_guard lock(index_mutex_);
  if (record.has_contacts()) index_.Add(id, record.contacts());
  if (record.has_labels()) index_.AddLabels(record.labels());
}

std::unique_ptr<ContactRecorder> ContactLog::Record(v1::RecordedStream stream) {
  RecordingSink* sink = this;
  return std::make_unique<ContactRecorder>(
      &pool_, sink, std::make_shared<v1::RecordedStream>(std::move(stream)));
}

bool ContactLog::TryTake(FinishedRecording& recording) {
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock || waiting_.size() == waiting_.capacity()) return false;
  waiting_.push_back(recording);
  ++taken_;
  return true;
}

void ContactLog::Take(FinishedRecording& recording) {
  {
    const std::lock_guard lock(mutex_);
    if (waiting_.size() < waiting_.capacity()) {
      waiting_.push_back(recording);
      ++taken_;
      return;
    }
  }
  OnLeftOut();
  recording.GiveBack(pool_);
}

void ContactLog::Flush() {
  std::unique_lock lock(mutex_);
  const uint64_t taken = taken_;
  changed_.wait(lock, [&] { return done_ >= taken; });
}

void ContactLog::Run() {
  SetThreadPriority(ThreadPriority::kBackground);
  std::vector<FinishedRecording> work;
  work.reserve(limits::kMaxWaitingRecordings);
  bool stopping = false;
  while (!stopping) {
    {
      std::unique_lock lock(mutex_);
      changed_.wait_for(lock, kLook, [this] { return stopping_; });
      stopping = stopping_;
      work.swap(waiting_);
    }
    GiveRoomBack();
    size_t waiting = work.size();
    for (FinishedRecording& recording : work) Write(recording, --waiting);
    if (work.empty()) continue;
    {
      const std::lock_guard lock(mutex_);
      done_ += work.size();
    }
    changed_.notify_all();
    work.clear();
  }
}

void ContactLog::AskShadow(v1::StoredContacts& stored, size_t waiting) {
  const auto shadow = models_->Shadow(stored.stream().config().model());
  if (!shadow) return;
  if (waiting > limits::kMaxWaitingForShadow) {
    ++shadow_skipped_;
    return;
  }
  // One that does not fit the robot's skin has no answer.
  if (!AddShadow(*shadow, &stored).ok()) return;
  for (const v1::LoggedContact& contact : stored.contacts()) {
    const bool agrees = contact.shadow().label() == contact.label();
    ++(agrees ? shadow_agrees_ : shadow_differs_);
  }
}

void ContactLog::Write(FinishedRecording& recording, size_t waiting) {
  auto stored = StoreRecording(recording, pool_);
  recording.GiveBack(pool_);
  recording.stream.reset();
  if (!stored.ok()) {
    OnLeftOut();
    return;
  }
  if (models_ != nullptr) AskShadow(*stored, waiting);
  v1::LogRecord record;
  *record.mutable_contacts() = *std::move(stored);
  const std::lock_guard lock(ring_mutex_);
  if (!Append(record).ok()) OnLeftOut();
}

absl::Status ContactLog::Append(const v1::LogRecord& record) {
  const std::string bytes = record.SerializeAsString();
  auto id = ring_->Append(bytes);
  // The disk is full: the oldest go first.
  while (ReasonOf(id.status()) == "STORAGE_FULL") {
    const auto dropped = ring_->DropOldest();
    if (!dropped.ok() || !*dropped) break;
    id = ring_->Append(bytes);
  }
  if (id.ok()) AddToIndex(*id, record);
  // Also after an error: old records may have been removed before it.
  while (true) {
    {
      const std::lock_guard lock(index_mutex_);
      index_.ForgetBefore(ring_->first_id());
      if (index_.size() <= limits::kMaxLoggedContacts) break;
    }
    const auto dropped = ring_->DropOldest();
    if (!dropped.ok() || !*dropped) break;
  }
  return id.status();
}

void ContactLog::GiveRoomBack() {
  const std::lock_guard lock(ring_mutex_);
  while (true) {
    const int64_t free = free_bytes_();
    if (free < 0 || free >= limits::kContactLogSpareBytes) return;
    const auto dropped = ring_->DropOldest();
    if (!dropped.ok() || !*dropped) return;
    const std::lock_guard index_lock(index_mutex_);
    index_.ForgetBefore(ring_->first_id());
  }
}

absl::Status ContactLog::AddLabels(const v1::StoredLabels& labels) {
  v1::LogRecord record;
  *record.mutable_labels() = labels;
  const std::lock_guard lock(ring_mutex_);
  return Append(record);
}

absl::StatusOr<v1::ListContactsResponse> ContactLog::List(
    const v1::ListContactsRequest& request) const {
  v1::ListContactsResponse response;
  {
    const std::lock_guard lock(index_mutex_);
    TACTUS_ASSIGN_OR_RETURN(ContactIndex::Found found, index_.Search(request));
    response.mutable_contacts()->Assign(found.contacts.begin(),
                                        found.contacts.end());
    response.set_next_page_token(found.next_page_token);
    response.set_matching(found.matching);
  }
  const Totals has = totals();
  response.set_kept(static_cast<uint32_t>(has.contacts));
  response.set_left_out(has.left_out);
  response.set_bytes(has.bytes);
  response.set_max_bytes(has.max_bytes);
  if (!request.with_pictures()) return response;
  for (v1::LoggedContact& contact : *response.mutable_contacts()) {
    TACTUS_ASSIGN_OR_RETURN(const ContactName name,
                            ParseContactName(contact.name()));
    auto stored = Read(name);
    // Dropped in the meantime, or damaged: without a picture then.
    if (!stored.ok()) continue;
    contact.mutable_picture()->Swap(
        stored->mutable_contacts(static_cast<int>(name.place))
            ->mutable_picture());
  }
  return response;
}

absl::StatusOr<v1::StoredContacts> ContactLog::Read(
    const ContactName& name) const {
  std::vector<v1::LoggedContact> known;
  {
    const std::lock_guard lock(index_mutex_);
    if (index_.Find(name) == nullptr) return NoSuchContact(name.ToString());
    known = index_.OfRecord(name.record);
  }
  const auto bytes = ring_->Read(name.record);
  if (absl::IsNotFound(bytes.status())) return NoSuchContact(name.ToString());
  TACTUS_RETURN_IF_ERROR(bytes.status());
  v1::LogRecord record;
  if (!record.ParseFromString(*bytes) ||
      record.contacts().contacts_size() != static_cast<int>(known.size())) {
    return DataLost(name.ToString(), "its record is no message");
  }
  v1::StoredContacts stored = std::move(*record.mutable_contacts());
  for (size_t i = 0; i < known.size(); ++i) {
    v1::LoggedContact& contact = *stored.mutable_contacts(static_cast<int>(i));
    known[i].mutable_picture()->Swap(contact.mutable_picture());
    contact.Swap(&known[i]);
  }
  return stored;
}

ContactLog::Totals ContactLog::totals() const {
  Totals totals{.contacts = 0,
                .left_out = left_out_,
                .bytes = ring_->bytes(),
                .max_bytes = ring_->max_bytes(),
                .shadow_agrees = shadow_agrees_,
                .shadow_differs = shadow_differs_,
                .shadow_skipped = shadow_skipped_};
  const std::lock_guard lock(index_mutex_);
  totals.contacts = index_.size();
  return totals;
}

}  // namespace tactus::internal::server
