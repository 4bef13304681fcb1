// Damages an upload: the pack is cut into records, each record becomes a trial
// as FinishUpload makes it, and its contact is extracted as tactus-trainer
// does.
#include "core/contacts/labelled_contact.h"
#include "core/data/trial_record.h"
#include "core/store/file_system.h"
#include "server/records/pack_reader.h"
#include "tactus/v1/trial.pb.h"
#include "tests/fuzz/damaged.h"
#include "tests/support/small_trials.h"

namespace {

std::string TaxelPack() {
  tactus::v1::TrialRecord record;
  record.set_id("taxels");
  record.set_label("SU");
  record.set_sample_rate_hz(100);
  record.set_unit(tactus::v1::TAXEL_UNIT_COUNTS);
  record.mutable_geometry()->set_layout("cody-forearm");
  for (int f = 0; f < 3; ++f) {
    record.add_time(0.01 * f);
    for (int i = 0; i < 384; ++i) {
      record.mutable_taxels()->append(i == 7 ? "\x05\x01" : "\x01\x00", 2);
    }
  }
  return tactus::internal::testing::Packed(record.SerializeAsString());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  using namespace tactus;
  static const auto* const good =
      new std::vector<std::string>{testing::SmallPack(0, 2, 20), TaxelPack()};
  FuzzedDataProvider data(bytes, size);
  const std::string pack = fuzz::Damaged(*good, data);
  const std::string path = fuzz::Write("pack", pack);
  server::PackReader reader(PosixFileSystem(), path,
                            static_cast<int64_t>(pack.size()));
  while (!reader.AtEnd()) {
    const auto record = reader.Next();
    fuzz::RequireReason(record.status());
    if (!record.ok()) return 0;
    v1::TrialRecord parsed;
    if (!parsed.ParseFromString(*record)) return 0;
    const auto trial = FromRecord(parsed);
    fuzz::RequireReason(trial.status());
    // The good trials are good.
    REQUIRE(size > 0 || trial.ok());
    if (!trial.ok()) return 0;
    REQUIRE(Validate(*trial, "trial").ok());
    // What is stored and read again is the same trial.
    const std::string again = ToRecord(*trial).SerializeAsString();
    REQUIRE(parsed.ParseFromString(again));
    const auto back = FromRecord(parsed);
    REQUIRE(back.ok());
    REQUIRE(ToRecord(*back).SerializeAsString() == again);
    fuzz::RequireReason(ExtractContact(*trial).status());
  }
  return 0;
}
