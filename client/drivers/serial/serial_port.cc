#include "client/drivers/serial/serial_port.h"

#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "core/base/errors.h"

namespace tactus::internal::client {
namespace {

struct Rate {
  int baud;
  speed_t speed;
};
constexpr Rate kRates[] = {
    {9'600, B9600},        {19'200, B19200},      {38'400, B38400},
    {57'600, B57600},      {115'200, B115200},    {230'400, B230400},
    {460'800, B460800},    {500'000, B500000},    {921'600, B921600},
    {1'000'000, B1000000}, {1'500'000, B1500000}, {2'000'000, B2000000},
    {3'000'000, B3000000}};

}  // namespace

SerialPort::SerialPort(std::string path, int baud)
    : path_(std::move(path)), baud_(baud) {}

SerialPort::~SerialPort() { Close(); }

absl::Status SerialPort::Open() {
  Close();
  speed_t speed = B0;
  for (const Rate& rate : kRates) {
    if (rate.baud == baud_) speed = rate.speed;
  }
  if (speed == B0) {
    return InvalidConfig("baud", baud_,
                         "9600, 19200, 38400, 57600, 115200, 230400, 460800, "
                         "500000, 921600, 1000000, 1500000, 2000000 or "
                         "3000000");
  }
  file_ = ::open(path_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (file_ < 0) return IoError(path_, std::strerror(errno));
  termios settings;
  if (tcgetattr(file_, &settings) != 0) {
    const absl::Status status = IoError(path_, std::strerror(errno));
    Close();
    return status;
  }
  before_ = settings;
  cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~static_cast<tcflag_t>(CRTSCTS);
  cfsetispeed(&settings, speed);
  cfsetospeed(&settings, speed);
  if (tcsetattr(file_, TCSANOW, &settings) != 0 ||
      tcflush(file_, TCIFLUSH) != 0) {
    const absl::Status status = IoError(path_, std::strerror(errno));
    Close();
    return status;
  }
  low_latency_.emplace(file_);
  latency_ = low_latency_->ToText(path_);
  return absl::OkStatus();
}

void SerialPort::Close() {
  if (file_ >= 0) {
    low_latency_.reset();
    if (before_) tcsetattr(file_, TCSANOW, &*before_);
    ::close(file_);
  }
  file_ = -1;
  before_.reset();
  latency_.clear();
}

absl::StatusOr<size_t> SerialPort::Read(std::span<uint8_t> bytes,
                                        int64_t timeout_ns) {
  if (file_ < 0) return IoError(path_, "is closed");
  pollfd poll = {.fd = file_, .events = POLLIN, .revents = 0};
  const timespec timeout = {
      .tv_sec = static_cast<time_t>(timeout_ns / 1'000'000'000),
      .tv_nsec = static_cast<long>(timeout_ns % 1'000'000'000)};
  const int ready = ppoll(&poll, 1, &timeout, nullptr);
  if (ready < 0 && errno != EINTR) return IoError(path_, std::strerror(errno));
  if (ready <= 0) return size_t{0};
  const ssize_t count = ::read(file_, bytes.data(), bytes.size());
  if (count > 0) return static_cast<size_t>(count);
  if (count < 0 && (errno == EAGAIN || errno == EINTR)) return size_t{0};
  // The end of the file: an adapter that was pulled out.
  return IoError(path_,
                 count == 0 ? "the device is gone" : std::strerror(errno));
}

}  // namespace tactus::internal::client
