// Prints what three patches of a robot's skin feel, over one connection.
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tactus/client.h"
#include "tactus/driver.h"

struct Patch {
  std::string name;
  std::unique_ptr<tactus::Driver> skin;
  std::unique_ptr<tactus::Stream> stream;
};

// A simulated patch, which is touched twice.
absl::StatusOr<Patch> MakePatch(const tactus::Client& client,
                                const std::string& name,
                                const std::string& seed) {
  auto driver = tactus::MakeDriver("sim", {{"seed", seed}, {"trials", "2"}});
  if (!driver.ok()) return driver.status();
  const auto skin = (*driver)->Configure();
  if (!skin.ok()) return skin.status();
  const absl::Status active = (*driver)->Activate();
  if (!active.ok()) return active;
  auto stream = client.Open(
      *skin,
      {.client_id = name, .on_event = [name](const tactus::Event& event) {
         std::printf("%s: %s\n", name.c_str(), ToText(event).c_str());
       }});
  if (!stream.ok()) return stream.status();
  return Patch{name, *std::move(driver), *std::move(stream)};
}

// One reading of a patch; false after its last one.
absl::StatusOr<bool> Step(Patch& patch, tactus::Frame& frame) {
  const auto read = patch.skin->Read(frame);
  if (!read.ok()) return read.status();
  absl::Status status;
  if (*read == tactus::ReadResult::kFrame) status = patch.stream->Push(frame);
  if (*read == tactus::ReadResult::kEndOfTrial) {
    status = patch.stream->EndTrial().status();
  }
  if (!status.ok()) return status;
  return *read != tactus::ReadResult::kEndOfData;
}

absl::Status Run(const char* server) {
  const tactus::Client client(server);
  std::vector<Patch> patches;
  for (const auto& [name, seed] :
       {std::pair("palm", "1"), std::pair("forearm", "2"),
        std::pair("shoulder", "3")}) {
    auto patch = MakePatch(client, name, seed);
    if (!patch.ok()) return patch.status();
    patches.push_back(*std::move(patch));
  }
  tactus::Frame frame;
  while (!patches.empty()) {
    for (size_t i = 0; i < patches.size();) {
      const auto goes_on = Step(patches[i], frame);
      if (!goes_on.ok()) return goes_on.status();
      if (*goes_on) {
        ++i;
        continue;
      }
      const absl::Status closed = patches[i].stream->Close();
      if (!closed.ok()) return closed;
      patches.erase(patches.begin() + static_cast<ptrdiff_t>(i));
    }
  }
  return absl::OkStatus();
}

int main(int argc, char** argv) {
  const absl::Status status = Run(argc > 1 ? argv[1] : "127.0.0.1:50051");
  if (!status.ok()) std::fprintf(stderr, "%s\n", status.ToString().c_str());
  return status.ok() ? 0 : 1;
}
