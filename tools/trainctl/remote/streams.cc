// trainctl streams: what the robots of a server feel.
#include <cstdio>
#include <iostream>
#include <map>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/training/monitor_client.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "tools/common/event_line.h"
#include "tools/trainctl/interrupt.h"
#include "tools/trainctl/remote/flags.h"
#include "tools/trainctl/remote/proto_json.h"
#include "tools/trainctl/text.h"

namespace tactus::internal::client {
namespace {

std::string RobotOf(const v1::OpenStream& stream) {
  return stream.client_id().empty() ? "-" : Printable(stream.client_id());
}

std::string RateText(const v1::OpenStream& stream) {
  const std::string stated = absl::StrFormat("%g Hz", stream.sample_rate_hz());
  const double rate = stream.counts().measured_rate_hz();
  return rate == 0 ? stated : absl::StrFormat("%.1f of %s", rate, stated);
}

absl::Status List(TrainingClient& client, const RemoteFlags& flags) {
  TACTUS_ASSIGN_OR_RETURN(const auto streams,
                          MonitorClient(&client).ListStreams());
  if (flags.json) {
    PrintJson(ArrayToJson(streams));
    return absl::OkStatus();
  }
  for (const v1::OpenStream& stream : streams) {
    const v1::StreamCounts& counts = stream.counts();
    absl::PrintF(
        "%-6s %-20s %s  %s  %s  %s  %d frames, %d lost, %d answers left out, "
        "%d contacts, %d now, silent for %d ms\n",
        Printable(stream.stream_id()), RobotOf(stream),
        TimeText(stream.start_time_ms()),
        Printable(stream.started().model_version()),
        Printable(stream.started().geometry().layout()), RateText(stream),
        counts.frames(), counts.frames_missing(), counts.superseded(),
        counts.contacts(), counts.contacts_now(), counts.silent_ms());
  }
  return absl::OkStatus();
}

// A line for each stream that opens or ends, and for each event.
class UpdatePrinter {
 public:
  void Print(const v1::StreamUpdate& update) {
    const std::string& id = update.stream_id();
    if (update.has_opened()) {
      streams_[id] = update.opened();
      absl::PrintF("%s  open: %s, %s\n", NameOf(id),
                   Printable(update.opened().started().model_version()),
                   RateText(update.opened()));
    }
    for (const v1::WatchedEvent& event : update.events()) PrintEvent(id, event);
    if (update.events_left_out() > 0) {
      absl::PrintF("%s  %d events left out\n", NameOf(id),
                   update.events_left_out());
    }
    if (update.ended()) {
      absl::PrintF("%s  ended after %d frames, %d lost, %d contacts\n",
                   NameOf(id), update.counts().frames(),
                   update.counts().frames_missing(),
                   update.counts().contacts());
      streams_.erase(id);
    }
    std::fflush(stdout);
  }

 private:
  std::string NameOf(const std::string& id) {
    return absl::StrFormat("%-6s %-16s", Printable(id), RobotOf(streams_[id]));
  }

  void PrintEvent(const std::string& id, const v1::WatchedEvent& watched) {
    absl::PrintF(
        "%s  %s\n", NameOf(id),
        EventLine(watched.event(), watched.time_since_onset_ns() / 1'000'000,
                  streams_[id].started(), /*json=*/false));
  }

  std::map<std::string, v1::OpenStream> streams_;
};

absl::Status WatchStreams(TrainingClient& client, const RemoteFlags& flags,
                          const std::string& id) {
  MonitorClient monitor(&client);
  const Interrupt interrupt([&monitor] { monitor.Cancel(); });
  UpdatePrinter printer;
  const auto print = [&](const v1::StreamUpdate& update) {
    if (flags.json) {
      PrintJson(ToJson(update));
      // Whoever reads it wants it now.
      std::cout.flush();
    } else {
      printer.Print(update);
    }
  };
  absl::Status status;
  if (id.empty()) {
    v1::WatchAllRequest request;
    request.set_without_taxels(true);
    status = monitor.WatchAll(request, print);
  } else {
    v1::WatchStreamRequest request;
    request.set_stream_id(id);
    request.set_without_taxels(true);
    status = monitor.WatchStream(request, print);
  }
  // The user has seen enough.
  return absl::IsCancelled(status) ? absl::OkStatus() : status;
}

}  // namespace

void AddStreams(CLI::App& app, const SelectCommand& select) {
  CLI::App& group = CommandGroup(
      app, "streams", "See which robots stream to a server, and what they feel",
      "watch");
  AddRemoteCommand(
      AddVerb(group, "list", "List open streams, the oldest first", "list"),
      select, List);
  CLI::App& watch = AddVerb(
      group, "watch",
      "Print what happens on all streams, or on one until it ends. With "
      "--json, "
      "also frames and their answers, at most 30 a second of each stream. "
      "Ctrl-C ends the watch and nothing else",
      "watch 7");
  auto id = std::make_shared<std::string>();
  watch.add_option("stream", *id, "Its id, as list prints it; default: all");
  AddRemoteCommand(watch, select,
                   [id](TrainingClient& client, const RemoteFlags& flags) {
                     return WatchStreams(client, flags, *id);
                   });
}

}  // namespace tactus::internal::client
