// File: console_fixture.h
//
// ConsoleTest: a server, with tokens or without, a console that shows it, and
// what a browser says to the console.
//
//   Start(/*with_tokens=*/false);
//   EXPECT_THAT(Ask("GET /"), StartsWith("HTTP/1.1 200 OK"));
#pragma once

#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/access/access_table.h"
#include "gtest/gtest.h"
#include "server/ops/authorizer.h"
#include "tests/server/support/test_server.h"
#include "tests/support/raw_connection.h"
#include "tests/support/scratch_dir.h"
#include "tools/console/console.h"

namespace tactus::internal::console {

using testing::RawConnection;
using testing::TestServer;

// A server, with tokens or without, and a console that shows it.
class ConsoleTest : public ::testing::Test {
 protected:
  void Start(bool with_tokens) {
    server::TactusServer::Options options;
    options.listen = {"127.0.0.1:0"};
    if (with_tokens) {
      const std::string tokens = folder_ / "tokens";
      std::ofstream(tokens) << *TokenLine("ann", Role::kViewer, "ann-token")
                            << *TokenLine("bob", Role::kAdmin, "bob-token")
                            << *TokenLine("arm", Role::kRobot, "arm-token");
      authorizer_ = *server::Authorizer::Open(tokens);
      options.authorizer = authorizer_.get();
    }
    server_.emplace(options);
    StartConsole(absl::StrCat("127.0.0.1:", server_->server().ports()[0]));
  }

  // A console of a server that listens at `address`.
  void StartConsole(const std::string& address) {
    for (const char* name :
         {"index.html", "app.js", "app.css", "favicon.svg"}) {
      std::ofstream(folder_ / name) << "this is " << name;
    }
    options_.servers = {{address, {}}};
    options_.listen = "127.0.0.1:0";
    options_.page = folder_.path();
    auto console = Console::Start(options_);
    ASSERT_TRUE(console.ok()) << console.status();
    console_ = *std::move(console);
    origin_ = absl::StrCat("localhost:", console_->port());
  }

  // A request without its host.
  std::string RequestOf(const std::string& line, const std::string& header,
                        const std::string& body) const {
    return absl::StrCat(
        line, " HTTP/1.1\r\nHost: ", origin_, "\r\n",
        absl::StrContains(header, "Upgrade") ? "" : "Connection: close\r\n",
        header,
        body.empty() ? ""
                     : absl::StrCat("Content-Length: ", body.size(), "\r\n"),
        "\r\n", body);
  }
  // The whole response to it.
  std::string Ask(const std::string& line, const std::string& header = "",
                  const std::string& body = "") const {
    const RawConnection connection(console_->port());
    connection.Send(RequestOf(line, header, body));
    // To the console, a call whose browser says no more is one without browser.
    if (absl::StrContains(header, "Upgrade")) connection.EndSending();
    return connection.ReadAll();
  }
  std::string OwnOrigin() const {
    return absl::StrCat("Origin: http://", origin_, "\r\n");
  }
  std::string SignIn(const std::string& token) const {
    return Ask("POST /api/sign-in", OwnOrigin(),
               absl::StrCat("{\"token\":\"", token, "\"}"));
  }
  // The headers that a page sends after a sign-in with `token`. An empty token
  // means no sign-in.
  std::string PageOf(const std::string& token) const {
    const std::string response =
        token.empty() ? Ask("GET /api/session") : SignIn(token);
    return absl::StrCat(
        OwnOrigin(),
        "Cookie: tactus=", After(response, "Set-Cookie: tactus=", ';'),
        "\r\nX-CSRF-Token: ", After(response, "\"csrf\":\"", '"'), "\r\n");
  }
  // What follows `name` in a response, up to `end`.
  static std::string After(const std::string& text, const std::string& name,
                           char end) {
    const size_t begin = text.find(name);
    if (begin == std::string::npos) return "";
    const size_t from = begin + name.size();
    return text.substr(from, text.find(end, from) - from);
  }

  ScratchDir folder_;
  std::shared_ptr<server::Authorizer> authorizer_;
  std::optional<TestServer> server_;
  ConsoleOptions options_;
  std::unique_ptr<Console> console_;
  std::string origin_;
};

}  // namespace tactus::internal::console
