#include "tools/stream/monitor_command.h"

#include <chrono>
#include <deque>
#include <optional>
#include <utility>

#include "absl/strings/str_format.h"
#include "client/drivers/clock.h"
#include "core/base/status_macros.h"
#include "tools/common/monitor.h"
#include "tools/common/terminal.h"

namespace tactus::internal::client {
namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kDrawInterval{100};
constexpr size_t kContactsShown = 2;

class MonitorScreen : public LiveObserver {
 public:
  MonitorScreen(SkinDriver* driver, Terminal* terminal)
      : driver_(driver), terminal_(terminal) {
    terminal_->Draw({"waiting for the skin and the server"});
  }

  void set_player(LivePlayer* player) { player_ = player; }

  void OnStarted(const SkinInfo& info,
                 const v1::StreamStarted& started) override {
    monitor_.emplace(info);
    monitor_->Started(started);
  }
  void OnFrame(const SkinFrame& frame, uint64_t sequence) override {
    monitor_->Frame(frame, sequence, Clock::System().NowNs());
  }
  void OnAnswer(const v1::Answer& answer) override {
    monitor_->Answer(answer, Clock::System().NowNs());
  }
  void OnRead() override {
    while (const auto key = terminal_->ReadKey()) {
      if (*key == 'q' || *key == 'Q') player_->Stop();
    }
    if (terminal_->interrupted()) player_->Stop();
    if (SteadyClock::now() < next_draw_) return;
    next_draw_ = SteadyClock::now() + kDrawInterval;
    Draw();
  }

  void AddContact(const LiveContact& contact) {
    std::string line = absl::StrFormat(
        "contact %d  %.2f s  %s  p %.3f  unknown %.3f", contact.id,
        contact.duration_s, player_->class_names()[contact.answer],
        contact.probability, contact.unknown);
    if (contact.decision) {
      absl::StrAppendFormat(&line, "  decided %s after %.0f ms",
                            player_->class_names()[*contact.decision],
                            contact.decision_ms);
    }
    contacts_.push_back(std::move(line));
    if (contacts_.size() > kContactsShown) contacts_.pop_front();
  }
  void SetNews(const std::string& news) { news_ = news; }

 private:
  void Draw() {
    MonitorState state = monitor_->Snapshot(driver_->Statistics());
    state.footer.assign(contacts_.begin(), contacts_.end());
    state.footer.push_back(news_);
    state.footer.push_back("q or Ctrl-C ends");
    const TerminalSize size = terminal_->Size();
    terminal_->Draw(
        RenderMonitor(state, {size.columns, size.rows, terminal_->colour()}));
  }

  SkinDriver* const driver_;
  Terminal* const terminal_;
  LivePlayer* player_ = nullptr;
  std::optional<Monitor> monitor_;
  std::deque<std::string> contacts_;
  std::string news_;
  SteadyClock::time_point next_draw_ = SteadyClock::now();
};

}  // namespace

absl::Status RunMonitor(const std::shared_ptr<grpc::Channel>& channel,
                        SkinDriver& driver, LivePlayer::Options options) {
  TACTUS_ASSIGN_OR_RETURN(const auto terminal, Terminal::Open("--monitor"));
  MonitorScreen screen(&driver, terminal.get());
  options.observer = &screen;
  LivePlayer player(
      channel, &driver, options,
      [&](const LiveContact& contact) { screen.AddContact(contact); },
      [&](const std::string& news) { screen.SetNews(news); });
  screen.set_player(&player);
  return player.Run();
}

}  // namespace tactus::internal::client
