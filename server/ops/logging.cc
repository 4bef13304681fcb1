#include "server/ops/logging.h"

#include "core/base/errors.h"
#include "spdlog/sinks/stdout_sinks.h"
#include "spdlog/spdlog.h"

namespace tactus::server {

absl::Status StartLogging(const std::string& level) {
  const spdlog::level::level_enum parsed = spdlog::level::from_str(level);
  // from_str answers off for words it does not know.
  if (parsed == spdlog::level::off && level != "off") {
    return InvalidConfig("log level", level,
                         "trace, debug, info, warn, error or off");
  }
  spdlog::set_default_logger(spdlog::stderr_logger_mt("tactusd"));
  spdlog::set_pattern("%Y-%m-%dT%H:%M:%S.%e %L %v");
  spdlog::set_level(parsed);
  return absl::OkStatus();
}

}  // namespace tactus::server
