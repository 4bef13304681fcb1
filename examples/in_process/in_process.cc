// Classifies the contacts of a trial file in this process, without a server.
#include <cstdio>

#include "tactus/classifier.h"
#include "tactus/driver.h"

absl::Status Run(const char* model, const char* trials) {
  const auto classifier = tactus::Classifier::Load(model);
  if (!classifier.ok()) return classifier.status();
  const auto driver = tactus::MakeDriver("replay", {{"data", trials}});
  if (!driver.ok()) return driver.status();
  const auto skin = (*driver)->Configure();
  if (!skin.ok()) return skin.status();
  const auto stream = classifier->Open(*skin);
  if (!stream.ok()) return stream.status();
  absl::Status status = (*driver)->Activate();
  tactus::Frame frame;
  for (int trial = 0; status.ok();) {
    const auto read = (*driver)->Read(frame);
    if (!read.ok()) return read.status();
    if (*read == tactus::ReadResult::kEndOfData) return (*stream)->Close();
    if (*read == tactus::ReadResult::kFrame) {
      status = (*stream)->Push(frame);  // A robot would poll events here.
      continue;
    }
    const auto answer = (*stream)->EndTrial();
    if (!answer.ok()) return answer.status();
    std::printf("%06d", trial++);
    if (const tactus::Contact* contact = answer->main()) {
      for (const tactus::NamedProbability& named : contact->classes) {
        std::printf(" %.17g", named.probability);
      }
    }
    std::printf("\n");
  }
  return status;
}

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: in_process MODEL.tactus TRIALS.h5\n");
    return 2;
  }
  const absl::Status status = Run(argv[1], argv[2]);
  if (!status.ok()) std::fprintf(stderr, "%s\n", status.ToString().c_str());
  return status.ok() ? 0 : 1;
}
