#include "tools/console/live_feed.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <thread>
#include <utility>

#include "client/training/monitor_client.h"
#include "client/training/training_client.h"

namespace tactus::internal::console {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kFirstPause(500);
constexpr std::chrono::milliseconds kLongestPause(5'000);
constexpr char kRefused[] = "refused";

// True if another try cannot help: the server does not want this person.
bool SaysNo(const absl::Status& status) {
  return status.code() == absl::StatusCode::kUnauthenticated ||
         status.code() == absl::StatusCode::kPermissionDenied;
}

}  // namespace

// Watches one server.
class LiveFeed::Watch {
 public:
  Watch(const ServerAddress& server, const std::string& token, LiveFeed* feed)
      : address_(server.address),
        may_ask_(MayTakeToken(server, token)),
        client_(client::MakeTrainingChannel(server.address, server.channel),
                {.token = token}),
        monitor_(&client_),
        feed_(feed),
        thread_([this] { Run(); }) {}

  ~Watch() {
    {
      const std::lock_guard lock(mutex_);
      stopping_ = true;
    }
    stop_.notify_all();
    monitor_.Cancel();
    thread_.join();
  }

  bool HasNews(const RobotNews::Cursor& cursor) const {
    const std::lock_guard lock(mutex_);
    return news_.HasNews(cursor);
  }
  bool IsRefused() const {
    const std::lock_guard lock(mutex_);
    return state_ == kRefused;
  }
  uint64_t states() const {
    const std::lock_guard lock(mutex_);
    return states_;
  }
  ServerNews Read(RobotNews::Cursor& cursor) const {
    const std::lock_guard lock(mutex_);
    return {.address = address_,
            .state = state_,
            .error = error_,
            .news = news_.Read(cursor)};
  }

 private:
  void Run() {
    if (!may_ask_.ok()) {
      {
        const std::lock_guard lock(mutex_);
        SetState(kRefused, std::string(may_ask_.message()));
      }
      feed_->OnNews();
      return;
    }
    std::chrono::milliseconds pause = kFirstPause;
    while (true) {
      const absl::Status status = monitor_.WatchAll(
          v1::WatchAllRequest(),
          [&](const v1::StreamUpdate& update) { Take(update); },
          [&] {
            pause = kFirstPause;
            OnResponse();
          });
      std::unique_lock lock(mutex_);
      if (stopping_) return;
      news_.Clear();
      SetState(SaysNo(status) ? kRefused : "connecting",
               std::string(status.message()));
      lock.unlock();
      feed_->OnNews();
      lock.lock();
      if (stop_.wait_for(lock, pause, [&] { return stopping_; })) return;
      pause = std::min(2 * pause, kLongestPause);
    }
  }

  void Take(const v1::StreamUpdate& update) {
    const std::lock_guard lock(mutex_);
    news_.Add(update, Clock::now());
  }

  void OnResponse() {
    {
      const std::lock_guard lock(mutex_);
      SetState("connected", "");
    }
    feed_->OnNews();
  }

  // Under the lock.
  void SetState(const char* state, std::string error) {
    if (state_ == state && error_ == error) return;
    state_ = state;
    error_ = std::move(error);
    ++states_;
  }

  const std::string address_;
  const absl::Status may_ask_;
  client::TrainingClient client_;
  client::MonitorClient monitor_;
  LiveFeed* const feed_;

  mutable std::mutex mutex_;
  std::condition_variable stop_;
  bool stopping_ = false;
  std::string state_ = "connecting";
  std::string error_;
  // How often the state changed.
  uint64_t states_ = 0;
  RobotNews news_;
  std::thread thread_;
};

LiveFeed::LiveFeed(const std::vector<ServerAddress>& servers,
                   const std::string& token) {
  for (const ServerAddress& server : servers) {
    watches_.push_back(std::make_unique<Watch>(server, token, this));
  }
}

LiveFeed::~LiveFeed() = default;

int LiveFeed::Subscribe(std::function<void()> on_news) {
  const std::lock_guard lock(mutex_);
  subscribers_.emplace(next_id_, std::move(on_news));
  return next_id_++;
}

void LiveFeed::Unsubscribe(int id) {
  const std::lock_guard lock(mutex_);
  subscribers_.erase(id);
}

void LiveFeed::OnNews() {
  const std::lock_guard lock(mutex_);
  for (const auto& [id, on_news] : subscribers_) on_news();
}

bool LiveFeed::IsRefused() const {
  return std::ranges::all_of(
      watches_, [](const auto& watch) { return watch->IsRefused(); });
}

bool LiveFeed::HasNews(const Cursor& cursor) const {
  uint64_t states = 0;
  for (size_t i = 0; i < watches_.size(); ++i) {
    states += watches_[i]->states();
    const bool known = i < cursor.servers.size();
    if (watches_[i]->HasNews(known ? cursor.servers[i] : RobotNews::Cursor())) {
      return true;
    }
  }
  return states != cursor.states;
}

std::vector<ServerNews> LiveFeed::Read(Cursor& cursor) const {
  cursor.servers.resize(watches_.size());
  cursor.states = 0;
  std::vector<ServerNews> news;
  for (size_t i = 0; i < watches_.size(); ++i) {
    cursor.states += watches_[i]->states();
    news.push_back(watches_[i]->Read(cursor.servers[i]));
  }
  return news;
}

}  // namespace tactus::internal::console
