#include "tools/common/terminal.h"

#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <iterator>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/base/errors.h"

namespace tactus::internal::client {
namespace {

constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP};
// The other screen, without a cursor; and back.
constexpr char kEnter[] = "\x1b[?1049h\x1b[?25l";
constexpr char kLeave[] = "\x1b[0m\x1b[?25h\x1b[?1049l";

volatile std::sig_atomic_t g_interrupted = 0;

void Interrupt(int /*signal*/) { g_interrupted = 1; }

void WriteAll(absl::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = write(STDOUT_FILENO, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    // A terminal that is gone sends SIGHUP.
    if (written <= 0) return;
    bytes.remove_prefix(static_cast<size_t>(written));
  }
}

// As setlocale chooses it.
const char* LocaleName() {
  for (const char* name : {"LC_ALL", "LC_CTYPE", "LANG"}) {
    const char* value = std::getenv(name);
    if (value != nullptr && *value != 0) return value;
  }
  return nullptr;
}

}  // namespace

bool UsesColour(const char* no_color, const char* term, const char* locale) {
  if (no_color != nullptr && *no_color != 0) return false;
  if (term == nullptr || absl::string_view(term) == "dumb") return false;
  const std::string name = absl::AsciiStrToLower(locale ? locale : "");
  return absl::StrContains(name, "utf-8") || absl::StrContains(name, "utf8");
}

absl::StatusOr<std::unique_ptr<Terminal>> Terminal::Open(
    absl::string_view what) {
  if (isatty(STDIN_FILENO) == 0 || isatty(STDOUT_FILENO) == 0) {
    return InvalidConfig(what, "used without a terminal",
                         "used in a terminal, because it draws a screen and "
                         "reads keys");
  }
  return std::unique_ptr<Terminal>(new Terminal());
}

Terminal::Terminal()
    : colour_(UsesColour(std::getenv("NO_COLOR"), std::getenv("TERM"),
                         LocaleName())) {
  g_interrupted = 0;
  struct sigaction action = {};
  action.sa_handler = Interrupt;
  for (size_t i = 0; i < std::size(kSignals); ++i) {
    sigaction(kSignals[i], &action, &actions_[i]);
  }
  tcgetattr(STDIN_FILENO, &before_);
  termios raw = before_;
  raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  raw.c_cc[VMIN] = 0;
  raw.c_cc[VTIME] = 0;
  // A stopped program would leave the screen as it is.
  raw.c_cc[VSUSP] = _POSIX_VDISABLE;
  tcsetattr(STDIN_FILENO, TCSANOW, &raw);
  WriteAll(kEnter);
}

Terminal::~Terminal() {
  WriteAll(kLeave);
  tcsetattr(STDIN_FILENO, TCSANOW, &before_);
  for (size_t i = 0; i < std::size(kSignals); ++i) {
    sigaction(kSignals[i], &actions_[i], nullptr);
  }
}

TerminalSize Terminal::Size() const {
  winsize size = {};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) {
    return {};
  }
  return {size.ws_col, size.ws_row};
}

void Terminal::Draw(const std::vector<std::string>& lines) {
  const TerminalSize size = Size();
  std::string screen = "\x1b[H";
  if (size.columns != drawn_.columns || size.rows != drawn_.rows) {
    screen = "\x1b[2J\x1b[H";
    drawn_ = size;
  }
  for (size_t i = 0; i < lines.size(); ++i) {
    absl::StrAppend(&screen, i > 0 ? "\r\n" : "", lines[i], "\x1b[K");
  }
  WriteAll(screen + "\x1b[J");
}

std::optional<char> Terminal::ReadKey() {
  pollfd wait = {.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
  if (poll(&wait, 1, 0) <= 0 || (wait.revents & POLLIN) == 0) return {};
  char key = 0;
  if (read(STDIN_FILENO, &key, 1) != 1) return {};
  return key;
}

bool Terminal::interrupted() const { return g_interrupted != 0; }

}  // namespace tactus::internal::client
