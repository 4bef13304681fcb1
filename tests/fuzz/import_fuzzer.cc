// Damages recordings of a skin: its skin.json, the table of trials, or the
// frames as .npy, .npz or CSV. What is imported must be valid trials.
#include "core/files/npy_write.h"
#include "core/files/npz.h"
#include "core/import/import_skin_folder.h"
#include "tests/fuzz/damaged.h"

namespace {

using namespace tactus::internal;

std::vector<std::string> Skins() {
  return {
      R"({"name": "mine", "rows": 2, "columns": 2, "row_pitch_m": 0.01,
          "column_pitch_m": 0.01, "unit": "counts",
          "thresholds": "from idle frames", "idle_frames": 4,
          "sample_rate_hz": 50})",
      R"({"name": "mine", "rows": 2, "columns": 2, "row_pitch_m": 0.01,
          "column_pitch_m": 0.01, "unit": "newton", "scale": 0.5,
          "baseline": "from idle frames", "idle_frames": 3,
          "negative_values": "zero", "contact_threshold": 0.5,
          "onset_threshold": 1.5, "sample_rate_hz": 50,
          "fields": {"label": "{label}"}})",
      R"({"name": "mine", "rows": 2, "columns": 2, "row_pitch_m": 0.01,
          "column_pitch_m": 0.01, "unit": "counts", "contact_threshold": 0.5,
          "onset_threshold": 1, "events": "count", "time_scale_s": 0.01,
          "sample_rate_hz": 50})"};
}

// Frames of four taxels; or events: time, row, column, value.
std::string FramesText() {
  std::string text;
  for (int f = 0; f < 12; ++f) {
    text += f < 6 ? "1,0,1,0\n" : "9,1,1,20\n";
  }
  return text;
}

const std::vector<double>& Frames() {
  static const auto* const frames = [] {
    auto* made = new std::vector<double>(12 * 4, 1);
    for (int f = 6; f < 12; ++f) (*made)[f * 4 + 1] = 20;
    return made;
  }();
  return *frames;
}

// True if it is imported; then it must be valid trials.
bool Import(const std::string& skin, const std::string& table,
            const std::string& name, const std::string& frames) {
  fuzz::Write("skin.json", skin);
  fuzz::Write("trials.csv", table);
  fuzz::Write(name, frames);
  const auto imported =
      ImportSkinFolder(fuzz::Folder(), {}, [](const Trial& trial) {
        REQUIRE(Validate(trial, "trial").ok());
        return absl::OkStatus();
      });
  fuzz::RequireReason(imported.status());
  return imported.ok();
}

std::string Table(const std::string& file) {
  return "frames,label,group\n" + file + ",left,a\n" + file + ",right,b\n";
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  static const auto* const skins = new std::vector<std::string>(Skins());
  static const auto* const npy = new std::vector<std::string>{
      NpyBytes({12, 4}, std::span<const double>(Frames())),
      NpyBytes({12, 2, 2}, std::span<const double>(Frames()))};
  static const auto* const npz =
      new std::vector<std::string>{*NpzBytes({{"frames", (*npy)[0]}})};
  if (size == 0) {
    // The good files are good.
    for (const std::string& skin : *skins) {
      REQUIRE(Import(skin, Table("x.csv"), "x.csv", FramesText()));
    }
    for (const std::string& file : *npy) {
      REQUIRE(Import((*skins)[0], Table("x.npy"), "x.npy", file));
    }
    REQUIRE(Import((*skins)[0], Table("x.npz"), "x.npz", (*npz)[0]));
  }
  FuzzedDataProvider data(bytes, size);
  std::string skin = (*skins)[data.ConsumeIntegralInRange<size_t>(0, 2)];
  const int part = data.ConsumeIntegralInRange(0, 4);
  const std::string ending = part == 2 ? "npy" : part == 3 ? "npz" : "csv";
  std::string table = Table("x." + ending);
  std::string frames = part == 2   ? fuzz::Damaged(*npy, data)
                       : part == 3 ? fuzz::Damaged(*npz, data)
                       : part == 4 ? fuzz::Damaged({FramesText()}, data)
                                   : FramesText();
  if (part == 0) skin = fuzz::Damaged(*skins, data);
  if (part == 1) table = fuzz::Damaged({table}, data);
  Import(skin, table, "x." + ending, frames);
  return 0;
}
