#include "tools/load/load_robot.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace tactus::internal::client {

LoadRobot::LoadRobot(LoadShared* shared, const Options& options,
                     Connect connect)
    : shared_(shared),
      options_(options),
      connect_(std::move(connect)),
      tally_(options.reads_slowly ? &shared->slow_tally : &shared->tally),
      random_(Random::ForStream(options.seed, options.number)) {}

void LoadRobot::Open() {
  // The first streams are of any age, so that they do not all end together.
  next_stream_ = DrawLength(0);
  OpenStream(0);
}

uint64_t LoadRobot::DrawLength(double least) {
  if (options_.stream_messages == 0) {
    return std::numeric_limits<uint64_t>::max();
  }
  const double messages =
      options_.stream_messages * random_.Uniform(least, 1.5);
  return std::max<uint64_t>(1, std::llround(messages));
}

void LoadRobot::OpenStream(uint64_t first_message) {
  stream_ = std::make_unique<LoadStream>(
      shared_, LoadStream::Options{.robot = options_.number,
                                   .first_message = first_message,
                                   .reads_slowly = options_.reads_slowly});
  stream_->Open(connect_());
}

void LoadRobot::Offer(uint64_t message, int64_t due_ns) {
  if (message == next_stream_) {
    stream_->Close(due_ns);
    old_.push_back(std::move(stream_));
    Reap();
    OpenStream(message);
    next_stream_ += DrawLength(0.5);
  }
  stream_->Offer();
}

void LoadRobot::Close(int64_t due_ns) { stream_->Close(due_ns); }

void LoadRobot::Cancel() {
  for (const auto& stream : old_) stream->Cancel();
  stream_->Cancel();
}

bool LoadRobot::processed() const {
  const auto is_processed = [](const std::unique_ptr<LoadStream>& stream) {
    return stream->processed() >= stream->offered();
  };
  return is_processed(stream_) && std::ranges::all_of(old_, is_processed);
}

void LoadRobot::CountAnswers() {
  for (const auto& stream : old_) CountAnswers(*stream);
  CountAnswers(*stream_);
}

void LoadRobot::CountEnds() {
  for (const auto& stream : old_) CountEnd(*stream);
  CountEnd(*stream_);
  ++tally_->robots;
}

void LoadRobot::CountAnswers(const LoadStream& stream) {
  tally_->sent += stream.offered();
  tally_->answered += stream.answered();
  tally_->answers += stream.answers();
}

void LoadRobot::CountEnd(const LoadStream& stream) {
  ++tally_->streams;
  tally_->superseded += stream.superseded();
  tally_->unannounced += stream.unannounced();
  if (!stream.accepted()) {
    ++tally_->refused;
  } else if (!stream.status().ok()) {
    ++tally_->failed;
  }
  if (!stream.status().ok() && tally_->first_error.empty()) {
    tally_->first_error = stream.status().ToString();
  }
}

void LoadRobot::Reap() {
  std::erase_if(old_, [this](const std::unique_ptr<LoadStream>& stream) {
    if (!stream->over()) return false;
    CountAnswers(*stream);
    CountEnd(*stream);
    return true;
  });
}

}  // namespace tactus::internal::client
