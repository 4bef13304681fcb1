// File: file_descriptor.h
//
// FileDescriptor: owns an open file or socket and closes it.
//
//   FileDescriptor socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
//   if (!socket.is_open()) return IoError("socket", "closed");
//
// Movable, not copyable. Not thread-safe.
#pragma once

#include <unistd.h>

#include <utility>

namespace tactus::internal::server {

class FileDescriptor {
 public:
  FileDescriptor() = default;
  // Takes ownership of `number`; below 0 means not open.
  explicit FileDescriptor(int number) : number_(number) {}
  FileDescriptor(FileDescriptor&& other) noexcept : number_(other.Release()) {}
  FileDescriptor& operator=(FileDescriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~FileDescriptor() {
    if (is_open()) close(number_);
  }

  bool is_open() const { return number_ >= 0; }
  int get() const { return number_; }
  // Gives the ownership to the caller.
  int Release() { return std::exchange(number_, -1); }

 private:
  int number_ = -1;
};

}  // namespace tactus::internal::server
