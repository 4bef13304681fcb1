// trainctl tokens: makes, lists and removes the tokens that tactusd --tokens
// knows.
#include <fcntl.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <vector>

#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/access/access_table.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/files/file_bytes.h"
#include "tools/trainctl/command.h"
#include "tools/trainctl/exit_code.h"

namespace tactus::internal::client {
namespace {

struct TokensFlags {
  std::string name;
  std::string role;
  std::string file;
  bool json = false;
};

absl::StatusOr<std::string> NewToken() {
  std::array<char, 32> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) !=
      static_cast<ssize_t>(bytes.size())) {
    return IoError("the system's random numbers", std::strerror(errno));
  }
  return absl::BytesToHexString(absl::string_view(bytes.data(), bytes.size()));
}

absl::StatusOr<AccessTable> ParseTokens(const std::string& path,
                                        const std::string& text) {
  auto table = AccessTable::Parse(text);
  if (!table.ok()) return Annotate(table.status(), path);
  return table;
}

// A tokens file that no other trainctl changes at the same time.
class LockedFile {
 public:
  // `flags`: of open(2), O_APPEND | O_CREAT for Append and 0 for Remove.
  LockedFile(const std::string& path, int flags)
      : path_(path), fd_(open(path.c_str(), O_RDWR | O_CLOEXEC | flags, 0644)) {
    if (fd_ >= 0) flock(fd_, LOCK_EX);
  }
  ~LockedFile() {
    if (fd_ >= 0) close(fd_);
  }

  LockedFile(const LockedFile&) = delete;
  LockedFile& operator=(const LockedFile&) = delete;

  // INVALID_CONFIG unless the file with `line` at its end is a tokens file.
  absl::Status Append(const std::string& line) {
    TACTUS_ASSIGN_OR_RETURN(const std::string text, Read());
    const std::string addition = absl::StrCat(
        text.empty() || absl::EndsWith(text, "\n") ? "" : "\n", line);
    TACTUS_RETURN_IF_ERROR(ParseTokens(path_, text + addition).status());
    // A write that fails part-way leaves a line that the next reader names.
    if (write(fd_, addition.data(), addition.size()) !=
            static_cast<ssize_t>(addition.size()) ||
        fsync(fd_) != 0) {
      return IoError(path_, std::strerror(errno));
    }
    return absl::OkStatus();
  }

  // Removes the lines of the entry `name`, a token or a certificate, and leaves
  // all others as they are. INVALID_CONFIG if there is none, or no other.
  absl::Status Remove(const std::string& name) {
    TACTUS_ASSIGN_OR_RETURN(const std::string text, Read());
    const std::string rest = WithoutEntry(text, name);
    if (rest.size() == text.size()) return NoEntry(text, name);
    TACTUS_RETURN_IF_ERROR(ParseTokens(path_, text).status());
    if (!AccessTable::Parse(rest).ok()) return LastEntry(name);
    // A server that reads in between finds a file with a mistake, and keeps the
    // tokens that it has.
    if (pwrite(fd_, rest.data(), rest.size(), 0) !=
            static_cast<ssize_t>(rest.size()) ||
        ftruncate(fd_, static_cast<off_t>(rest.size())) != 0 ||
        fsync(fd_) != 0) {
      return IoError(path_, std::strerror(errno));
    }
    return absl::OkStatus();
  }

 private:
  absl::StatusOr<std::string> Read() const {
    if (fd_ < 0) return IoError(path_, std::strerror(errno));
    return ReadFileBytes(path_, AccessTable::kMaxFileBytes);
  }
  absl::Status NoEntry(const std::string& text, const std::string& name) const {
    TACTUS_ASSIGN_OR_RETURN(const AccessTable table, ParseTokens(path_, text));
    std::vector<std::string> names;
    for (const auto& token : table.tokens()) names.push_back(token.entry.name);
    for (const auto& [of, entry] : table.certificates()) names.push_back(of);
    return Annotate(
        InvalidConfig("the name", Quoted(name),
                      absl::StrCat("one of: ", absl::StrJoin(names, ", "))),
        path_);
  }
  absl::Status LastEntry(const std::string& name) const {
    return Annotate(
        InvalidConfig(
            "the name", Quoted(name),
            "not the last entry: a server takes no file without one, and would "
            "keep this one. Create another entry first, or restart the server "
            "without --tokens"),
        path_);
  }

  const std::string path_;
  const int fd_;
};

absl::Status CreateToken(const TokensFlags& flags) {
  const absl::StatusOr<Role> role = ParseRole(flags.role);
  if (!role.ok()) return WithExitCode(role.status(), kExitUsage);
  TACTUS_ASSIGN_OR_RETURN(const std::string token, NewToken());
  TACTUS_ASSIGN_OR_RETURN(const std::string line,
                          TokenLine(flags.name, *role, token));
  if (flags.file.empty()) {
    std::fprintf(stderr, "Line for the server's tokens file:\n%s",
                 line.c_str());
  } else {
    TACTUS_RETURN_IF_ERROR(
        LockedFile(flags.file, O_APPEND | O_CREAT).Append(line));
    std::fprintf(stderr,
                 "Added %s to %s. tactusd reads the file when it starts and on "
                 "SIGHUP. The token is shown once:\n",
                 flags.name.c_str(), flags.file.c_str());
  }
  // Alone on standard output, so that it can go to a file.
  std::printf("%s\n", token.c_str());
  return absl::OkStatus();
}

absl::Status RemoveToken(const TokensFlags& flags) {
  TACTUS_RETURN_IF_ERROR(LockedFile(flags.file, 0).Remove(flags.name));
  std::fprintf(stderr,
               "Removed %s from %s. tactusd knows it until it reads the file "
               "again, on SIGHUP; streams that have begun go on.\n",
               flags.name.c_str(), flags.file.c_str());
  return absl::OkStatus();
}

absl::Status ListTokens(const TokensFlags& flags) {
  TACTUS_ASSIGN_OR_RETURN(
      const std::string text,
      ReadFileBytes(flags.file, AccessTable::kMaxFileBytes));
  TACTUS_ASSIGN_OR_RETURN(const AccessTable table,
                          ParseTokens(flags.file, text));
  Json json = Json::array();
  const auto add = [&](const AccessTable::Entry& entry, const char* kind) {
    const std::string role(RoleName(entry.role));
    json.push_back({{"name", entry.name}, {"role", role}, {"kind", kind}});
    if (!flags.json) {
      std::printf("%-24s %-8s %s\n", entry.name.c_str(), role.c_str(), kind);
    }
  };
  for (const auto& token : table.tokens()) add(token.entry, "token");
  for (const auto& [name, entry] : table.certificates()) {
    add(entry, "certificate");
  }
  if (flags.json) std::printf("%s\n", JsonText(json).c_str());
  return absl::OkStatus();
}

}  // namespace

void AddTokens(CLI::App& app, const SelectCommand& select) {
  auto flags = std::make_shared<TokensFlags>();
  CLI::App& tokens = CommandGroup(
      app, "tokens", "Make, list and remove the tokens of a server",
      "list --file=/etc/tactus/tokens");
  CLI::App* create =
      &AddVerb(tokens, "create", "Make a token and print it once",
               "create --name=arm-7 --role=robot --file=/etc/tactus/tokens > "
               "arm-7.token");
  create->add_option("--name", flags->name, "Names the caller in logs")
      ->required();
  create->add_option("--role", flags->role, "robot, viewer, trainer or admin")
      ->required();
  create->add_option("--file", flags->file,
                     "Tokens file to add it to; without it, the line is "
                     "printed");
  create->callback([=] { select([=] { return CreateToken(*flags); }); });
  CLI::App* remove = &AddVerb(tokens, "remove",
                              "Remove the token or the certificate of a name",
                              "remove --name=arm-7 --file=/etc/tactus/tokens");
  remove->add_option("--name", flags->name, "As list prints it")->required();
  remove->add_option("--file", flags->file, "Tokens file")->required();
  remove->callback([=] { select([=] { return RemoveToken(*flags); }); });
  CLI::App* list = &AddVerb(tokens, "list", "Names and roles of a file",
                            "list --file=/etc/tactus/tokens");
  list->add_option("--file", flags->file, "Tokens file")->required();
  list->add_flag("--json", flags->json, "Print one JSON array");
  list->callback([=] { select([=] { return ListTokens(*flags); }); });
}

}  // namespace tactus::internal::client
