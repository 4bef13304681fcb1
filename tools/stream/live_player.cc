#include "tools/stream/live_player.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "tools/common/rate_news.h"

namespace tactus::client {
namespace {

// Frames whose rate is compared with the configured one.
constexpr size_t kRateFrames = 200;

LiveContact ContactOf(const v1::Posterior& posterior) {
  LiveContact contact;
  contact.id = posterior.contact_id();
  contact.onset_ns =
      posterior.capture_time_ns() - posterior.time_since_onset_ns();
  contact.duration_s =
      static_cast<double>(posterior.time_since_onset_ns()) / 1e9;
  const auto& p = posterior.probability();
  const auto best = std::max_element(p.begin(), p.end());
  if (best != p.end()) {
    contact.answer = static_cast<int>(best - p.begin());
    contact.probability = *best;
  }
  contact.unknown = posterior.unknown();
  contact.log_likelihood.assign(posterior.log_likelihood().begin(),
                                posterior.log_likelihood().end());
  contact.frames_missing = posterior.frames_missing();
  if (posterior.has_decision()) {
    contact.decision = static_cast<int>(posterior.decision().class_index());
    contact.decision_ms =
        static_cast<double>(posterior.decision().time_since_onset_ns()) / 1e6;
  }
  return contact;
}

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
  config.set_with_features(options_.observer != nullptr ||
                           options_.with_features);
  places_.emplace(info.layout);
  if (options_.cadence) {
    config.set_cadence(*options_.cadence);
  } else if (options_.observer == nullptr) {
    config.set_cadence(v1::RESULT_CADENCE_ON_CHANGE);
  }
  config.set_release_after_ms(options_.release_after_ms);
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
  if (!response.has_posterior()) return;
  const v1::Posterior& posterior = response.posterior();
  if (options_.observer != nullptr) options_.observer->OnPosterior(posterior);
  if (options_.recorder) options_.recorder->Result(posterior);
  if (options_.check) options_.check->Receive(posterior);
  const auto place = PlaceOf(posterior);
  const bool open_at_end =
      posterior.is_final() &&
      posterior.contact_state() == v1::CONTACT_STATE_IN_CONTACT;
  if (!posterior.is_contact_end() && !open_at_end) return;
  const std::lock_guard lock(mutex_);
  contacts_.push_back(ContactOf(posterior));
  contacts_.back().place = place;
}

std::optional<Eigen::Vector3d> LivePlayer::PlaceOf(
    const v1::Posterior& posterior) {
  if (!options_.pose_at || posterior.contact_id() == 0) return std::nullopt;
  if (posterior.contact_id() == placed_contact_) return place_;
  placed_contact_ = posterior.contact_id();
  place_.reset();
  const auto pose = options_.pose_at(posterior.capture_time_ns());
  const bool is_felt =
      posterior.contact_state() == v1::CONTACT_STATE_IN_CONTACT &&
      posterior.has_features();
  if (pose && is_felt) {
    const v1::ContactFeatures& features = posterior.features();
    place_ = places_->InWorld(
        {features.centroid_row(), features.centroid_column()}, *pose);
  }
  return place_;
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

}  // namespace tactus::client
