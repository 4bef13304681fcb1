// File: child_server.h
//
// ChildServer: one of our servers as a child process, on a free port. The
// program lies in the same folder as this one. The process ends with the
// object.
//
//   TACTUS_ASSIGN_OR_RETURN(auto server, ChildServer::Start("tactusd"));
//   MakeChannel(server->address());
//
// Owns the process. Not thread-safe.
#pragma once

#include <sys/resource.h>
#include <sys/types.h>

#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace tactus::internal::client {

class ChildServer {
 public:
  // Starts `program` with `arguments` and --port-file. Returns when the server
  // has written its port to that file, or IO after ten seconds.
  static absl::StatusOr<std::unique_ptr<ChildServer>> Start(
      const std::string& program,
      const std::vector<std::string>& arguments = {});
  ~ChildServer();

  ChildServer(const ChildServer&) = delete;
  ChildServer& operator=(const ChildServer&) = delete;

  const std::string& address() const { return address_; }
  // Memory it has in use, KiB.
  double ResidentKib() const;
  // Processor time it has used, s, to 10 ms.
  double CpuSeconds() const;
  // Ends it with SIGKILL. Only the destructor may follow.
  void Kill();

 private:
  ChildServer() = default;
  absl::Status Await(const std::string& port_file);

  pid_t pid_ = -1;
  std::string address_;
};

// A port of 127.0.0.1 that was free a moment ago, or 0.
int FreePort();
// The path of a program in this program's directory.
std::string ProgramBeside(const std::string& name);
// What of a child process is printed with what this one prints.
enum class ChildOutput { kAll, kErrors };
// Starts a program of this program's directory. Returns its process id, or IO.
absl::StatusOr<pid_t> SpawnBeside(const std::string& name,
                                  const std::vector<std::string>& arguments,
                                  ChildOutput output = ChildOutput::kAll);
// Waits until the process has ended. IO, naming `what`, unless it ended well.
// `used`, unless null, is what it used of the machine.
absl::Status AwaitSuccess(pid_t pid, absl::string_view what,
                          rusage* used = nullptr);
// Sends SIGTERM and waits until the process has ended.
void EndProcess(pid_t pid);

}  // namespace tactus::internal::client
