#include "client/drivers/serial/serial_search.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <set>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "client/drivers/anyskin/magnet_frames.h"
#include "client/drivers/serial/serial_port.h"
#include "core/base/errors.h"

namespace tactus::internal::client {
namespace {

namespace fs = std::filesystem;

// How long one line is waited for before the next one is read.
constexpr int64_t kTurnNs = 5'000'000;
// Frames that show a magnetic skin, and frames of which the rate is measured.
constexpr uint64_t kSureFrames = 5;
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

// Counts the frames of a magnetic skin of any number of magnetometers.
class MagnetEar {
 public:
  void Add(std::span<const uint8_t> bytes, int64_t now_ns) {
    ends_.Add(bytes, now_ns);
    const size_t seen = ends_.seen_magnets();
    if (seen > 0 && seen != magnets_) {
      magnets_ = seen;
      frames_.emplace(seen, kAnyPeriodNs);
      count_ = 0;
    }
    if (!frames_) return;
    frames_->Add(bytes, now_ns);
    int64_t time_ns = 0;
    while (frames_->Next(field_ut_, time_ns)) {
      if (count_++ == 0) first_ns_ = now_ns;
      last_ns_ = now_ns;
    }
  }
  uint64_t count() const { return count_; }
  void Tell(SerialFound& found) const {
    if (count_ < kSureFrames) return;
    found.magnets = magnets_;
    if (last_ns_ == first_ns_) return;
    found.magnets_hz = 1e9 * static_cast<double>(count_ - 1) /
                       static_cast<double>(last_ns_ - first_ns_);
  }

 private:
  static constexpr int64_t kAnyPeriodNs = 1'000'000;

  MagnetFrames ends_ = MagnetFrames(1, kAnyPeriodNs);
  // For as many magnetometers as the ends show.
  std::optional<MagnetFrames> frames_;
  size_t magnets_ = 0;
  std::vector<float> field_ut_;
  uint64_t count_ = 0;
  int64_t first_ns_ = 0;
  int64_t last_ns_ = 0;
};

// A line while it is listened to.
struct Line {
  Line(const std::string& path, int baud) : port(path, baud) {
    found.path = path;
    if (const absl::Status opened = port.Open(); !opened.ok()) {
      found.problem = std::string(opened.message());
    }
  }

  bool done() const {
    return !found.problem.empty() || magnets.count() >= kEnoughFrames ||
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
    magnets.Add({buffer.data(), *count}, clock.NowNs());
    magnets.Tell(found);
  }

  SerialPort port;
  std::array<uint8_t, 4096> buffer;
  std::array<SerialShapeFinder, 2> finders = {
      SerialShapeFinder(SerialFormat::kAscii),
      SerialShapeFinder(SerialFormat::kAa55)};
  MagnetEar magnets;
  SerialFound found;
};

std::string ListText(const std::vector<SerialFound>& lines) {
  return absl::StrJoin(lines, "; ",
                       [](std::string* out, const SerialFound& line) {
                         absl::StrAppend(out, ToText(line));
                       });
}

// The one line that `is_it` takes; `what` it sends.
absl::StatusOr<SerialFound> FindOne(
    const std::string& what,
    const std::function<bool(const SerialFound&)>& is_it,
    const SerialSearch& search, Clock& clock) {
  const std::vector<SerialFound> lines = ListenToSerialLines(search, clock);
  std::vector<SerialFound> skins;
  for (const SerialFound& line : lines) {
    if (is_it(line)) skins.push_back(line);
  }
  if (skins.size() == 1) return skins[0];
  if (lines.empty()) {
    return IoError(
        "--port=auto",
        absl::StrCat("there is no serial line in ", search.by_id,
                     ", and no ttyUSB* or ttyACM* in ", search.devices));
  }
  if (skins.empty()) {
    return IoError("--port=auto",
                   absl::StrFormat("no skin sends %s at %d baud: %s", what,
                                   search.baud, ListText(lines)));
  }
  return InvalidConfig("--port", "auto", "one of several: " + ListText(skins));
}

}  // namespace

std::string ToText(const SerialFound& found) {
  // The errors of lines begin with their names.
  if (!found.problem.empty()) return found.problem;
  if (found.magnets > 0) {
    return absl::StrFormat("%s: %d magnetometers at %.1f Hz", found.path,
                           found.magnets, found.magnets_hz);
  }
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
  return FindOne(
      format == SerialFormat::kAscii ? "frames in ascii" : "frames in aa55",
      [&](const SerialFound& line) {
        return line.shape && line.shape->format == format;
      },
      search, clock);
}

absl::StatusOr<SerialFound> FindMagneticSkin(size_t magnets,
                                             const SerialSearch& search,
                                             Clock& clock) {
  return FindOne(
      absl::StrCat("frames of ", magnets, " magnetometers"),
      [&](const SerialFound& line) { return line.magnets == magnets; }, search,
      clock);
}

}  // namespace tactus::internal::client
