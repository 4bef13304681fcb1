// File: postgres_server.h
//
// PostgresServer: a PostgreSQL that the test starts, on a unix socket in a new
// folder.
//
//   if (!PostgresServer::IsInstalled()) GTEST_SKIP();
//   PostgresServer server;
//   auto catalog = OpenPostgresCatalog(server.NewDatabase());
//   server.Kill();                       // as a machine that fails
//   server.Start();
//
// Ends with the object. As root it runs as the user postgres, because it
// refuses root.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace tactus::internal::testing {

class PostgresServer {
 public:
  static bool IsInstalled();

  PostgresServer();
  ~PostgresServer();
  PostgresServer(const PostgresServer&) = delete;
  PostgresServer& operator=(const PostgresServer&) = delete;

  // The address of an empty database.
  std::string NewDatabase();

  // Waits until it serves.
  void Start();
  // SIGKILL to all of its processes.
  void Kill();
  // Ends connections, then itself.
  void Stop();
  // It hangs, with its connections open.
  void Pause();
  void Continue();

  // Runs statements; one that fails fails the test.
  void Sql(const std::string& address, const std::string& statements);

 private:
  int Run(std::vector<std::string> words) const;
  // Itself first.
  std::vector<pid_t> Processes() const;

  std::filesystem::path folder_;
  pid_t server_ = 0;
  int databases_ = 0;
};

}  // namespace tactus::internal::testing
