#include "client/stream/resumable_stream.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/stream/status.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "grpcpp/channel.h"

namespace tactus::internal::client {
namespace {

using std::chrono::milliseconds;

// How often an attempt looks whether it is still wanted.
constexpr milliseconds kLook{100};
// A message waits so long for its answer before the next one is sent: the least
// if no answer may come.
constexpr milliseconds kLeastPause{1};
constexpr milliseconds kLongestPause{100};
// The same for the last frame that was answered on an earlier stream.
constexpr milliseconds kRepeatedPause{2'000};

uint64_t Seed() {
  return std::chrono::steady_clock::now().time_since_epoch().count();
}

// Whether a stream that was lost with `status` may be resumed. OK is an end
// that the robot did not ask for.
bool MayResume(const absl::Status& status) {
  if (status.ok() || MayRetry(status)) return true;
  const std::string reason = ReasonOf(status);
  return reason == "STREAM_IDLE" || reason == "STREAM_LIMIT";
}

}  // namespace

absl::StatusOr<std::unique_ptr<ResumableStream>> ResumableStream::Open(
    std::shared_ptr<grpc::Channel> channel, const v1::StreamConfig& config,
    ContactStream::OnResponse on_response, const ResumeOptions& options) {
  if (options.replay_bytes < limits::kMinReplayBytes ||
      options.replay_bytes > limits::kMaxReplayBytes) {
    return InvalidConfig(
        "replay_bytes", options.replay_bytes,
        absl::StrCat(limits::kMinReplayBytes, " to ", limits::kMaxReplayBytes));
  }
  std::unique_ptr<ResumableStream> stream(new ResumableStream(
      std::move(channel), config, std::move(on_response), options));
  TACTUS_ASSIGN_OR_RETURN(stream->stream_, stream->Connect(options.timeouts));
  const std::lock_guard lock(stream->mutex_);
  stream->started_ = stream->stream_->started();
  stream->config_.set_model(stream->started_.model_version());
  stream->history_.emplace(config, stream->started_, options.replay_bytes);
  stream->thread_ = std::thread([self = stream.get()] { self->Run(); });
  return stream;
}

ResumableStream::ResumableStream(std::shared_ptr<grpc::Channel> channel,
                                 const v1::StreamConfig& config,
                                 ContactStream::OnResponse on_response,
                                 const ResumeOptions& options)
    : channel_(std::move(channel)),
      config_(config),
      on_response_(std::move(on_response)),
      options_(options),
      backoff_(Seed()) {
  end_of_trial_.mutable_end_of_trial();
}

ResumableStream::~ResumableStream() {
  Cancel();
  if (thread_.joinable()) thread_.join();
}

absl::StatusOr<std::unique_ptr<ContactStream>> ResumableStream::Connect(
    const StreamTimeouts& timeouts) {
  return ContactStream::Open(
      channel_, config_, [this](const auto& r) { OnResponse(r); }, timeouts,
      options_.token, [this] { OnEnd(); });
}

void ResumableStream::OnEnd() {
  const std::lock_guard lock(mutex_);
  is_over_ = true;
  changed_.notify_all();
}

void ResumableStream::OnResponse(const v1::ClassifyContactResponse& response) {
  if (!response.has_answer()) {
    on_response_(response);
    return;
  }
  const v1::ClassifyContactResponse* shown = nullptr;
  {
    const std::lock_guard lock(mutex_);
    // A server that breaks the contract may answer before the first frame.
    if (!history_) return;
    shown = history_->Take(response);
    has_progressed_ |= shown != nullptr;
    if (state_ == State::kResuming) changed_.notify_all();
  }
  if (shown == nullptr) return;
  on_response_(*shown);
  if (!shown->answer().is_final()) return;
  const std::lock_guard lock(mutex_);
  final_ = shown->answer();
  final_due_.reset();
  changed_.notify_all();
}

absl::Status ResumableStream::CheckFrames(
    const v1::ClassifyContactRequest& request) const {
  if (!request.has_frames()) {
    return InvalidConfig("request", "not frames",
                         "frames; EndTrial ends a trial");
  }
  const v1::FrameBatch& batch = request.frames();
  if (batch.frame_count() < 1 ||
      batch.frame_count() > limits::kMaxFramesPerMessage) {
    return FrameCountOutOfRange(batch.frame_count(),
                                limits::kMaxFramesPerMessage);
  }
  if (const size_t size = request.ByteSizeLong();
      size > limits::kMaxMessageBytes) {
    return MessageTooLarge(size, limits::kMaxMessageBytes);
  }
  if (batch.first_sequence() <= history_->last_sequence()) {
    return SequenceRegression(batch.first_sequence(),
                              history_->last_sequence());
  }
  return absl::OkStatus();
}

absl::Status ResumableStream::Send(const v1::ClassifyContactRequest& request) {
  Lock lock(mutex_);
  if (state_ == State::kEnded) return EndStatus();
  TACTUS_RETURN_IF_ERROR(CheckFrames(request));
  while (!history_->Add(request.frames())) {
    changed_.wait(lock);
    if (state_ == State::kEnded) return EndStatus();
  }
  if (state_ == State::kConnected && !is_over_) {
    history_->SentAll();
    SendNow(request, lock);
  } else {
    changed_.notify_all();
  }
  return absl::OkStatus();
}

void ResumableStream::SendNow(const v1::ClassifyContactRequest& request,
                              Lock& lock) {
  is_sending_ = true;
  lock.unlock();
  stream_->Send(request).IgnoreError();
  lock.lock();
  is_sending_ = false;
  // The other thread waits until the stream is free.
  if (is_over_ || is_cancelled_) changed_.notify_all();
}

bool ResumableStream::Owes() const {
  return history_->trial_open() || history_->ending();
}

absl::StatusOr<v1::Answer> ResumableStream::EndTrial() {
  Lock lock(mutex_);
  if (state_ == State::kEnded) return EndStatus();
  history_->EndTrial();
  final_.reset();
  end_is_sent_ = false;
  if (state_ == State::kConnected && !is_over_) SendEnd(lock);
  changed_.notify_all();
  changed_.wait(lock, [this] { return final_ || state_ == State::kEnded; });
  if (final_) return *final_;
  return EndStatus();
}

absl::Status ResumableStream::Close() {
  Lock lock(mutex_);
  if (state_ != State::kEnded) {
    is_closing_ = true;
    if (history_->trial_open()) history_->EndTrial();
    changed_.notify_all();
    changed_.wait(lock, [this] { return state_ == State::kEnded; });
  }
  return final_status_;
}

absl::Status ResumableStream::EndStatus() const {
  return final_status_.ok() ? StreamFinished() : final_status_;
}

bool ResumableStream::ended() {
  const std::lock_guard lock(mutex_);
  return state_ == State::kEnded;
}

bool ResumableStream::resuming() {
  const std::lock_guard lock(mutex_);
  return state_ == State::kResuming || (is_over_ && state_ != State::kEnded);
}

ResumableStream::Statistics ResumableStream::statistics() {
  const std::lock_guard lock(mutex_);
  Statistics statistics = statistics_;
  statistics.replayed_frames = history_->replayed_frames();
  return statistics;
}

void ResumableStream::Cancel() {
  const std::lock_guard lock(mutex_);
  is_cancelled_ = true;
  if (stream_ != nullptr) stream_->Cancel();
  changed_.notify_all();
}

void ResumableStream::SendEnd(Lock& lock) {
  end_is_sent_ = true;
  final_due_.reset();
  if (options_.timeouts.final_answer.count() > 0) {
    final_due_ = Clock::now() + options_.timeouts.final_answer;
  }
  SendNow(end_of_trial_, lock);
}

void ResumableStream::Run() {
  Lock lock(mutex_);
  std::optional<absl::Status> verdict;
  while (!verdict) {
    const absl::Status status = AwaitEnd(lock);
    verdict = Verdict(status);
    if (!verdict) verdict = Resume(status, lock);
  }
  final_status_ = *verdict;
  state_ = State::kEnded;
  changed_.notify_all();
}

absl::Status ResumableStream::AwaitEnd(Lock& lock) {
  const auto may_end = [this] {
    return is_over_ || is_cancelled_ || is_closing_;
  };
  absl::Status late;
  while (!may_end()) {
    if (!final_due_) {
      changed_.wait(lock);
    } else if (Clock::now() < *final_due_) {
      changed_.wait_until(lock, *final_due_);
    } else {
      late = NoResponse("end_of_trial", options_.timeouts.final_answer.count());
      stream_->Cancel();
      changed_.wait(lock, may_end);
    }
  }
  final_due_.reset();
  changed_.wait(lock, [this] { return !is_sending_; });
  lock.unlock();
  const absl::Status status = stream_->Close();
  lock.lock();
  stream_.reset();
  return late.ok() ? status : late;
}

std::optional<absl::Status> ResumableStream::Verdict(
    const absl::Status& status) {
  if (is_cancelled_) return WorkCancelled("the stream");
  if (!MayResume(status)) return status;
  if (is_closing_ && !Owes()) return absl::OkStatus();
  if (options_.resume_for.count() > 0) return std::nullopt;
  return status.ok() ? StreamFinished() : status;
}

std::optional<absl::Status> ResumableStream::Resume(absl::Status status,
                                                    Lock& lock) {
  state_ = State::kResuming;
  if (ReasonOf(status) == "STREAM_IDLE") {
    changed_.wait(lock, [this] {
      return history_->has_unsent() || history_->ending() || is_closing_ ||
             is_cancelled_;
    });
  }
  // A stream that is soon lost again, without a new answer, continues the loss
  // before; so does a server that never sends a final.
  if (!history_->ending() && Clock::now() - resumed_at_ > options_.resume_for) {
    has_progressed_ = true;
  }
  for (;;) {
    if (has_progressed_) {
      has_progressed_ = false;
      lost_at_ = Clock::now();
      backoff_.Reset();
    }
    if (auto verdict = Verdict(status)) {
      if (is_cancelled_) return verdict;
      return Annotate(*verdict, "the stream cannot be resumed");
    }
    const auto deadline = lost_at_ + options_.resume_for;
    if (Clock::now() >= deadline) {
      return NotResumed(options_.resume_for.count(), status);
    }
    // The last attempt is made at the deadline.
    const auto attempt = std::min(Clock::now() + backoff_.Next(), deadline);
    changed_.wait_until(lock, attempt, [this] {
      return is_cancelled_ || (is_closing_ && !Owes());
    });
    if (is_cancelled_ || (is_closing_ && !Owes())) continue;
    status = OpenAgain(deadline, lock);
    if (!status.ok()) continue;
    if (CatchUp(lock)) return std::nullopt;
    status = AwaitEnd(lock);
  }
}

absl::Status ResumableStream::OpenAgain(Clock::time_point deadline,
                                        Lock& lock) {
  is_over_ = false;
  end_is_sent_ = false;
  const StreamHistory::Beginning beginning = history_->BeginStream();
  StreamTimeouts timeouts = options_.timeouts;
  const milliseconds left =
      std::max(std::chrono::ceil<milliseconds>(deadline - Clock::now()), kLook);
  if (timeouts.open.count() <= 0) timeouts.open = left;
  timeouts.open = std::min(timeouts.open, left);
  AwaitConnection(Clock::now() + timeouts.open, lock);
  lock.unlock();
  auto stream = Connect(timeouts);
  absl::Status status = stream.status();
  if (status.ok()) status = CheckBundle((*stream)->started());
  // Its reading thread takes the lock.
  if (!status.ok()) stream = status;
  lock.lock();
  if (!status.ok()) return status;
  ++statistics_.resumed;
  if (beginning == StreamHistory::Beginning::kLost) {
    ++statistics_.without_beginning;
  }
  stream_ = std::move(*stream);
  if (is_cancelled_) stream_->Cancel();
  return absl::OkStatus();
}

void ResumableStream::AwaitConnection(Clock::time_point until, Lock& lock) {
  // Else gRPC waits for up to two minutes between its own attempts.
  grpc::experimental::ChannelResetConnectionBackoff(channel_.get());
  bool is_decided = false;
  while (!is_decided && !is_cancelled_ && Clock::now() < until) {
    lock.unlock();
    is_decided =
        channel_->WaitForConnected(std::chrono::system_clock::now() + kLook) ||
        channel_->GetState(false) == GRPC_CHANNEL_TRANSIENT_FAILURE;
    lock.lock();
  }
}

absl::Status ResumableStream::CheckBundle(
    const v1::StreamStarted& started) const {
  if (started.bundle_sha256() == started_.bundle_sha256()) {
    return absl::OkStatus();
  }
  return BundleChanged(started_.model_version(), started.bundle_sha256(),
                       started_.bundle_sha256());
}

bool ResumableStream::CatchUp(Lock& lock) {
  v1::FrameBatch* batch = request_.mutable_frames();
  while (!is_over_ && !is_cancelled_) {
    if (!history_->NextUnsent(batch)) {
      if (history_->ending() && !is_closing_ && !end_is_sent_) {
        SendEnd(lock);
        // The final may have come, and the robot may have gone on.
        continue;
      }
      state_ = State::kConnected;
      resumed_at_ = Clock::now();
      changed_.notify_all();
      return true;
    }
    // Send may wait for room.
    changed_.notify_all();
    SendNow(request_, lock);
    AwaitAnswer(*batch, lock);
  }
  return false;
}

void ResumableStream::AwaitAnswer(const v1::FrameBatch& batch, Lock& lock) {
  const uint64_t last = batch.first_sequence() + batch.frame_count() - 1;
  // Answers that the robot has may supersede each other. Answers with events
  // are never superseded.
  if (last < history_->delivered() ||
      config_.cadence() == v1::RESULT_CADENCE_EVENTS) {
    return;
  }
  milliseconds pause = kLeastPause;
  if (config_.cadence() != v1::RESULT_CADENCE_EVERY_N_FRAMES &&
      config_.cadence() != v1::RESULT_CADENCE_ON_CHANGE) {
    pause = PauseFor(batch);
  }
  changed_.wait_for(lock, pause, [&] {
    return history_->answered() >= last || is_over_ || is_cancelled_;
  });
}

milliseconds ResumableStream::PauseFor(const v1::FrameBatch& batch) const {
  // With the answer to the last frame that the robot has an answer to, it is
  // known how many of the repeated answers were superseded.
  if (batch.first_sequence() <= history_->delivered()) return kRepeatedPause;
  // Half of the time that the frames span, so that the rest catches up with a
  // robot that goes on.
  const double rate =
      config_.has_sample_rate_hz() ? config_.sample_rate_hz() : 100;
  return std::clamp(
      milliseconds(static_cast<int64_t>(500.0 * batch.frame_count() / rate)),
      kLeastPause, kLongestPause);
}

}  // namespace tactus::internal::client
