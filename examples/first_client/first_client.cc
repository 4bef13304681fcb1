// Streams one second of touch to a Tactus server and prints its answer.
#include <cstdio>

#include "client/stream/contact_stream.h"
#include "client/stream/frame_encoder.h"
#include "core/base/status_macros.h"

absl::Status Run(const char* server) {
  tactus::client::SkinInfo skin;
  TACTUS_ASSIGN_OR_RETURN(skin.layout, tactus::LayoutPreset("cody-forearm"));
  skin.scale = 0.001;  // The skin counts millinewtons.
  auto config = tactus::client::MakeConfig(skin);
  config.set_model("models/no-poses");  // "default" needs poses of the arm.
  TACTUS_ASSIGN_OR_RETURN(
      const auto stream,
      tactus::client::ContactStream::Open(
          tactus::client::MakeChannel(server), config,
          [](const auto& response) {
            for (const auto& event : response.answer().events()) {
              // A robot would react here: touched,
              // decided, changed, released.
              std::printf("event %d\n", event.kind());
            }
          }));
  tactus::client::FrameEncoder encoder(skin, {});
  tactus::client::SkinFrame frame;
  for (int t = 0; t < 100; ++t) {
    frame.capture_time_ns = 10'000'000 * t;
    frame.u16.assign(skin.layout.taxels(), 0);  // Read your skin here.
    for (const int taxel : {180, 181, 204, 205}) frame.u16[taxel] = 20 * t;
    encoder.Add(frame);
    TACTUS_RETURN_IF_ERROR(stream->Send(encoder.request()));
    encoder.Clear();
  }
  TACTUS_ASSIGN_OR_RETURN(const auto answer, stream->EndTrial());
  for (const auto& contact : answer.contacts()) {
    for (int k = 0; k < contact.probability_size(); ++k) {
      std::printf("%s %.6f\n", stream->started().class_names(k).c_str(),
                  contact.probability(k));
    }
  }
  return stream->Close();
}

int main(int argc, char** argv) {
  const absl::Status status = Run(argc > 1 ? argv[1] : "127.0.0.1:50051");
  if (!status.ok()) std::fprintf(stderr, "%s\n", status.ToString().c_str());
  return status.ok() ? 0 : 1;
}
