#include "tests/support/postgres_server.h"

#include <fcntl.h>
#include <pwd.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <thread>
#include <utility>

#include "gtest/gtest.h"

namespace tactus::internal::testing {
namespace {

constexpr char kPrograms[] = "/usr/lib/postgresql/15/bin/";

// The user that the server runs as; null if it is this one.
const passwd* ServerUser() {
  return geteuid() == 0 ? getpwnam("postgres") : nullptr;
}

}  // namespace

bool PostgresServer::IsInstalled() {
  return access((std::string(kPrograms) + "initdb").c_str(), X_OK) == 0 &&
         (geteuid() != 0 || ServerUser() != nullptr);
}

PostgresServer::PostgresServer() {
  // A unix socket's path is short, and its folders are open to the server.
  char name[] = "/tmp/tactus-pg-XXXXXX";
  folder_ = mkdtemp(name);
  if (const passwd* user = ServerUser(); user != nullptr) {
    EXPECT_EQ(chown(folder_.c_str(), user->pw_uid, user->pw_gid), 0);
  }
  EXPECT_EQ(Run({"initdb", "--no-sync", "--auth=trust", "--username=tactus",
                 "--encoding=UTF8", "--locale=C",
                 "--pgdata=" + (folder_ / "data").string()}),
            0);
  std::ofstream(folder_ / "data/postgresql.conf", std::ios::app)
      << "listen_addresses = ''\n"
      << "unix_socket_directories = '" << folder_.string() << "'\n"
      << "shared_buffers = 16MB\nmax_connections = 40\n";
  Start();
}

PostgresServer::~PostgresServer() {
  if (server_ > 0) Kill();
  std::filesystem::remove_all(folder_);
}

int PostgresServer::Run(std::vector<std::string> words) const {
  words[0] = kPrograms + words[0];
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const std::string log = folder_ / "log";
  const bool is_server = words[0] == std::string(kPrograms) + "postgres";
  const pid_t child = fork();
  if (child == 0) {
    // A key that ends the test does not end the server before it.
    setpgid(0, 0);
    if (const passwd* user = ServerUser(); user != nullptr) {
      if (setgid(user->pw_gid) != 0 || setuid(user->pw_uid) != 0) _exit(126);
    }
    const int out = open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
    dup2(out, 1);
    dup2(out, 2);
    execv(argv[0], argv.data());
    _exit(127);
  }
  if (is_server) return child;
  int status = 0;
  waitpid(child, &status, 0);
  return status;
}

void PostgresServer::Start() {
  const std::vector<std::string> command = {"postgres", "-D",
                                            (folder_ / "data").string()};
  server_ = Run(command);
  const std::string socket = folder_;
  for (int i = 0; i < 2'400; ++i) {
    // While a process of one that was killed still ends, its memory is in use,
    // and the next one does not begin.
    if (waitpid(server_, nullptr, WNOHANG) == server_) server_ = Run(command);
    if (Run({"pg_isready", "-q", "-h", socket, "-U", "tactus"}) == 0) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  ADD_FAILURE() << "postgres does not start: " << folder_ / "log";
}

std::vector<pid_t> PostgresServer::Processes() const {
  std::vector<pid_t> processes = {server_};
  const std::string process = std::to_string(server_);
  std::ifstream children("/proc/" + process + "/task/" + process + "/children");
  for (pid_t child = 0; children >> child;) processes.push_back(child);
  return processes;
}

void PostgresServer::Kill() {
  // Stopped first, so that none begins meanwhile.
  Pause();
  for (const pid_t process : Processes()) kill(process, SIGKILL);
  waitpid(server_, nullptr, 0);
  server_ = 0;
  std::filesystem::remove(folder_ / "data/postmaster.pid");
}

void PostgresServer::Stop() {
  kill(server_, SIGINT);
  waitpid(server_, nullptr, 0);
  server_ = 0;
}

void PostgresServer::Pause() {
  kill(server_, SIGSTOP);
  for (const pid_t process : Processes()) kill(process, SIGSTOP);
}

void PostgresServer::Continue() {
  for (const pid_t process : Processes()) kill(process, SIGCONT);
}

std::string PostgresServer::NewDatabase() {
  const std::string name = "t" + std::to_string(++databases_);
  const std::string at =
      "postgresql:///%?host=" + folder_.string() + "&user=tactus";
  const auto address = [&](const std::string& database) {
    std::string text = at;
    return text.replace(text.find('%'), 1, database);
  };
  Sql(address("postgres"), "CREATE DATABASE " + name);
  return address(name);
}

void PostgresServer::Sql(const std::string& address,
                         const std::string& statements) {
  EXPECT_EQ(Run({"psql", "--quiet", "--no-psqlrc", "--set=ON_ERROR_STOP=1",
                 "--dbname=" + address, "--command=" + statements}),
            0)
      << statements << ": " << folder_ / "log";
}

}  // namespace tactus::internal::testing
