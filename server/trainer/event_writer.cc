#include "server/trainer/event_writer.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace tactus::internal::server {
namespace {

constexpr std::chrono::milliseconds kInterval(100);

}  // namespace

EventWriter::EventWriter(int descriptor, Team* team)
    : descriptor_(descriptor), team_(team) {
  team_->WhileWaiting([this] { CatchUp(); });
}

Progress EventWriter::progress() {
  return Progress([this](absl::string_view phase, double fraction) {
    Add(phase, fraction);
  });
}

void EventWriter::Add(absl::string_view phase, double fraction) {
  {
    const std::lock_guard lock(mutex_);
    const int rank = team_->rank();
    const auto found = done_.find(phase);
    const double before = found == done_.end() ? 0 : found->second[rank];
    SetDone(phase, rank, std::min(1.0, before + fraction));
  }
  Hear();
}

void EventWriter::SetDone(absl::string_view phase, int rank, double done) {
  auto [of_phase, is_new] =
      done_.try_emplace(std::string(phase), std::vector<double>(team_->size()));
  of_phase->second[rank] = done;
  double all = 0;
  for (const double of_rank : of_phase->second) all += of_rank;
  all = std::min(1.0, all);
  const auto now = std::chrono::steady_clock::now();
  // What a rank has done last of a phase is not lost when others go on.
  if (phase != phase_ && !written_) WriteProgress();
  const bool waits = phase == phase_ && now - sent_ < kInterval && all < 1;
  phase_ = std::string(phase);
  fraction_ = all;
  written_ = false;
  if (!waits) WriteProgress();
}

void EventWriter::WriteProgress() {
  written_ = true;
  sent_ = std::chrono::steady_clock::now();
  v1::JobEvent event;
  event.mutable_progress()->set_phase(phase_);
  event.mutable_progress()->set_fraction(fraction_);
  Write(event);
}

void EventWriter::CatchUp() {
  Hear();
  const std::lock_guard lock(mutex_);
  if (!written_) WriteProgress();
}

void EventWriter::Hear() {
  team_->Hear(
      [this](int rank, const std::string& bytes) { Take(rank, bytes); });
}

void EventWriter::Take(int rank, const std::string& bytes) {
  v1::JobEvent event;
  if (!event.ParseFromString(bytes)) return;
  const std::lock_guard lock(mutex_);
  if (event.has_progress()) {
    SetDone(event.progress().phase(), rank, event.progress().fraction());
  } else {
    Write(event);
  }
}

void EventWriter::Send(const LearningPoint& point) {
  v1::JobEvent event;
  v1::LearningPoint& message = *event.mutable_point();
  message.set_phase(point.phase);
  message.set_part(point.part);
  message.set_iteration(static_cast<uint32_t>(point.iteration));
  message.set_max_iterations(static_cast<uint32_t>(point.max_iterations));
  const auto set = [&](const std::optional<double>& value, auto setter) {
    if (value.has_value()) (message.*setter)(*value);
  };
  set(point.log_likelihood, &v1::LearningPoint::set_log_likelihood);
  set(point.loss, &v1::LearningPoint::set_loss);
  set(point.accuracy, &v1::LearningPoint::set_accuracy);
  set(point.validation_loss, &v1::LearningPoint::set_validation_loss);
  set(point.validation_accuracy, &v1::LearningPoint::set_validation_accuracy);
  const std::lock_guard lock(mutex_);
  Write(event);
}

void EventWriter::Write(const v1::JobEvent& event) {
  const std::string body = event.SerializeAsString();
  if (team_->rank() > 0) return team_->Tell(body);
  const auto length = static_cast<uint32_t>(body.size());
  std::string bytes(sizeof length, '\0');
  std::memcpy(bytes.data(), &length, sizeof length);
  bytes += body;
  for (size_t done = 0; done < bytes.size();) {
    const ssize_t written =
        write(descriptor_, bytes.data() + done, bytes.size() - done);
    if (written < 0 && errno != EINTR) return;
    if (written > 0) done += static_cast<size_t>(written);
  }
}

}  // namespace tactus::internal::server
