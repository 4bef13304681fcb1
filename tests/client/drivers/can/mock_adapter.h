// File: mock_adapter.h
//
// MockAdapter: a gs_usb adapter that libusb sees as a USB device of this
// machine, with a simulated skin on its bus. The kernel's part is played by
// umockdev in this process, which must run under umockdev-wrapper. Test-only.
//
//   MockAdapter adapter(&boards, {});
//   GsUsb bus({});
//   ASSERT_TRUE(bus.Open({}).ok());
//   adapter.Unplug();
//
// Thread-safe: umockdev calls from a separate thread.
#pragma once

#include <umockdev.h>

#include <deque>
#include <mutex>
#include <string>
#include <vector>

#include "tools/fakeskin/can_peer.h"
#include "tools/fakeskin/gs_usb_firmware.h"

namespace tactus::internal::client {

// The USB device of a gs_usb adapter in /sys of `testbed`, number 7 on bus 1.
inline constexpr char kMockAdapterSysPath[] = "/sys/devices/usb1/1-1";
void AddMockAdapter(UMockdevTestbed* testbed);

class MockAdapter {
 public:
  struct Options {
    uint32_t features = gs_usb::kHardwareStamps;
    uint32_t clock_hz = 48'000'000;
    // Value of the first time stamp.
    uint32_t first_stamp_us = 0;
    std::string serial = "0042";
    // A driver of the kernel holds the interface.
    bool kernel_driver = false;
  };

  // `peer` is on the bus, and lives by the steady clock.
  MockAdapter(CanPeer* peer, const Options& options);
  ~MockAdapter();

  MockAdapter(const MockAdapter&) = delete;
  MockAdapter& operator=(const MockAdapter&) = delete;

  // Takes the device away from libusb, and gives it back.
  void Unplug();
  void Plug();
  // Sends these bytes to the host as they are.
  void SendRaw(std::vector<uint8_t> bytes);
  // The next `count` transfers from the device fail with this errno.
  void FailTransfers(int count, int error);
  // Frames to send are taken, and never reach the bus.
  void SetDeaf(bool deaf);

  // What the host has set up.
  bool started();
  uint32_t mode_flags();
  std::vector<uint8_t> bit_timing();
  bool kernel_driver_attached();
  bool claimed();
  // Bytes of the last frame that the host sent.
  size_t last_sent_size();
  // The most transfers that waited at once.
  size_t most_waiting();

 private:
  static gboolean OnIoctl(UMockdevIoctlBase* handler,
                          UMockdevIoctlClient* client, MockAdapter* self);
  // False: umockdev answers that the call is unknown.
  bool Handle(UMockdevIoctlClient* client);
  void Submit(UMockdevIoctlClient* client, UMockdevIoctlData* argument);
  void Reap(UMockdevIoctlClient* client, UMockdevIoctlData* argument);
  void Discard(UMockdevIoctlClient* client, UMockdevIoctlData* argument);
  // Answers a control request; the bytes to return, or -errno.
  int Control(std::vector<uint8_t>& buffer);
  void TakeSent(const std::vector<uint8_t>& bytes);
  // Gives waiting frames to the bus, and fills waiting transfers with what
  // there is.
  void Pump();
  int64_t NowNs() const;

  struct Urb {
    UMockdevIoctlData* data = nullptr;
    UMockdevIoctlData* buffer = nullptr;
    unsigned long client_address = 0;
  };
  void Finish(const Urb& urb, int status, const std::vector<uint8_t>& bytes);

  CanPeer* const peer_;
  const Options options_;
  UMockdevTestbed* testbed_ = nullptr;
  UMockdevIoctlBase* handler_ = nullptr;

  std::mutex mutex_;
  GsUsbFirmware firmware_;
  bool plugged_ = true;
  bool claimed_ = false;
  bool attached_ = false;
  bool deaf_ = false;
  size_t last_sent_size_ = 0;
  size_t most_waiting_ = 0;
  int failures_ = 0;
  int failure_ = 0;
  // Frames of the host that wait for the bus. A reset drops them.
  std::deque<std::vector<uint8_t>> to_bus_;
  std::deque<std::vector<uint8_t>> to_host_;
  std::deque<Urb> waiting_;
  std::deque<Urb> done_;
};

}  // namespace tactus::internal::client
