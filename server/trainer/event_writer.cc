#include "server/trainer/event_writer.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace tactus::internal::server {
namespace {

constexpr std::chrono::milliseconds kInterval(100);

}  // namespace

Progress EventWriter::progress() {
  return Progress([this](absl::string_view phase, double fraction) {
    Add(phase, fraction);
  });
}

void EventWriter::Add(absl::string_view phase, double fraction) {
  const std::lock_guard lock(mutex_);
  double& done = done_[std::string(phase)];
  done = std::min(1.0, done + fraction);
  const auto now = std::chrono::steady_clock::now();
  if (phase == phase_ && now - sent_ < kInterval && done < 1) return;
  phase_ = std::string(phase);
  sent_ = now;
  v1::JobEvent event;
  event.mutable_progress()->set_phase(phase_);
  event.mutable_progress()->set_fraction(done);
  Write(event);
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
