#include "server/session/response_queue.h"

#include <algorithm>
#include <utility>

#include "core/base/limits.h"

namespace tactus::server {

void ResponseQueue::BeginRequest() { ++request_; }

v1::Posterior* ResponseQueue::AddInterim() {
  Supersede();
  return AddPosterior(true);
}

v1::Posterior* ResponseQueue::AddFinal() { return AddPosterior(false); }

v1::ClassifyContactResponse* ResponseQueue::AddMessage() {
  waiting_.push_back(std::make_unique<Entry>());
  waiting_.back()->request = request_;
  return &waiting_.back()->response;
}

v1::Posterior* ResponseQueue::AddPosterior(bool interim) {
  std::unique_ptr<Entry> entry;
  if (spare_.empty()) {
    entry = std::make_unique<Entry>();
  } else {
    entry = std::move(spare_.back());
    spare_.pop_back();
  }
  entry->interim = interim;
  entry->request = request_;
  v1::Posterior* posterior = entry->response.mutable_posterior();
  posterior->set_superseded(superseded_);
  if (!interim) ++waiting_finals_;
  waiting_.push_back(std::move(entry));
  return posterior;
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
    return entry->request == request_ && entry->response.has_posterior();
  };
  const auto count = std::count_if(waiting_.begin(), waiting_.end(), is_new);
  if (count == 0) return;
  for (const std::unique_ptr<Entry>& entry : waiting_) {
    if (!is_new(entry)) continue;
    entry->ready_ns = now_ns;
    entry->response.mutable_posterior()->set_server_compute_ns(carried_ns_ /
                                                               count);
  }
  carried_ns_ = 0;
}

const v1::ClassifyContactResponse* ResponseQueue::StartWrite(int64_t now_ns) {
  if (writing_ != nullptr || waiting_.empty()) return nullptr;
  writing_ = std::move(waiting_.front());
  waiting_.erase(waiting_.begin());
  if (writing_->response.has_posterior()) {
    if (!writing_->interim) --waiting_finals_;
    writing_->response.mutable_posterior()->set_queue_ns(
        std::max<int64_t>(0, now_ns - writing_->ready_ns));
  }
  return &writing_->response;
}

void ResponseQueue::FinishWrite() { Recycle(std::move(writing_)); }

bool ResponseQueue::full() const {
  return waiting_finals_ >= limits::kMaxQueuedFinals;
}

void ResponseQueue::Recycle(std::unique_ptr<Entry> entry) {
  if (entry->response.has_posterior()) spare_.push_back(std::move(entry));
}

}  // namespace tactus::server
