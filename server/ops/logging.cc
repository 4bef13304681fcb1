#include "server/ops/logging.h"

#include <memory>

#include "core/base/errors.h"
#include "core/base/text.h"
#include "google/protobuf/stubs/logging.h"
#include "grpc/support/log.h"
#include "server/ops/clock.h"
#include "server/ops/log_limiter.h"
#include "spdlog/pattern_formatter.h"
#include "spdlog/sinks/stdout_sinks.h"
#include "spdlog/spdlog.h"

namespace tactus::internal::server {
namespace {

constexpr size_t kMaxTextBytes = 2'000;

// The message as one line of printable ASCII; in JSON, what must be is escaped.
class OneLine final : public spdlog::custom_flag_formatter {
 public:
  explicit OneLine(LogFormat format) : format_(format) {}

  void format(const spdlog::details::log_msg& message, const std::tm&,
              spdlog::memory_buf_t& line) override {
    constexpr char kHex[] = "0123456789abcdef";
    size_t left = kMaxTextBytes;
    for (const char c : message.payload) {
      if (left-- == 0) break;
      if (c >= 0x20 && c < 0x7f) {
        if (format_ == LogFormat::kJson && (c == '"' || c == '\\')) {
          line.push_back('\\');
        }
        line.push_back(c);
        continue;
      }
      if (format_ == LogFormat::kJson) line.push_back('\\');
      const auto byte = static_cast<unsigned char>(c);
      const char escaped[] = {'\\', 'x', kHex[byte >> 4], kHex[byte & 15]};
      line.append(escaped, escaped + sizeof(escaped));
    }
  }
  std::unique_ptr<custom_flag_formatter> clone() const override {
    return std::make_unique<OneLine>(format_);
  }

 private:
  const LogFormat format_;
};

// Libraries report errors of single connections and messages, which strangers
// can cause: together they have one limit.
void LogForLibrary(const char* library, bool is_error, const char* message) {
  static LogLimiter limiter({.lines_per_second = 10, .burst = 100});
  if (!is_error) {
    spdlog::debug("{}: {}", library, message);
  } else if (const auto left_out = limiter.Admit(MonotonicNs())) {
    spdlog::warn("{}: {}{}", library, message, LeftOut(*left_out));
  }
}

void LogForGrpc(gpr_log_func_args* entry) {
  LogForLibrary("gRPC", entry->severity == GPR_LOG_SEVERITY_ERROR,
                entry->message);
}

void LogForProtobuf(google::protobuf::LogLevel level, const char*, int,
                    const std::string& message) {
  LogForLibrary("protobuf", level >= google::protobuf::LOGLEVEL_ERROR,
                message.c_str());
}

}  // namespace

absl::Status StartLogging(const std::string& level, LogFormat format) {
  const spdlog::level::level_enum parsed = spdlog::level::from_str(level);
  // from_str returns off for words that it does not know.
  if (parsed == spdlog::level::off && level != "off") {
    return InvalidConfig("log level", Quoted(level),
                         "trace, debug, info, warn, error or off");
  }
  auto formatter = std::make_unique<spdlog::pattern_formatter>();
  formatter->add_flag<OneLine>('*', format)
      .set_pattern(format == LogFormat::kJson
                       ? R"({"time":"%Y-%m-%dT%H:%M:%S.%e","level":"%l",)"
                         R"("message":"%*"})"
                       : "%Y-%m-%dT%H:%M:%S.%e %L %*");
  spdlog::set_default_logger(spdlog::stderr_logger_mt("tactusd"));
  spdlog::set_formatter(std::move(formatter));
  spdlog::set_level(parsed);
  gpr_set_log_function(LogForGrpc);
  google::protobuf::SetLogHandler(LogForProtobuf);
  return absl::OkStatus();
}

}  // namespace tactus::internal::server
