// tactus-fakeskin: the boards of an iCub's skin, or a XELA patch of three axes,
// on a CAN interface or behind a USB adapter that this program plays, or an
// AnySkin board on a pseudo-terminal, touched by simulated contacts. For
// demonstrations and tests without a robot.
#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>

#include "CLI/CLI.hpp"
#include "client/drivers/can/socket_can.h"
#include "core/base/arguments.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/version.h"
#include "tools/fakeskin/anyskin_board.h"
#include "tools/fakeskin/gs_usb_gadget.h"
#include "tools/fakeskin/magnet_touches.h"
#include "tools/fakeskin/play_peer.h"
#include "tools/fakeskin/pty_line.h"
#include "tools/fakeskin/sim_touches.h"
#include "tools/fakeskin/xela_patch.h"

namespace tactus::internal::client {
namespace {

std::atomic<bool> interrupted = false;

void Interrupt(int /*signal*/) { interrupted = true; }

absl::Status PlayXela(CanBus& bus, Clock& clock) {
  const int64_t begin_ns = clock.NowNs();
  XelaPatch patch([&](int64_t time_ns, std::span<double> counts) {
    PressXela(time_ns - begin_ns, counts);
  });
  std::printf("playing presses on %s\n", bus.name().c_str());
  std::fflush(stdout);
  return PlayPeer(patch, bus, clock, [] { return !interrupted; });
}

constexpr int64_t kLongestSleepNs = 100'000'000;
// The driver follows the untouched skin from a second after a touch on.
constexpr int64_t kAnySkinPauseNs = 4'000'000'000;
constexpr double kNewtonPerMicrotesla = 0.001;

struct Flags {
  std::string skin = "icub";
  std::string interface;
  FunctionFsOptions usb;
  std::string port;
  std::optional<double> rate_hz;
  std::optional<double> newton_per_count;
  double first_after_s = 3;
  SimTouchesOptions touches;
};

// Prints a line for each contact when it begins.
class ContactPrinter {
 public:
  explicit ContactPrinter(SimTouches* touches) : touches_(touches) {}

  void Print(int64_t now_ns) {
    const size_t begun = touches_->Begun(now_ns);
    if (begun == contact_) return;
    contact_ = begun;
    if (contact_ == 0) return;
    std::printf("contact %zu  %s\n", contact_,
                touches_->LabelAt(now_ns).c_str());
    std::fflush(stdout);
  }

 private:
  SimTouches* const touches_;
  size_t contact_ = 0;
};

void PrintPlaying(size_t contacts, const std::string& where) {
  std::printf("playing %zu contacts on %s\n", contacts, where.c_str());
  std::fflush(stdout);
}

absl::Status PlayIcub(const Flags& flags, CanBus& bus, Clock& clock) {
  SimTouchesOptions options = flags.touches;
  options.newton_per_count =
      flags.newton_per_count.value_or(options.newton_per_count);
  SimTouches touches(options);
  touches.MakeAll();
  touches.BeginAt(clock.NowNs() +
                  static_cast<int64_t>(flags.first_after_s * 1e9));
  IcubBoards boards(touches.patch().boards, touches.Source());
  PrintPlaying(flags.touches.contacts, bus.name());
  ContactPrinter printer(&touches);
  return PlayPeer(boards, bus, clock, [&] {
    const int64_t now_ns = clock.NowNs();
    printer.Print(now_ns);
    const auto end_ns = touches.end_ns();
    return !interrupted && !(end_ns && now_ns > *end_ns);
  });
}

absl::Status PlayAnySkin(const Flags& flags, Clock& clock) {
  SimTouchesOptions options = flags.touches;
  options.pause_ns = kAnySkinPauseNs;
  SimTouches touches(options);
  touches.MakeAll();
  AnySkinBoardOptions board_options = {.seed = options.seed,
                                       .begin_ns = clock.NowNs()};
  board_options.rate_hz = flags.rate_hz.value_or(board_options.rate_hz);
  AnySkinBoard board(board_options,
                     MagnetSource(touches, flags.newton_per_count.value_or(
                                               kNewtonPerMicrotesla)));
  PtyLine line(flags.port);
  TACTUS_RETURN_IF_ERROR(line.Open());
  PrintPlaying(options.contacts, line.path());
  ContactPrinter printer(&touches);
  std::string bytes;
  std::string due;
  while (!interrupted) {
    const int64_t now_ns = clock.NowNs();
    // The driver takes the untouched skin when it opens the line.
    if (!line.IsListenedTo()) {
      touches.BeginAt(now_ns + static_cast<int64_t>(flags.first_after_s * 1e9));
    }
    const auto end_ns = touches.end_ns();
    if (end_ns && now_ns > *end_ns) break;
    printer.Print(now_ns);
    // Frames that are late are written together: by the times of its bytes, the
    // driver knows a host that is late from a loss.
    due.clear();
    while (board.Emit(now_ns, bytes)) due += bytes;
    if (!due.empty()) line.Write(due);
    clock.SleepNs(std::clamp<int64_t>(board.NextNs() - clock.NowNs(), 0,
                                      kLongestSleepNs));
  }
  if (line.overruns() > 0) {
    std::printf("frames that the host did not fetch: %llu\n",
                static_cast<unsigned long long>(line.overruns()));
  }
  return absl::OkStatus();
}

absl::Status PlayOnBus(const Flags& flags, Clock& clock) {
  std::unique_ptr<CanBus> bus;
  if (flags.interface.empty()) {
    bus = std::make_unique<GsUsbGadget>(flags.usb);
  } else {
    bus = std::make_unique<SocketCan>(flags.interface);
  }
  const absl::Status status = flags.skin == "xela"
                                  ? PlayXela(*bus, clock)
                                  : PlayIcub(flags, *bus, clock);
  if (const CanCounters counters = bus->counters(); counters.overruns > 0) {
    std::printf("frames that the host did not fetch: %llu\n",
                static_cast<unsigned long long>(counters.overruns));
  }
  return status;
}

absl::Status CheckFlags(const Flags& flags) {
  const bool bus = !flags.interface.empty() || !flags.usb.directory.empty();
  if (flags.skin == "anyskin") {
    if (!bus) return absl::OkStatus();
    return InvalidConfig("--interface or --function-fs",
                         "given with --skin=anyskin",
                         "absent: it is on a pseudo-terminal");
  }
  if (!bus) {
    return InvalidConfig("--interface and --function-fs", "absent",
                         "one of them given");
  }
  if (!flags.port.empty() || flags.rate_hz) {
    return InvalidConfig(flags.port.empty() ? "--rate-hz" : "--port",
                         "given with --skin=" + flags.skin,
                         "absent without --skin=anyskin");
  }
  return absl::OkStatus();
}

int Fail(const absl::Status& status, int code) {
  std::fprintf(stderr, "tactus-fakeskin: %s\n",
               std::string(status.message()).c_str());
  return code;
}

int Main(int argc, char** argv) {
  Flags flags;
  CLI::App app(
      "Plays the boards 1 and 2 of an iCub's skin, or a XELA patch, on a CAN "
      "interface or behind a gs_usb adapter, or an AnySkin board on a "
      "pseudo-terminal, touched by simulated contacts, and prints the class of "
      "each of the iCub's and AnySkin's when it begins.",
      "tactus-fakeskin");
  app.set_version_flag("--version", std::string("tactus-fakeskin ") + kVersion);
  auto* bus_options = app.add_option_group("bus");
  bus_options->add_option("--interface", flags.interface,
                          "CAN interface, such as vcan0");
  auto* function_fs =
      bus_options->add_option("--function-fs", flags.usb.directory,
                              "Plays a gs_usb adapter for a USB host: where "
                              "FunctionFS is mounted");
  bus_options->require_option(0, 1);
  auto* gadget =
      app.add_option("--gadget", flags.usb.gadget,
                     "With --function-fs: the gadget's directory in configfs");
  gadget->needs(function_fs);
  function_fs->needs(gadget);
  app.add_option("--skin", flags.skin,
                 "icub: two boards; xela: a patch of 4 x 4 taxels of three "
                 "axes, pressed for 2 s every 4 s until the program is "
                 "interrupted; anyskin: five magnetometers on a serial line")
      ->check(CLI::IsMember({"icub", "xela", "anyskin"}))
      ->capture_default_str();
  app.add_option("--port", flags.port,
                 "Link to make to the serial line of anyskin, such as "
                 "./anyskin; without it, the line has the path that is "
                 "printed");
  app.add_option("--rate-hz", flags.rate_hz,
                 "Frames per second of anyskin; if absent 100")
      ->check(CLI::Range(limits::kMinSampleRateHz, limits::kMaxSampleRateHz));
  app.add_option("--contacts", flags.touches.contacts, "Contacts to play")
      ->check(CLI::Range(size_t{1}, size_t{10'000}))
      ->capture_default_str();
  app.add_option("--seed", flags.touches.seed,
                 "Seed of the contacts, and of what an anyskin reads untouched")
      ->capture_default_str();
  app.add_option("--first-after", flags.first_after_s,
                 "Seconds before the first contact, in which a driver "
                 "configures the boards; for anyskin from when its line is "
                 "opened")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
  app.add_option("--newton-per-count", flags.newton_per_count,
                 "What one count of a board stands for; if absent 0.01, or "
                 "0.001 for anyskin, whose count is a microtesla")
      ->check(CLI::PositiveNumber);
  if (const absl::Status status = CheckArguments(argc, argv); !status.ok()) {
    return Fail(status, 2);
  }
  CLI11_PARSE(app, argc, argv);
  if (const absl::Status status = CheckFlags(flags); !status.ok()) {
    return Fail(status, 2);
  }
  std::signal(SIGINT, Interrupt);
  std::signal(SIGTERM, Interrupt);
  Clock& clock = Clock::System();
  const absl::Status status = flags.skin == "anyskin"
                                  ? PlayAnySkin(flags, clock)
                                  : PlayOnBus(flags, clock);
  return status.ok() ? 0 : Fail(status, 1);
}

}  // namespace
}  // namespace tactus::internal::client

int main(int argc, char** argv) {
  return tactus::internal::client::Main(argc, argv);
}
