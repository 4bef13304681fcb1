// File: serial_search.h
//
// Finds the serial line on which a skin sends.
//
//   TACTUS_ASSIGN_OR_RETURN(const SerialFound found,
//                           FindSerialSkin(SerialFormat::kAscii, {}));
//   SerialSkin skin(found.path, options);
//
// All USB serial lines of the machine are opened and listened to at once.
// Nothing is written to them, and their settings are put back. Opening a line
// resets most Arduinos, which is why listening takes a few seconds; and a
// program that reads one of the lines meanwhile loses bytes.
//
// Thread-safe: free functions without state.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/drivers/clock.h"
#include "client/drivers/serial/serial_shape.h"

namespace tactus::internal::client {

struct SerialSearch {
  // Folders with links that name adapters, and with ttyUSB* and ttyACM*.
  std::string by_id = "/dev/serial/by-id";
  std::string devices = "/dev";
  int baud = 2'000'000;
  int64_t listen_ns = 4'000'000'000;
};

struct SerialFound {
  // The link that names the adapter if there is one, which stays when it is
  // plugged in elsewhere.
  std::string path;
  uint64_t bytes = 0;
  // What a skin sends here.
  std::optional<SerialShape> shape;
  // Magnetometers of a magnetic skin that sends here (magnet_frames.h), 0 if
  // none does, and its rate.
  size_t magnets = 0;
  double magnets_hz = 0;
  // Why the line could not be read.
  std::string problem;
};

// For people: "/dev/ttyUSB0: 12 x 32 taxels at 30.0 Hz in ascii".
std::string ToText(const SerialFound& found);

// The lines of the machine by name, each once.
std::vector<std::string> SerialLines(const SerialSearch& search);

// Listens to all lines, until each of them shows a skin or the time is over.
std::vector<SerialFound> ListenToSerialLines(const SerialSearch& search,
                                             Clock& clock = Clock::System());

// The one line on which a skin sends in this format. IO if there is none, and
// INVALID_CONFIG if there are several; both list what was heard.
absl::StatusOr<SerialFound> FindSerialSkin(SerialFormat format,
                                           const SerialSearch& search,
                                           Clock& clock = Clock::System());

// The same of a magnetic skin of so many magnetometers.
absl::StatusOr<SerialFound> FindMagneticSkin(size_t magnets,
                                             const SerialSearch& search,
                                             Clock& clock = Clock::System());

}  // namespace tactus::internal::client
