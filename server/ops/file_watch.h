// File: file_watch.h
//
// FileWatch: calls a function after a file has changed. A thread does it.
//
//   const FileWatch watch("/shared/tokens", [] { Reload(); });
//
// Looks twice a second, which works on network file systems too. The destructor
// waits for a call that is under way.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

namespace tactus::internal::server {

class FileWatch {
 public:
  FileWatch(std::string path, std::function<void()> on_change);
  ~FileWatch();

  FileWatch(const FileWatch&) = delete;
  FileWatch& operator=(const FileWatch&) = delete;

 private:
  // What changes with the file: its size, its place and when it was written.
  std::string Mark() const;

  const std::string path_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace tactus::internal::server
