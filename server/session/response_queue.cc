#include "server/session/response_queue.h"

#include <algorithm>
#include <utility>

#include "core/base/limits.h"

namespace tactus::internal::server {

void ResponseQueue::BeginRequest() { ++request_; }

v1::Answer* ResponseQueue::AddInterim() {
  Supersede();
  return AddAnswer(true);
}

v1::Answer* ResponseQueue::AddKept() { return AddAnswer(false); }

v1::StreamNotice* ResponseQueue::AddNotice() {
  return AddMessage()->mutable_notice();
}

v1::ClassifyContactResponse* ResponseQueue::AddMessage() {
  waiting_.push_back(std::make_unique<Entry>());
  waiting_.back()->request = request_;
  return &waiting_.back()->response;
}

v1::Answer* ResponseQueue::AddAnswer(bool interim) {
  std::unique_ptr<Entry> entry;
  if (spare_.empty()) {
    entry = std::make_unique<Entry>();
  } else {
    entry = std::move(spare_.back());
    spare_.pop_back();
  }
  entry->interim = interim;
  entry->ready_ns = 0;
  entry->request = request_;
  v1::Answer* answer = entry->response.mutable_answer();
  answer->set_superseded(superseded_);
  if (!interim) ++waiting_kept_;
  waiting_.push_back(std::move(entry));
  return answer;
}

void ResponseQueue::Supersede() {
  const auto is_old = [this](const std::unique_ptr<Entry>& entry) {
    return entry->interim && entry->request != request_;
  };
  auto kept = waiting_.begin();
  for (std::unique_ptr<Entry>& entry : waiting_) {
    if (is_old(entry)) {
      ++superseded_;
      Recycle(std::move(entry));
    } else {
      std::swap(*kept++, entry);
    }
  }
  waiting_.erase(kept, waiting_.end());
}

void ResponseQueue::EndRequest(int64_t elapsed_ns, int64_t now_ns) {
  carried_ns_ += elapsed_ns;
  const auto is_new = [this](const std::unique_ptr<Entry>& entry) {
    return entry->request == request_ && entry->response.has_answer();
  };
  const auto count = std::count_if(waiting_.begin(), waiting_.end(), is_new);
  if (count == 0) return;
  for (const std::unique_ptr<Entry>& entry : waiting_) {
    if (!is_new(entry)) continue;
    entry->ready_ns = now_ns;
    v1::Answer* answer = entry->response.mutable_answer();
    if (answer->has_diagnostics()) {
      answer->mutable_diagnostics()->set_server_compute_ns(carried_ns_ / count);
    }
  }
  carried_ns_ = 0;
}

const v1::ClassifyContactResponse* ResponseQueue::StartWrite(int64_t now_ns) {
  if (writing_ != nullptr || waiting_.empty()) return nullptr;
  writing_ = std::move(waiting_.front());
  waiting_.erase(waiting_.begin());
  if (writing_->response.has_answer()) {
    if (!writing_->interim) --waiting_kept_;
    // An answer that no request message ended, such as the final of a
    // half-close, does not wait.
    const int64_t ready_ns =
        writing_->ready_ns == 0 ? now_ns : writing_->ready_ns;
    waited_ns_ = std::max<int64_t>(0, now_ns - ready_ns);
    v1::Answer* answer = writing_->response.mutable_answer();
    if (answer->has_diagnostics()) {
      answer->mutable_diagnostics()->set_queue_ns(waited_ns_);
    }
  }
  return &writing_->response;
}

void ResponseQueue::FinishWrite() { Recycle(std::move(writing_)); }

bool ResponseQueue::full() const {
  return waiting_kept_ >= limits::kMaxQueuedKept;
}

void ResponseQueue::Recycle(std::unique_ptr<Entry> entry) {
  if (entry->response.has_answer()) spare_.push_back(std::move(entry));
}

}  // namespace tactus::internal::server
