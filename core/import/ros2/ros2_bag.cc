#include "core/import/ros2/ros2_bag.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits_bags.h"
#include "core/base/status_macros.h"
#include "core/files/mcap/compression.h"
#include "core/files/mcap/mcap_reader.h"
#include "core/import/ros2/bag_files.h"

namespace tactus::internal {
namespace {

namespace fs = std::filesystem;

bool IsBagFile(const fs::path& path) {
  return path.extension() == ".mcap" || path.extension() == ".db3";
}

// The files of a folder, run_2 before run_10.
absl::StatusOr<std::vector<std::string>> BagFilesOf(const std::string& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) {
    if (!IsBagFile(path)) {
      return TrialFileInvalid(path,
                              "is no bag of ROS 2: a bag is an .mcap or .db3 "
                              "file, or a folder of them");
    }
    return std::vector<std::string>{path};
  }
  std::vector<std::string> files;
  std::string packed;
  for (fs::directory_iterator it(path, error), end; !error && it != end;
       it.increment(error)) {
    const fs::path& file = it->path();
    if (IsBagFile(file)) files.push_back(file.string());
    if (IsBagFile(file.stem()) && file.extension() == ".zstd") packed = file;
    if (files.size() > limits::kMaxBagFiles) {
      return TrialFileInvalid(
          path, absl::StrCat("holds more than ", limits::kMaxBagFiles,
                             " files of a bag"));
    }
  }
  if (error) return IoError(path, error.message());
  if (files.empty() && !packed.empty()) {
    return TrialFileInvalid(
        packed, "is compressed as a whole; decompress it first: zstd -d");
  }
  if (files.empty()) {
    const std::string within = FirstBagIn(path);
    return TrialFileInvalid(
        path, within.empty()
                  ? "holds no .mcap or .db3"
                  : absl::StrCat("is no bag, but holds bags; name one of "
                                 "them, such as ",
                                 within));
  }
  std::sort(files.begin(), files.end(), [](const auto& a, const auto& b) {
    return std::pair(a.size(), a) < std::pair(b.size(), b);
  });
  const auto kind = fs::path(files.front()).extension();
  for (const std::string& file : files) {
    if (fs::path(file).extension() == kind) continue;
    return TrialFileInvalid(
        path, "holds .mcap and .db3 files, which are no single bag");
  }
  return files;
}

}  // namespace

absl::StatusOr<std::unique_ptr<Ros2Bag>> Ros2Bag::Open(
    const std::string& path) {
  std::error_code error;
  if (!fs::exists(path, error)) return IoError(path, "cannot be read");
  std::unique_ptr<Ros2Bag> bag(new Ros2Bag());
  bag->path_ = path;
  TACTUS_ASSIGN_OR_RETURN(bag->files_, BagFilesOf(path));
  const bool mcap = fs::path(bag->files_.front()).extension() == ".mcap";
  bag->storage_ = mcap ? "mcap" : "sqlite3";
  TACTUS_RETURN_IF_ERROR(bag->OpenFile());
  return bag;
}

absl::Status Ros2Bag::OpenFile() {
  const std::string& path = files_[opened_++];
  TACTUS_ASSIGN_OR_RETURN(
      file_, storage_ == "mcap" ? OpenMcapBag(path) : OpenSqliteBag(path));
  file_places_.clear();
  return absl::OkStatus();
}

absl::StatusOr<size_t> Ros2Bag::PlaceOf(const BagTopic& topic) {
  const auto [place, added] = places_.try_emplace(
      {topic.name, topic.type, topic.encoding}, topics_.size());
  if (!added) return place->second;
  if (topics_.size() >= limits::kMaxBagTopics) {
    return TrialFileInvalid(
        path_,
        absl::StrCat("has more than ", limits::kMaxBagTopics, " topics"));
  }
  topics_.push_back(topic);
  return place->second;
}

absl::StatusOr<const BagMessage*> Ros2Bag::Next() {
  while (file_ != nullptr) {
    const BagTopic* topic = nullptr;
    TACTUS_ASSIGN_OR_RETURN(const bool more, file_->Next(&message_, &topic));
    if (more) {
      if (++messages_ > limits::kMaxBagMessages) {
        return TrialFileInvalid(
            path_, absl::StrCat("has more than ", limits::kMaxBagMessages,
                                " messages"));
      }
      const auto known = file_places_.find(topic);
      if (known != file_places_.end()) {
        message_.topic = known->second;
      } else {
        TACTUS_ASSIGN_OR_RETURN(message_.topic, PlaceOf(*topic));
        file_places_[topic] = message_.topic;
      }
      // Each message alone may be compressed. CDR begins with a zero.
      if (IsZstd(message_.data)) {
        const uint64_t size = ZstdSize(message_.data);
        const std::string fault =
            size > limits::kMaxBagMessageBytes
                ? absl::StrCat("has ", size, " bytes; the limit is ",
                               limits::kMaxBagMessageBytes)
                : Decompress("zstd", message_.data, size, &decompressed_);
        if (!fault.empty()) {
          return TrialFileInvalid(
              path_, absl::StrCat("message ", messages_, " ", fault));
        }
        compressions_.insert("zstd");
        message_.data = decompressed_;
      }
      return &message_;
    }
    for (const BagTopic& each : file_->AllTopics()) {
      TACTUS_RETURN_IF_ERROR(PlaceOf(each).status());
    }
    compressions_.merge(file_->Compressions());
    if (std::string text = file_->CutOff(); !text.empty()) {
      cut_off_.push_back(std::move(text));
    }
    file_.reset();
    if (opened_ < files_.size()) TACTUS_RETURN_IF_ERROR(OpenFile());
  }
  return nullptr;
}

double SecondsBetween(int64_t first_ns, int64_t last_ns) {
  // A difference of two 64-bit numbers could overflow.
  constexpr int64_t kSecond = 1'000'000'000;
  const int64_t seconds = last_ns / kSecond - first_ns / kSecond;
  const int64_t rest = last_ns % kSecond - first_ns % kSecond;
  return static_cast<double>(seconds) + 1e-9 * static_cast<double>(rest);
}

std::string FirstBagIn(const std::string& folder) {
  std::string first;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end;
       it.increment(error)) {
    const std::string bag = it->path().string();
    bool is_bag = IsBagFile(it->path());
    std::error_code closed;
    for (fs::directory_iterator in(it->path(), closed); !closed && in != end;
         in.increment(closed)) {
      is_bag = is_bag || IsBagFile(in->path());
    }
    if (is_bag && (first.empty() || bag < first)) first = bag;
  }
  return first;
}

bool IsRos2Bag(const std::string& path) {
  std::error_code error;
  const fs::path place(path);
  if (fs::is_directory(place, error)) {
    if (fs::exists(place / "metadata.yaml", error)) return true;
    return !fs::exists(place / "skin.json", error) && BagFilesOf(path).ok();
  }
  if (place.extension() == ".db3") return true;
  if (place.extension() != ".mcap") return false;
  const auto reader = McapReader::Open(path);
  if (!reader.ok()) return false;
  // The header is read with the first record.
  (*reader)->Next().status().IgnoreError();
  return (*reader)->profile() == "ros2";
}

}  // namespace tactus::internal
