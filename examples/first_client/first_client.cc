// Streams one second of touch to a Tactus server and prints what it felt.
#include <cstdio>

#include "tactus/client.h"

absl::Status Run(const char* server) {
  const tactus::Client client(server);
  const auto stream = client.Open(
      {.name = "cody-forearm", .scale = 0.001},  // It counts millinewtons.
      {.on_event = [](const tactus::Event& event) {
        std::puts(ToText(event).c_str());  // A robot would react here.
      }});
  if (!stream.ok()) return stream.status();
  tactus::Frame frame;
  for (int t = 0; t < 100; ++t) {
    frame.capture_time_ns = 10'000'000 * t;
    frame.values.assign(16 * 24, 0);  // Read your skin here.
    for (const int taxel : {180, 181, 204, 205}) frame.values[taxel] = 20 * t;
    const absl::Status pushed = (*stream)->Push(frame);
    if (!pushed.ok()) return pushed;
  }
  const auto answer = (*stream)->EndTrial();
  if (!answer.ok()) return answer.status();
  for (const auto& question : answer->main()->answers) {
    for (const auto& [value, probability] : question.values) {
      std::printf("%s: %s %.6f\n", question.question.c_str(), value.c_str(),
                  probability);
    }
  }
  return (*stream)->Close();
}

int main(int argc, char** argv) {
  const absl::Status status = Run(argc > 1 ? argv[1] : "127.0.0.1:50051");
  if (!status.ok()) std::fprintf(stderr, "%s\n", status.ToString().c_str());
  return status.ok() ? 0 : 1;
}
