// File: played_function_fs.h
//
// PlayedFunctionFs: FunctionFS and a USB device controller as files and pipes,
// with which a test plays the kernel and the host of a FunctionFs.
//
//   PlayedFunctionFs kernel;
//   FunctionFs function(kernel.options(), callbacks);
//   ASSERT_TRUE(function.Open().ok());
//   kernel.Opened();
//   kernel.Report(FUNCTIONFS_ENABLE);
//   kernel.SendBulk(bytes);
//
// A read of an empty pipe fails at once instead of waiting, as reads of an
// endpoint fail that the host resets. Belongs to one thread.
#pragma once

#include <fcntl.h>
#include <linux/usb/functionfs.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "gtest/gtest.h"
#include "tests/support/scratch_dir.h"
#include "tools/fakeskin/function_fs.h"

namespace tactus::internal::client {

class PlayedFunctionFs {
 public:
  PlayedFunctionFs() {
    for (size_t i = 0; i < pipes_.size(); ++i) {
      const std::string name = folder_ / ("ep" + std::to_string(i));
      EXPECT_EQ(::mkfifo(name.c_str(), 0600), 0);
      pipes_[i] = ::open(name.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
      EXPECT_GE(pipes_[i], 0);
    }
    std::filesystem::create_directory(folder_ / "controllers");
    WriteBytes(folder_ / "controllers/played.0", "");
    WriteBytes(folder_ / "UDC", "");
  }
  ~PlayedFunctionFs() {
    for (const int pipe : pipes_) ::close(pipe);
  }
  PlayedFunctionFs(const PlayedFunctionFs&) = delete;
  PlayedFunctionFs& operator=(const PlayedFunctionFs&) = delete;

  FunctionFsOptions options() const {
    return {.directory = folder_.path(),
            .gadget = folder_.path(),
            .controllers = folder_ / "controllers"};
  }

  // Takes the descriptors.
  void Opened() {
    std::array<char, 4096> bytes;
    while (::read(pipes_[0], bytes.data(), bytes.size()) > 0) {
    }
  }
  void Report(uint8_t type) { Report({.u = {}, .type = type, ._pad = {}}); }
  // A vendor request of the host, with its data.
  void SendControl(uint8_t request, std::span<const uint8_t> data) {
    usb_functionfs_event event = {};
    event.type = FUNCTIONFS_SETUP;
    event.u.setup.bRequestType = USB_TYPE_VENDOR | USB_DIR_OUT;
    event.u.setup.bRequest = request;
    event.u.setup.wLength = htole16(static_cast<uint16_t>(data.size()));
    Report(event);
    Write(pipes_[0], data.data(), data.size());
  }
  // A bulk transfer of the host. One at a time: a pipe does not keep them
  // apart.
  void SendBulk(std::span<const uint8_t> data) {
    Write(pipes_[2], data.data(), data.size());
  }

 private:
  void Report(const usb_functionfs_event& event) {
    Write(pipes_[0], &event, sizeof(event));
  }
  static void Write(int pipe, const void* data, size_t size) {
    EXPECT_EQ(::write(pipe, data, size), static_cast<ssize_t>(size));
  }

  const ScratchDir folder_;
  std::array<int, 3> pipes_ = {};
};

}  // namespace tactus::internal::client
