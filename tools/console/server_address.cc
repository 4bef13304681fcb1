#include "tools/console/server_address.h"

#include "absl/strings/str_cat.h"
#include "core/base/address.h"
#include "core/base/errors.h"

namespace tactus::internal::console {

absl::Status MayTakeToken(const ServerAddress& server,
                          const std::string& token) {
  if (token.empty() || server.channel.tls_roots ||
      StaysOnThisHost(server.address)) {
    return absl::OkStatus();
  }
  return InvalidConfig(
      absl::StrCat("the console's connection to ", server.address), "plain",
      "TLS (--tls-ca), because a token must not leave the console's host "
      "unencrypted");
}

}  // namespace tactus::internal::console
