#include "client/recording/answer_check.h"

#include "absl/strings/str_cat.h"
#include "core/base/serialize.h"

namespace tactus::internal::client {
namespace {

std::string Bits(v1::Answer answer) {
  if (answer.has_diagnostics()) {
    answer.mutable_diagnostics()->clear_server_compute_ns();
    answer.mutable_diagnostics()->clear_queue_ns();
  }
  answer.clear_superseded();
  return SerializeDeterministic(answer);
}

}  // namespace

void AnswerCheck::ExpectModel(const std::string& sha256) {
  const std::lock_guard lock(mutex_);
  models_[0] = sha256;
}

void AnswerCheck::ReceiveModel(const std::string& sha256) {
  const std::lock_guard lock(mutex_);
  models_[1] = sha256;
}

void AnswerCheck::Add(const v1::Answer& answer, int side) {
  const std::pair key(answer.sequence(), answer.is_final());
  std::string bits = Bits(answer);
  const std::lock_guard lock(mutex_);
  const auto other = waiting_[1 - side].find(key);
  if (other == waiting_[1 - side].end()) {
    waiting_[side].emplace(key, std::move(bits));
    return;
  }
  if (other->second == bits) {
    ++counts_.equal;
  } else {
    if (counts_.different == 0 || key.first < counts_.first_different) {
      counts_.first_different = key.first;
    }
    ++counts_.different;
  }
  waiting_[1 - side].erase(other);
}

AnswerCheck::Counts AnswerCheck::Result() const {
  const std::lock_guard lock(mutex_);
  Counts counts = counts_;
  counts.only_recorded = waiting_[0].size();
  counts.only_received = waiting_[1].size();
  return counts;
}

bool AnswerCheck::SameModel() const {
  const std::lock_guard lock(mutex_);
  return models_[0] == models_[1];
}

std::string AnswerCheck::Text() const {
  const Counts counts = Result();
  std::string text =
      absl::StrCat(counts.equal, " of ",
                   counts.equal + counts.different + counts.only_recorded,
                   " answers equal the recording's");
  if (!SameModel()) absl::StrAppend(&text, "; the model is another one");
  if (counts.different > 0) {
    absl::StrAppend(&text, "; ", counts.different, " differ, from frame ",
                    counts.first_different, " on");
  }
  if (counts.only_recorded > 0) {
    absl::StrAppend(&text, "; ", counts.only_recorded, " did not come");
  }
  if (counts.only_received > 0) {
    absl::StrAppend(&text, "; ", counts.only_received, " were not recorded");
  }
  return text;
}

}  // namespace tactus::internal::client
