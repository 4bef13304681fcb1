// File: console.h
//
// Console: what people see of one or several servers, in a browser. It speaks
// gRPC to the servers, and HTTP to browsers.
//
//   TACTUS_ASSIGN_OR_RETURN(const auto console, Console::Start(options));
//   std::printf("http://127.0.0.1:%d/\n", console->port());
//
// It shows a person what the person's token may see, and nothing else. One
// thread serves all browsers; calls to servers have their own. Serving ends
// with the object.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "tools/console/imports.h"
#include "tools/console/live_feed.h"

namespace tactus::internal::console {

struct ConsoleOptions {
  std::vector<ServerAddress> servers;
  // "host:port" with a numeric host of this machine; port 0 takes a free one.
  std::string listen = "127.0.0.1:8080";
  // Folder of the page's files.
  std::string page;
  // PEM files. Both or none; without them only this machine can be listened on,
  // because tokens must not leave it unencrypted.
  std::string tls_certificate = {};
  std::string tls_key = {};
  ImportSettings imports = {};
};

class Console {
 public:
  // INVALID_CONFIG, or IO.
  static absl::StatusOr<std::unique_ptr<Console>> Start(ConsoleOptions options);
  ~Console();

  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  int port() const;

 private:
  class Impl;

  explicit Console(std::unique_ptr<Impl> impl);

  const std::unique_ptr<Impl> impl_;
};

}  // namespace tactus::internal::console
