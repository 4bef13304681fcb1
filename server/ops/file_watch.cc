#include "server/ops/file_watch.h"

#include <sys/stat.h>

#include <chrono>
#include <utility>

#include "absl/strings/str_cat.h"

namespace tactus::internal::server {
namespace {

constexpr std::chrono::milliseconds kInterval(500);

}  // namespace

FileWatch::FileWatch(std::string path, std::function<void()> on_change)
    : path_(std::move(path)) {
  thread_ = std::thread(
      [this, on_change = std::move(on_change), mark = Mark()]() mutable {
        std::unique_lock lock(mutex_);
        while (!wake_.wait_for(lock, kInterval, [&] { return stopping_; })) {
          std::string now = Mark();
          if (now == mark) continue;
          mark = std::move(now);
          on_change();
        }
      });
}

FileWatch::~FileWatch() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

std::string FileWatch::Mark() const {
  struct stat about = {};
  if (stat(path_.c_str(), &about) != 0) return "";
  return absl::StrCat(about.st_size, " ", about.st_ino, " ",
                      about.st_mtim.tv_sec, " ", about.st_mtim.tv_nsec);
}

}  // namespace tactus::internal::server
