// File: tls_files.h
//
// TlsFiles: a self-signed certificate for localhost and 127.0.0.1, and its key,
// as files that live as long as the object.
//
//   const TlsFiles files;
//   ASSERT_TRUE(files.made()) << "needs the openssl program";
//   ChildTactusd server({"--tls-cert=" + files.certificate(),
//                        "--tls-key=" + files.key()});
//
// Thread-safe once constructed.
#pragma once

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "absl/strings/str_cat.h"

namespace tactus::internal::testing {

class TlsFiles {
 public:
  // `names`: the certificate's subjectAltName, in openssl's notation.
  explicit TlsFiles(const std::string& names = "DNS:localhost,IP:127.0.0.1") {
    static int count = 0;
    base_ = absl::StrCat(std::filesystem::temp_directory_path().string(),
                         "/tactus-tls-", getpid(), "-", ++count);
    const std::string command = absl::StrCat(
        "openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes "
        "-days 2 -subj /CN=test -addext subjectAltName=",
        names, " -keyout ", key(), " -out ", certificate(), " 2>/dev/null");
    made_ = std::system(command.c_str()) == 0;
  }
  ~TlsFiles() {
    std::remove(certificate().c_str());
    std::remove(key().c_str());
  }

  TlsFiles(const TlsFiles&) = delete;
  TlsFiles& operator=(const TlsFiles&) = delete;

  bool made() const { return made_; }
  std::string certificate() const { return base_ + ".crt"; }
  std::string key() const { return base_ + ".key"; }

 private:
  std::string base_;
  bool made_ = false;
};

}  // namespace tactus::internal::testing
