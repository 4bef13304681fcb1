#include "client/drivers/serial/serial_search.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <set>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "client/drivers/serial/serial_port.h"
#include "core/base/errors.h"

namespace tactus::internal::client {
namespace {

namespace fs = std::filesystem;

// How long one line is waited for before the next one is read.
constexpr int64_t kTurnNs = 5'000'000;
// Frames of which the rate is measured.
constexpr uint64_t kEnoughFrames = 50;

std::vector<fs::path> Entries(const std::string& folder) {
  std::vector<fs::path> entries;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    entries.push_back(entry.path());
  }
  std::sort(entries.begin(), entries.end());
  return entries;
}

// A line while it is listened to.
struct Line {
  Line(const std::string& path, int baud) : port(path, baud) {
    found.path = path;
    if (const absl::Status opened = port.Open(); !opened.ok()) {
      found.problem = std::string(opened.message());
    }
  }

  bool done() const {
    return !found.problem.empty() ||
           (found.shape && found.shape->frames >= kEnoughFrames);
  }

  void Listen(Clock& clock) {
    const auto count = port.Read(buffer, kTurnNs);
    if (!count.ok()) {
      found.problem = std::string(count.status().message());
      return;
    }
    found.bytes += *count;
    for (SerialShapeFinder& finder : finders) {
      finder.Add({buffer.data(), *count}, clock.NowNs());
      if (const auto shape = finder.shape()) found.shape = shape;
    }
  }

  SerialPort port;
  std::array<uint8_t, 4096> buffer;
  std::array<SerialShapeFinder, 2> finders = {
      SerialShapeFinder(SerialFormat::kAscii),
      SerialShapeFinder(SerialFormat::kAa55)};
  SerialFound found;
};

std::string ListText(const std::vector<SerialFound>& lines) {
  return absl::StrJoin(lines, "; ",
                       [](std::string* out, const SerialFound& line) {
                         absl::StrAppend(out, ToText(line));
                       });
}

}  // namespace

std::string ToText(const SerialFound& found) {
  // The errors of lines begin with their names.
  if (!found.problem.empty()) return found.problem;
  if (found.shape) return absl::StrCat(found.path, ": ", ToText(*found.shape));
  if (found.bytes == 0) return absl::StrCat(found.path, ": sends nothing");
  return absl::StrCat(found.path, ": sends ", found.bytes,
                      " bytes without frames");
}

std::vector<std::string> SerialLines(const SerialSearch& search) {
  std::vector<std::string> lines;
  std::set<fs::path> known;
  const auto add = [&](const fs::path& path) {
    std::error_code error;
    const fs::path target = fs::canonical(path, error);
    if (!error && known.insert(target).second) lines.push_back(path);
  };
  for (const fs::path& path : Entries(search.by_id)) add(path);
  for (const fs::path& path : Entries(search.devices)) {
    const std::string name = path.filename();
    if (absl::StartsWith(name, "ttyUSB") || absl::StartsWith(name, "ttyACM")) {
      add(path);
    }
  }
  return lines;
}

std::vector<SerialFound> ListenToSerialLines(const SerialSearch& search,
                                             Clock& clock) {
  std::vector<std::unique_ptr<Line>> lines;
  for (const std::string& path : SerialLines(search)) {
    lines.push_back(std::make_unique<Line>(path, search.baud));
  }
  const int64_t end_ns = clock.NowNs() + search.listen_ns;
  bool waiting = !lines.empty();
  while (waiting && clock.NowNs() < end_ns) {
    waiting = false;
    for (const auto& line : lines) {
      if (line->done()) continue;
      line->Listen(clock);
      waiting = true;
    }
  }
  std::vector<SerialFound> found;
  for (const auto& line : lines) found.push_back(line->found);
  return found;
}

absl::StatusOr<SerialFound> FindSerialSkin(SerialFormat format,
                                           const SerialSearch& search,
                                           Clock& clock) {
  const std::vector<SerialFound> lines = ListenToSerialLines(search, clock);
  std::vector<SerialFound> skins;
  for (const SerialFound& line : lines) {
    if (line.shape && line.shape->format == format) skins.push_back(line);
  }
  if (skins.size() == 1) return skins[0];
  if (lines.empty()) {
    return IoError(
        "--port=auto",
        absl::StrCat("there is no serial line in ", search.by_id,
                     ", and no ttyUSB* or ttyACM* in ", search.devices));
  }
  const std::string name = format == SerialFormat::kAscii ? "ascii" : "aa55";
  if (skins.empty()) {
    return IoError("--port=auto",
                   absl::StrFormat("no skin sends frames in %s at %d baud: %s",
                                   name, search.baud, ListText(lines)));
  }
  return InvalidConfig("--port", "auto", "one of several: " + ListText(skins));
}

}  // namespace tactus::internal::client
