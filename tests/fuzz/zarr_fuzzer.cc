// A folder of Zarr with any bytes in its files, read as arrays, as a trial, and
// imported. What is imported must be valid trials.
//
// An input is the files of a folder, one after another, each behind a line with
// its path (PackText). The corpus, tests/fuzz/corpus/zarr, begins with small
// trials as `trainctl trials export` writes them, and with the same trials in
// plain chunks, because zlib's checksum refuses changed bytes at once. With
// TACTUS_SEEDS=FOLDER the empty input writes them there.
#include <zlib.h>

#include <map>

#include "core/data/trial_npz.h"
#include "core/data/trial_zarr.h"
#include "core/files/zarr.h"
#include "core/import/import.h"
#include "tests/fuzz/damaged.h"
#include "tests/support/flat_layout.h"

namespace {

using namespace tactus::internal;
namespace fs = std::filesystem;
namespace v1 = tactus::v1;

constexpr char kMarker[] = "\n@@ ";
// More make no other code run.
constexpr size_t kMostFiles = 64;

// The contents of files by their paths in the folder.
using Files = std::map<std::string, std::string>;

std::string PackText(const Files& files) {
  std::string text;
  for (const auto& [path, bytes] : files) {
    text += kMarker + path + "\n" + bytes;
  }
  return text;
}

// A path may only lead into the folder.
bool IsInside(const std::string& path) {
  if (path.empty() || path.size() > 60 || path.front() == '/') return false;
  for (const char c : path) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '.' &&
        c != '/' && c != '_') {
      return false;
    }
  }
  return path.find("..") == path.npos;
}

Files Unpack(const std::string& text) {
  Files files;
  for (size_t at = text.find(kMarker);
       at != text.npos && files.size() < kMostFiles;) {
    at += sizeof kMarker - 1;
    const size_t end = std::min(text.find('\n', at), text.size());
    const size_t next = std::min(text.find(kMarker, end), text.size());
    const std::string path = text.substr(at, end - at);
    if (IsInside(path)) {
      const size_t begin = std::min(end + 1, next);
      files[path] = text.substr(begin, next - begin);
    }
    at = next == text.size() ? text.npos : next;
  }
  return files;
}

std::string ReadBytes(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// What a chunk holds that WriteZarr packed.
std::string Unzip(const std::string& packed) {
  std::string plain(1 << 16, '\0');
  uLongf size = plain.size();
  REQUIRE(uncompress(reinterpret_cast<Bytef*>(plain.data()), &size,
                     reinterpret_cast<const Bytef*>(packed.data()),
                     packed.size()) == Z_OK);
  plain.resize(size);
  return plain;
}

// A trial as it is exported, or with plain chunks.
Files GoodFiles(const Trial& trial, bool plain) {
  const fs::path folder = fs::path(fuzz::Folder()) / "good";
  fs::remove_all(folder);
  REQUIRE(MakeZarrGroup(folder).ok());
  REQUIRE(TrialToZarr(trial, folder / trial.id).ok());
  Files files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    std::string bytes = ReadBytes(entry.path());
    const std::string name = entry.path().filename();
    if (plain && name == ".zarray") {
      const size_t begin = bytes.find("\"compressor\"");
      const size_t end = bytes.find('}', begin);
      REQUIRE(begin != bytes.npos && end != bytes.npos);
      bytes.replace(begin, end + 1 - begin, "\"compressor\": null");
    } else if (plain && name.front() != '.') {
      bytes = Unzip(bytes);
    }
    files[fs::relative(entry.path(), folder)] = bytes;
  }
  return files;
}

// Two frames of a skin of 2 x 2, with all that a trial may have.
Trial GoodTrial(v1::TaxelType type, bool touches) {
  Trial trial;
  trial.id = "a";
  trial.source = "gr\xC3\xBCn.csv";
  trial.label = "HU";
  trial.condition = "slow";
  trial.time = {0, 0.01};
  trial.signals = {{1, 2, 3}, {4, 5, 6}};
  trial.poses.resize(2);
  SkinLayout skin = testing::FlatLayout("s", 2, 2, TaxelUnit::kCounts, 10, 20);
  if (type == v1::TAXEL_TYPE_INT16) {
    skin.axes = 3;
    skin.normal_axis = 2;
    skin.signed_values = true;
    trial.taxels.i16.assign(24, -5);
  } else if (type == v1::TAXEL_TYPE_UINT16) {
    trial.taxels.u16 = {0, 1, 2, 3, 4, 5, 6, 65535};
    trial.taxels.scale = 0.5;
  } else {
    trial.taxels.f32 = {0, 1, 2, 3, 4, 5, 6, 0.1F};
  }
  trial.taxels.SetShape(skin);
  SetSkin(skin, trial);
  if (touches) {
    Touch& touch = trial.touches.emplace_back();
    touch.end_s = 0.01;
    touch.label = trial.label;
    touch.centre = {0.5, 1};
    touch.object_motion = {0, 1e-4};
  } else {
    trial.object_motion = {0, 1e-5};
  }
  return trial;
}

std::vector<Trial> GoodTrials() {
  return {GoodTrial(v1::TAXEL_TYPE_UINT16, false),
          GoodTrial(v1::TAXEL_TYPE_FLOAT32, true),
          GoodTrial(v1::TAXEL_TYPE_INT16, false)};
}

// Reads the files in each way that there is. Returns the imported trials.
absl::StatusOr<std::vector<Trial>> Read(const Files& files) {
  const fs::path folder = fs::path(fuzz::Folder()) / "z";
  fs::remove_all(folder);
  fs::create_directories(folder);
  for (const auto& [path, bytes] : files) {
    const fs::path file = folder / path;
    std::error_code error;
    // A file may lie where a folder should.
    fs::create_directories(file.parent_path(), error);
    std::ofstream(file, std::ios::binary) << bytes;
  }
  const auto arrays = ReadZarr(folder);
  fuzz::RequireReason(arrays.status());
  if (arrays.ok()) {
    for (const auto& [name, array] : *arrays) {
      size_t product = 1;
      for (const size_t size : array.shape) product *= size;
      REQUIRE(array.u16.size() + array.i16.size() + array.i64.size() +
                  array.f32.size() + array.f64.size() + array.text.size() ==
              product);
    }
  }
  const auto trial = TrialFromZarr(folder / "a");
  fuzz::RequireReason(trial.status());
  if (trial.ok()) REQUIRE(Validate(*trial, "trial").ok());
  std::vector<Trial> trials;
  const auto count = ImportTrials(folder, [&](Trial one) {
    REQUIRE(Validate(one, "trial").ok());
    trials.push_back(std::move(one));
    return absl::OkStatus();
  });
  fuzz::RequireReason(count.status());
  if (!count.ok()) return count.status();
  REQUIRE(*count == trials.size());
  return trials;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  if (size > 0) {
    Read(Unpack(std::string(reinterpret_cast<const char*>(bytes), size)))
        .status()
        .IgnoreError();
    return 0;
  }
  // The good files are good.
  int number = 0;
  for (const Trial& trial : GoodTrials()) {
    for (const bool plain : {false, true}) {
      const std::string pack = PackText(GoodFiles(trial, plain));
      const auto back = Read(Unpack(pack));
      REQUIRE(back.ok() && back->size() == 1 && back->front().id == trial.id);
      REQUIRE(*TrialToNpz(back->front()) == *TrialToNpz(trial));
      if (const char* folder = std::getenv("TACTUS_SEEDS")) {
        std::ofstream(fs::path(folder) / ("good" + std::to_string(number)),
                      std::ios::binary)
            << pack;
      }
      ++number;
    }
  }
  return 0;
}
