// tactus-fakeskin: the boards of an iCub's skin, or a XELA patch of three axes,
// on a CAN interface or behind a USB adapter that this program plays, touched
// by simulated contacts. For demonstrations and tests without a robot.
#include <atomic>
#include <csignal>
#include <cstdio>
#include <memory>
#include <string>

#include "CLI/CLI.hpp"
#include "client/drivers/can/socket_can.h"
#include "core/base/arguments.h"
#include "core/base/version.h"
#include "tools/fakeskin/gs_usb_gadget.h"
#include "tools/fakeskin/play_peer.h"
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

absl::Status PlayIcub(const SimTouchesOptions& options, double first_after_s,
                      CanBus& bus, Clock& clock) {
  SimTouches touches(options);
  touches.MakeAll();
  touches.BeginAt(clock.NowNs() + static_cast<int64_t>(first_after_s * 1e9));
  IcubBoards boards(touches.patch().boards, touches.Source());
  std::printf("playing %zu contacts on %s\n", options.contacts,
              bus.name().c_str());
  std::fflush(stdout);
  size_t contact = 0;
  return PlayPeer(boards, bus, clock, [&] {
    const int64_t now_ns = clock.NowNs();
    const size_t begun = touches.Begun(now_ns);
    if (begun != contact) {
      contact = begun;
      std::printf("contact %zu  %s\n", contact,
                  touches.LabelAt(now_ns).c_str());
      std::fflush(stdout);
    }
    const auto end_ns = touches.end_ns();
    return !interrupted && !(end_ns && now_ns > *end_ns);
  });
}

int Main(int argc, char** argv) {
  std::string interface;
  FunctionFsOptions usb;
  double first_after_s = 3;
  SimTouchesOptions options;
  CLI::App app(
      "Plays the boards 1 and 2 of an iCub's skin, or a XELA patch, on a CAN "
      "interface or behind a gs_usb adapter, touched by simulated contacts, "
      "and "
      "prints the class of each of the iCub's when it begins.",
      "tactus-fakeskin");
  app.set_version_flag("--version", std::string("tactus-fakeskin ") + kVersion);
  auto* bus_options = app.add_option_group("bus");
  bus_options->add_option("--interface", interface,
                          "CAN interface, such as vcan0");
  auto* function_fs =
      bus_options->add_option("--function-fs", usb.directory,
                              "Plays a gs_usb adapter for a USB host: where "
                              "FunctionFS is mounted");
  bus_options->require_option(1);
  auto* gadget =
      app.add_option("--gadget", usb.gadget,
                     "With --function-fs: the gadget's directory in configfs");
  gadget->needs(function_fs);
  function_fs->needs(gadget);
  std::string skin = "icub";
  app.add_option("--skin", skin,
                 "icub: two boards; xela: a patch of 4 x 4 taxels of three "
                 "axes, pressed for 2 s every 4 s until the program is "
                 "interrupted")
      ->check(CLI::IsMember({"icub", "xela"}))
      ->capture_default_str();
  app.add_option("--contacts", options.contacts, "Contacts to play")
      ->check(CLI::Range(size_t{1}, size_t{10'000}))
      ->capture_default_str();
  app.add_option("--seed", options.seed, "Seed of the contacts")
      ->capture_default_str();
  app.add_option("--first-after", first_after_s,
                 "Seconds before the first contact, in which a driver "
                 "configures the boards")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
  app.add_option("--newton-per-count", options.newton_per_count,
                 "What one count of a board stands for")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  if (const absl::Status status = CheckArguments(argc, argv); !status.ok()) {
    std::fprintf(stderr, "tactus-fakeskin: %s\n",
                 std::string(status.message()).c_str());
    return 2;
  }
  CLI11_PARSE(app, argc, argv);
  std::signal(SIGINT, Interrupt);
  std::signal(SIGTERM, Interrupt);
  Clock& clock = Clock::System();
  std::unique_ptr<CanBus> bus;
  if (interface.empty()) {
    bus = std::make_unique<GsUsbGadget>(usb);
  } else {
    bus = std::make_unique<SocketCan>(interface);
  }
  const absl::Status status =
      skin == "xela" ? PlayXela(*bus, clock)
                     : PlayIcub(options, first_after_s, *bus, clock);
  if (const CanCounters counters = bus->counters(); counters.overruns > 0) {
    std::printf("frames that the host did not fetch: %llu\n",
                static_cast<unsigned long long>(counters.overruns));
  }
  if (status.ok()) return 0;
  std::fprintf(stderr, "tactus-fakeskin: %s\n",
               std::string(status.message()).c_str());
  return 1;
}

}  // namespace
}  // namespace tactus::internal::client

int main(int argc, char** argv) {
  return tactus::internal::client::Main(argc, argv);
}
