// tactus-console: what robots feel, in a browser.
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "CLI/CLI.hpp"
#include "absl/synchronization/mutex.h"
#include "core/base/arguments.h"
#include "core/base/status_macros.h"
#include "core/base/thread_priority.h"
#include "core/base/version.h"
#include "tools/common/vetted_servers.h"
#include "tools/console/console.h"

namespace tactus::internal::console {
namespace {

struct Flags {
  std::vector<std::string> servers = {"127.0.0.1:50051"};
  std::optional<std::string> tls_ca;
  ConsoleOptions console;
};

// Where the page lies beside an installed program, and in a build.
std::string DefaultPage() {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  return (self.parent_path().parent_path() / "share/tactus/console").string();
}

// Returns after SIGINT or SIGTERM.
absl::Status Serve(Flags flags, const sigset_t& stop) {
  client::ChannelOptions channel;
  if (flags.tls_ca) {
    TACTUS_ASSIGN_OR_RETURN(channel.tls_roots,
                            client::ReadRootCertificates(*flags.tls_ca));
  }
  for (const std::string& server : flags.servers) {
    flags.console.servers.push_back({server, channel});
  }
  TACTUS_ASSIGN_OR_RETURN(const auto console, Console::Start(flags.console));
  const std::string& listen = flags.console.listen;
  std::printf("console: %s://%s:%d/\n",
              flags.console.tls_certificate.empty() ? "http" : "https",
              listen.substr(0, listen.rfind(':')).c_str(), console->port());
  std::fflush(stdout);
  int signal = 0;
  sigwait(&stop, &signal);
  return absl::OkStatus();
}

int Main(int argc, char** argv) {
  absl::SetMutexDeadlockDetectionMode(absl::OnDeadlockCycle::kIgnore);
  // A server for robots may run beside it.
  SetThreadPriority(ThreadPriority::kAttendant);
  client::VetServers("tactus-console");
  std::signal(SIGPIPE, SIG_IGN);
  sigset_t stop;
  sigemptyset(&stop);
  sigaddset(&stop, SIGINT);
  sigaddset(&stop, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &stop, nullptr);
  Flags flags;
  flags.console.page = DefaultPage();
  CLI::App app("Shows what robots feel, in a browser.", "tactus-console");
  app.set_version_flag("--version", std::string("tactus-console ") + kVersion);
  app.add_option("--server", flags.servers,
                 "Server to show: host:port or unix:path; may be repeated")
      ->capture_default_str();
  app.add_option("--tls-ca", flags.tls_ca,
                 "PEM file of the authorities that may vouch for the servers; "
                 "with it, the connections to them use TLS")
      ->check(CLI::ExistingFile);
  app.add_option("--listen", flags.console.listen,
                 "Address for browsers, host:port; port 0: any free one")
      ->capture_default_str();
  app.add_option("--tls-certificate", flags.console.tls_certificate,
                 "PEM file with the console's certificate: browsers use https")
      ->check(CLI::ExistingFile);
  app.add_option("--tls-key", flags.console.tls_key,
                 "PEM file with the certificate's private key")
      ->check(CLI::ExistingFile);
  app.add_option("--page", flags.console.page,
                 "Folder with the page's files; default: share/tactus/console "
                 "beside the program's folder")
      ->check(CLI::ExistingDirectory);
  app.add_option("--import-folder", flags.console.imports.folder,
                 "Folder for files that people import, for as long as that "
                 "takes; default: $TMPDIR, or /var/tmp")
      ->check(CLI::ExistingDirectory);
  CLI11_PARSE(app, argc, argv);
  absl::Status status = CheckArguments(argc, argv);
  if (status.ok()) status = Serve(std::move(flags), stop);
  if (status.ok()) return 0;
  std::fprintf(stderr, "tactus-console: %s\n",
               std::string(status.message()).c_str());
  return 1;
}

}  // namespace
}  // namespace tactus::internal::console

int main(int argc, char** argv) {
  return tactus::internal::console::Main(argc, argv);
}
