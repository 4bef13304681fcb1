#include "tools/stream/live_command.h"

#include <csignal>
#include <cstdio>
#include <string>

#include "absl/strings/str_join.h"
#include "tools/common/class_words.h"
#include "tools/common/json.h"

namespace tactus::internal::client {
namespace {

std::atomic<LivePlayer*> running_player = nullptr;

void StopRunningPlayer(int /*signal*/) {
  if (LivePlayer* player = running_player) player->Stop();
}

void PrintContact(const LiveContact& contact,
                  const std::vector<std::string>& names, bool json) {
  if (json) {
    Json line = {{"contact", contact.id},
                 {"onset_ns", contact.onset_ns},
                 {"duration_s", contact.duration_s},
                 {"answer", names[contact.answer]},
                 {"probability", contact.probability},
                 {"unknown", contact.unknown}};
    if (contact.decision) {
      line["decision"] = names[*contact.decision];
      line["decision_ms"] = contact.decision_ms;
    }
    if (contact.place) {
      const Eigen::Vector3d& p = *contact.place;
      line["place_m"] = {p.x(), p.y(), p.z()};
    }
    std::printf("%s\n", JsonText(line).c_str());
  } else {
    std::printf("contact %llu  %.2f s  %s  p %.3f  unknown %.3f",
                static_cast<unsigned long long>(contact.id), contact.duration_s,
                ClassWords(names[contact.answer]).c_str(), contact.probability,
                contact.unknown);
    if (contact.decision) {
      std::printf("  decided %s after %.0f ms",
                  ClassWords(names[*contact.decision]).c_str(),
                  contact.decision_ms);
    }
    if (contact.place) {
      const Eigen::Vector3d& p = *contact.place;
      std::printf("  at %.3f %.3f %.3f m", p.x(), p.y(), p.z());
    }
    std::printf("\n");
  }
  std::fflush(stdout);
}

void PrintEnd(const LivePlayer& player, bool json) {
  const DriverStatistics& s = player.statistics();
  if (json) {
    const Json line = {
        {"frames", player.frames()},      {"lost", s.lost},
        {"incomplete", s.incomplete},     {"overwritten", s.overwritten},
        {"reconnects", s.reconnects},     {"rate_hz", s.rate_hz},
        {"jitter_ms", s.jitter_ms},       {"longest_age_ms", s.longest_age_ms},
        {"without_pose", s.without_pose}, {"stuck_taxels", s.stuck_taxels}};
    std::printf("%s\n", JsonText(line).c_str());
    return;
  }
  std::printf(
      "frames %llu, lost %llu, overwritten %llu, reconnects %llu\n"
      "rate %.2f Hz, jitter %.2f ms, age at most %.1f ms\n",
      static_cast<unsigned long long>(player.frames()),
      static_cast<unsigned long long>(s.lost),
      static_cast<unsigned long long>(s.overwritten),
      static_cast<unsigned long long>(s.reconnects), s.rate_hz, s.jitter_ms,
      s.longest_age_ms);
  if (s.without_pose > 0) {
    std::printf("without pose %llu\n",
                static_cast<unsigned long long>(s.without_pose));
  }
  if (!s.stuck_taxels.empty()) {
    std::printf("stuck taxels: %s\n",
                absl::StrJoin(s.stuck_taxels, ", ").c_str());
  }
}

}  // namespace

absl::Status RunLive(const std::shared_ptr<grpc::Channel>& channel,
                     SkinDriver& driver, const LivePlayer::Options& options,
                     bool json) {
  const LivePlayer* self = nullptr;
  LivePlayer player(
      channel, &driver, options,
      [&](const LiveContact& contact) {
        PrintContact(contact, self->class_names(), json);
      },
      [](const std::string& news) {
        std::fprintf(stderr, "tactus-stream: %s\n", news.c_str());
      });
  self = &player;
  running_player = &player;
  std::signal(SIGINT, StopRunningPlayer);
  std::signal(SIGTERM, StopRunningPlayer);
  const absl::Status status = player.Run();
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
  running_player = nullptr;
  if (player.frames() > 0) PrintEnd(player, json);
  return status;
}

}  // namespace tactus::internal::client
