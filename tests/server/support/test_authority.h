// File: test_authority.h
//
// TestAuthority: an authority that signs certificates of clients.
//
//   const TestAuthority authority;
//   const auto robot = authority.Issue("arm-7");
//   ASSERT_FALSE(robot.certificate.empty()) << "needs the openssl program";
//   identity.client_roots = authority.certificate();
//
// Its files live as long as the object. Not thread-safe.
#pragma once

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "absl/strings/str_cat.h"

namespace tactus::internal::testing {

class TestAuthority {
 public:
  // PEM; empty if openssl failed.
  struct Identity {
    std::string certificate;
    std::string key;
  };

  TestAuthority() {
    static int count = 0;
    folder_ = absl::StrCat(std::filesystem::temp_directory_path().string(),
                           "/tactus-authority-", getpid(), "-", ++count);
    std::filesystem::create_directories(folder_);
    OpenSsl(absl::StrCat("req -x509 ", kNewKey,
                         " -days 2 -subj /CN=authority -keyout ca.key -out "
                         "ca.crt"));
  }
  ~TestAuthority() { std::filesystem::remove_all(folder_); }

  TestAuthority(const TestAuthority&) = delete;
  TestAuthority& operator=(const TestAuthority&) = delete;

  std::string file() const { return folder_ + "/ca.crt"; }
  std::string certificate() const { return Read("ca.crt"); }

  // A certificate whose subject has the common name `name`, valid for `days`
  // from now; -1: expired.
  Identity Issue(const std::string& name, int days = 2) const {
    OpenSsl(absl::StrCat("req ", kNewKey, " -subj /CN=", name,
                         " -keyout client.key -out client.csr"));
    OpenSsl(
        absl::StrCat("x509 -req -in client.csr -CA ca.crt -CAkey ca.key "
                     "-CAcreateserial -out client.crt -days ",
                     days));
    return {.certificate = Read("client.crt"), .key = Read("client.key")};
  }

 private:
  static constexpr char kNewKey[] =
      "-newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes";

  void OpenSsl(const std::string& arguments) const {
    const std::string command =
        absl::StrCat("cd ", folder_, " && openssl ", arguments, " 2>/dev/null");
    // A failure leaves an empty file or none, which the caller sees.
    if (std::system(command.c_str()) != 0) {
      std::filesystem::remove(folder_ + "/client.crt");
    }
  }
  std::string Read(const std::string& name) const {
    std::ostringstream text;
    text << std::ifstream(folder_ + "/" + name).rdbuf();
    return text.str();
  }

  std::string folder_;
};

}  // namespace tactus::internal::testing
