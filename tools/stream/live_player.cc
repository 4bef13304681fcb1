#include "tools/stream/live_player.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/stream/answers.h"
#include "client/stream/skin_notice_text.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "tools/common/rate_news.h"

namespace tactus::internal::client {
namespace {

// Frames whose rate is compared with the configured one.
constexpr size_t kRateFrames = 200;

}  // namespace

LivePlayer::LivePlayer(std::shared_ptr<grpc::Channel> channel,
                       SkinDriver* driver, const Options& options,
                       OnContact on_contact, OnNews on_news)
    : channel_(std::move(channel)),
      driver_(driver),
      options_(options),
      on_contact_(std::move(on_contact)),
      on_news_(std::move(on_news)) {}

absl::Status LivePlayer::Run() {
  const absl::Status status = Stream();
  statistics_ = driver_->Statistics();
  const absl::Status finalised = driver_->Finalise();
  return status.ok() ? finalised : status;
}

absl::Status LivePlayer::Stream() {
  TACTUS_ASSIGN_OR_RETURN(const SkinInfo info, driver_->Configure());
  encoder_.emplace(info, FrameEncoder::Options{.sparse = options_.sparse});
  v1::StreamConfig config = MakeConfig(info);
  config.set_model(options_.model);
  config.set_client_id(options_.client_id);
  config.set_with_diagnostics(true);
  places_.emplace(info.layout);
  if (options_.cadence) {
    config.set_cadence(*options_.cadence);
  } else if (options_.observer == nullptr) {
    config.set_cadence(v1::RESULT_CADENCE_ON_CHANGE);
  }
  config.set_never_release(options_.release_after_ms < 0);
  if (options_.release_after_ms > 0) {
    config.set_release_after_ms(options_.release_after_ms);
  }
  if (options_.max_contacts > 0) config.set_max_contacts(options_.max_contacts);
  TACTUS_ASSIGN_OR_RETURN(
      stream_, ResumableStream::Open(channel_, config,
                                     [this](const auto& r) { OnResponse(r); },
                                     {.timeouts = options_.timeouts,
                                      .token = options_.token,
                                      .resume_for = options_.resume_for}));
  const v1::StreamStarted& started = stream_->started();
  if (options_.recorder) options_.recorder->Begin(info, config, started);
  if (options_.check) options_.check->ReceiveModel(started.bundle_sha256());
  class_names_.assign(started.class_names().begin(),
                      started.class_names().end());
  stated_hz_ = info.sample_rate_hz;
  on_news_(absl::StrCat("skin ", info.layout.name, ", ", info.layout.rows,
                        " x ", info.layout.columns, " at ", info.sample_rate_hz,
                        " Hz; ", started.model_version()));
  if (options_.observer != nullptr) {
    options_.observer->OnStarted(info, started);
  }
  const std::string remarks = driver_->Statistics().remarks;
  if (!remarks.empty()) on_news_(remarks);
  TACTUS_RETURN_IF_ERROR(driver_->Activate());
  if (options_.recorder && options_.calibrated) {
    options_.recorder->BeginRaw(options_.calibrated->raw_info(),
                                ToJson(options_.calibrated->in_use()));
  }
  const absl::Status played = Play();
  if (stop_ && stream_->resuming()) stream_->Cancel();
  // An open contact ends here too.
  const absl::Status closed = stream_->Close();
  ReportContacts();
  return played.ok() ? closed : played;
}

absl::Status LivePlayer::Play() {
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  SkinFrame frame;
  while (!stop_) {
    if (options_.seconds > 0 &&
        std::chrono::duration<double>(Clock::now() - begin).count() >=
            options_.seconds) {
      break;
    }
    TACTUS_ASSIGN_OR_RETURN(const ReadResult result, driver_->Read(frame));
    if (result == ReadResult::kEndOfData) break;
    if (result == ReadResult::kFrame) {
      TACTUS_RETURN_IF_ERROR(SendFrame(frame));
    }
    if (result == ReadResult::kEndOfTrial) TACTUS_RETURN_IF_ERROR(EndTrial());
    if (options_.observer != nullptr) options_.observer->OnRead();
    if (result == ReadResult::kNoFrame || frames_ % 64 == 0) ReportNews();
    ReportConnection();
    ReportContacts();
    // Close returns the reason.
    if (stream_->ended()) break;
  }
  return absl::OkStatus();
}

// A contact ends with its trial. Real skins have no trials that end.
absl::Status LivePlayer::EndTrial() {
  if (options_.recorder) options_.recorder->EndTrial();
  in_trial_ = false;
  return stream_->EndTrial().status();
}

absl::Status LivePlayer::SendFrame(const SkinFrame& frame) {
  if (options_.recorder) {
    if (!in_trial_ && options_.labelled != nullptr) {
      options_.recorder->BeginTrial(*options_.labelled);
    } else if (!in_trial_) {
      options_.recorder->BeginTrial(options_.trial);
    }
    in_trial_ = true;
    options_.recorder->Frame(
        frame, options_.calibrated ? &options_.calibrated->raw() : nullptr);
  }
  encoder_->Skip(frame.missing_before);
  encoder_->Add(frame);
  if (options_.observer != nullptr) {
    options_.observer->OnFrame(frame, encoder_->last_sequence());
  }
  ++frames_;
  CheckRate(frame);
  missing_ += frame.missing_before;
  TACTUS_RETURN_IF_ERROR(stream_->Send(encoder_->request()));
  encoder_->Clear();
  return absl::OkStatus();
}

void LivePlayer::CheckRate(const SkinFrame& frame) {
  if (rate_.frames() == kRateFrames) return;
  rate_.Add(frame);
  if (rate_.frames() < kRateFrames || rate_.Check(stated_hz_).ok()) return;
  ReportRate(rate_.hz());
}

void LivePlayer::ReportRate(double measured_hz) {
  if (rate_reported_) return;
  rate_reported_ = true;
  on_news_(RateNews(measured_hz, stated_hz_));
}

void LivePlayer::OnResponse(const v1::ClassifyContactResponse& response) {
  if (response.notice().kind() == v1::StreamNotice::KIND_RATE_DIFFERS) {
    const std::lock_guard lock(mutex_);
    noticed_hz_ = response.notice().measured_rate_hz();
  }
  if (response.notice().kind() == v1::StreamNotice::KIND_SKIN_DIFFERS) {
    on_news_(SkinNoticeText(response.notice()));
  }
  if (!response.has_answer()) return;
  const v1::Answer& answer = response.answer();
  if (options_.observer != nullptr) options_.observer->OnAnswer(answer);
  if (options_.recorder) options_.recorder->Result(answer);
  if (options_.check) options_.check->Receive(answer);
  KeepPlaces(answer);
  const std::lock_guard lock(mutex_);
  for (int i = 0; i < answer.contacts_size(); ++i) {
    const v1::Contact& contact = answer.contacts(i);
    // A final shows those that end with it, or one that has been reported.
    if (answer.is_final() != IsOpen(contact)) continue;
    contacts_.push_back(ContactOf(contact, answer, i));
  }
}

LiveContact LivePlayer::ContactOf(const v1::Contact& contact,
                                  const v1::Answer& answer, int index) {
  LiveContact live;
  live.id = contact.id();
  live.onset_ns = answer.capture_time_ns() - contact.time_since_onset_ns();
  live.duration_s = static_cast<double>(contact.time_since_onset_ns()) / 1e9;
  live.answer = BestClass(contact);
  live.probability = contact.probability(live.answer);
  live.unknown = contact.unknown();
  const auto& scores = answer.diagnostics().contacts(index).log_likelihood();
  live.log_likelihood.assign(scores.begin(), scores.end());
  live.frames_missing = answer.frames_missing();
  if (const auto decided = DecidedClassOf(stream_->started(), contact)) {
    live.decision = decided->class_index;
    live.decision_ms = static_cast<double>(decided->time_since_onset_ns) / 1e6;
  }
  if (const auto place = place_of_.extract(contact.id())) {
    live.place = place.mapped();
  }
  return live;
}

void LivePlayer::KeepPlaces(const v1::Answer& answer) {
  if (!options_.pose_at) return;
  for (const v1::ContactEvent& event : answer.events()) {
    if (event.kind() != v1::ContactEvent::KIND_TOUCHED) continue;
    const auto pose = options_.pose_at(answer.capture_time_ns());
    if (!pose) continue;
    for (const v1::Contact& contact : answer.contacts()) {
      if (contact.id() != event.contact_id()) continue;
      const v1::ContactPatch& patch = contact.patch();
      place_of_[contact.id()] = places_->InWorld(
          {patch.centroid_row(), patch.centroid_column()}, *pose);
    }
  }
}

void LivePlayer::ReportContacts() {
  std::deque<LiveContact> contacts;
  std::optional<double> noticed_hz;
  {
    const std::lock_guard lock(mutex_);
    contacts.swap(contacts_);
    noticed_hz.swap(noticed_hz_);
  }
  if (noticed_hz) ReportRate(*noticed_hz);
  for (const LiveContact& contact : contacts) on_contact_(contact);
}

void LivePlayer::ReportConnection() {
  const bool resuming = stream_->resuming();
  const ResumableStream::Statistics statistics = stream_->statistics();
  if (resuming && !was_resuming_) {
    on_news_("the stream is lost; frames are kept until it goes on");
  } else if (!resuming && was_resuming_ && !stream_->ended()) {
    on_news_(absl::StrCat("the stream goes on; ", statistics.replayed_frames,
                          " frames were sent again so far"));
  }
  was_resuming_ = resuming;
  if (statistics.without_beginning > without_beginning_) {
    on_news_("the contact goes on without its beginning, as a new contact");
  }
  without_beginning_ = statistics.without_beginning;
}

void LivePlayer::ReportNews() {
  const DriverStatistics statistics = driver_->Statistics();
  if (!statistics.connected && was_connected_ && frames_ > 0) {
    on_news_("the skin sends no frames: " + statistics.problem);
  } else if (!statistics.connected && statistics.problem != last_problem_) {
    on_news_(statistics.problem);
  } else if (statistics.connected && !was_connected_) {
    on_news_(
        absl::StrCat("frames come again; ", statistics.lost, " lost so far"));
  }
  was_connected_ = statistics.connected || frames_ == 0;
  last_problem_ = statistics.problem;
  if (statistics.refused != last_refused_ && !statistics.refused.empty()) {
    on_news_("frames are lost: " + statistics.refused);
  }
  last_refused_ = statistics.refused;
  const bool has_poses = statistics.pose_problem.empty();
  if (!has_poses && had_poses_) {
    on_news_("frames are lost without poses: " + statistics.pose_problem);
  } else if (has_poses && !had_poses_) {
    on_news_(absl::StrCat("poses come again; ", statistics.without_pose,
                          " frames lost without poses so far"));
  }
  had_poses_ = has_poses;
  if (statistics.stuck_taxels != stuck_ && !statistics.stuck_taxels.empty()) {
    on_news_(absl::StrCat("stuck taxels, better masked: ",
                          absl::StrJoin(statistics.stuck_taxels, ", ")));
  }
  stuck_ = statistics.stuck_taxels;
}

}  // namespace tactus::internal::client
