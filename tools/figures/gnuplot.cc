#include "tools/figures/gnuplot.h"

#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/string_view.h"
#include "absl/strings/strip.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::internal::client {
namespace {

constexpr char kProgram[] = "gnuplot";
constexpr size_t kMaxComplaint = 200;

absl::Status SystemError(const char* what, int error) {
  return IoError(kProgram, absl::StrCat(what, ": ", std::strerror(error)));
}

// An anonymous file in memory, inherited by child processes. Owns it.
class MemoryFile {
 public:
  explicit MemoryFile(const char* name) : descriptor_(memfd_create(name, 0)) {}
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  ~MemoryFile() {
    if (descriptor_ >= 0) close(descriptor_);
  }

  int descriptor() const { return descriptor_; }

  // Replaces the content; a reader then starts at the beginning.
  absl::Status Write(const std::string& text) {
    size_t done = 0;
    while (done < text.size()) {
      const ssize_t count =
          write(descriptor_, text.data() + done, text.size() - done);
      if (count < 0 && errno != EINTR) return SystemError("script", errno);
      if (count > 0) done += static_cast<size_t>(count);
    }
    if (lseek(descriptor_, 0, SEEK_SET) < 0) {
      return SystemError("script", errno);
    }
    return absl::OkStatus();
  }

  absl::StatusOr<std::string> Read() const {
    const off_t size = lseek(descriptor_, 0, SEEK_END);
    if (size < 0) return SystemError("output", errno);
    std::string text(static_cast<size_t>(size), '\0');
    size_t done = 0;
    while (done < text.size()) {
      const ssize_t count = pread(descriptor_, text.data() + done,
                                  text.size() - done, static_cast<off_t>(done));
      if (count < 0 && errno != EINTR) return SystemError("output", errno);
      if (count == 0) break;
      if (count > 0) done += static_cast<size_t>(count);
    }
    return text;
  }

 private:
  int descriptor_;
};

// This process's environment with a UTF-8 locale, so that the same script draws
// the same picture everywhere. Without it gnuplot warns of its own degree sign
// before it says what is wrong.
std::vector<std::string> Utf8Environment() {
  std::vector<std::string> variables;
  for (char** each = environ; *each != nullptr; ++each) {
    const absl::string_view variable = *each;
    if (!absl::StartsWith(variable, "LC_ALL=")) {
      variables.emplace_back(variable);
    }
  }
  variables.push_back("LC_ALL=C.UTF-8");
  return variables;
}

// Starts gnuplot with these files as its standard streams and waits for it.
// Returns what waitpid reports.
absl::StatusOr<int> SpawnAndWait(const MemoryFile& in, const MemoryFile& out,
                                 const MemoryFile& complaints) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  const std::pair<int, int> streams[] = {
      {in.descriptor(), STDIN_FILENO},
      {out.descriptor(), STDOUT_FILENO},
      {complaints.descriptor(), STDERR_FILENO}};
  for (const auto& [from, to] : streams) {
    posix_spawn_file_actions_adddup2(&actions, from, to);
  }
  std::string program = kProgram;
  std::string ignore_user_settings = "-d";
  char* const arguments[] = {program.data(), ignore_user_settings.data(),
                             nullptr};
  std::vector<std::string> variables = Utf8Environment();
  std::vector<char*> environment;
  for (std::string& variable : variables) {
    environment.push_back(variable.data());
  }
  environment.push_back(nullptr);
  pid_t child = 0;
  const int error = posix_spawnp(&child, kProgram, &actions, nullptr, arguments,
                                 environment.data());
  posix_spawn_file_actions_destroy(&actions);
  if (error == ENOENT) {
    return IoError(kProgram,
                   "is not installed; figures need the Debian package "
                   "gnuplot-nox (apt-get install gnuplot-nox)");
  }
  if (error != 0) return SystemError("cannot be started", error);
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) return SystemError("cannot be waited for", errno);
  }
  return status;
}

// gnuplot repeats the line of the script and marks the place in it before it
// names what is wrong, after "line 0:", which is where a pipe always is.
std::string FirstComplaint(absl::string_view text) {
  for (absl::string_view line : absl::StrSplit(text, '\n')) {
    line = absl::StripAsciiWhitespace(line);
    if (absl::ConsumePrefix(&line, "line 0: ")) return std::string(line);
  }
  return std::string(text.substr(0, kMaxComplaint));
}

}  // namespace

absl::StatusOr<std::string> RunGnuplot(const std::string& script) {
  MemoryFile in("gnuplot-script");
  const MemoryFile out("gnuplot-picture");
  const MemoryFile complaints("gnuplot-complaints");
  for (const MemoryFile* file : {&std::as_const(in), &out, &complaints}) {
    if (file->descriptor() < 0) return SystemError("memory file", errno);
  }
  TACTUS_RETURN_IF_ERROR(in.Write(script));
  TACTUS_ASSIGN_OR_RETURN(const int status, SpawnAndWait(in, out, complaints));
  if (WIFSIGNALED(status)) {
    return IoError(kProgram,
                   absl::StrCat("ended by signal ", WTERMSIG(status)));
  }
  if (WEXITSTATUS(status) != 0) {
    TACTUS_ASSIGN_OR_RETURN(const std::string text, complaints.Read());
    return IoError(kProgram, absl::StrCat("exit status ", WEXITSTATUS(status),
                                          ": ", FirstComplaint(text)));
  }
  return out.Read();
}

absl::Status DrawToFile(const std::string& script, const std::string& path) {
  TACTUS_ASSIGN_OR_RETURN(const std::string picture, RunGnuplot(script));
  std::ofstream file(path, std::ios::binary);
  file << picture;
  if (!file.flush()) return IoError(path, "cannot be written");
  return absl::OkStatus();
}

}  // namespace tactus::internal::client
