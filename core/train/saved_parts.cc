#include "core/train/saved_parts.h"

#include "core/base/serialize.h"
#include "core/base/sha256.h"
#include "core/base/version.h"
#include "core/skin/layout_proto.h"

namespace tactus::internal {
namespace {

// A plain frame has 150 bytes of zeros beside its numbers.
void AddContact(const LabelledContact& contact, Sha256& hash) {
  const ContactFrames& frames = contact.frames;
  ByteWriter writer;
  writer(contact.id, contact.label, contact.condition, contact.material,
         contact.with_poses, contact.sample_rate_hz, contact.stiffness,
         contact.object_motion,
         SerializeDeterministic(LayoutToProto(contact.layout)),
         uint64_t{frames.size()}, frames.plain());
  for (size_t t = 0; t < frames.size(); ++t) {
    const ContactFrames::Numbers numbers = frames.numbers(t);
    for (const double feature : numbers.features) writer(feature);
    writer(numbers.net_force, numbers.touched, numbers.spread.rows,
           numbers.spread.columns, numbers.shear.first, numbers.shear.second);
    if (frames.plain()) continue;
    const ContactSample& sample = frames[t].sample;
    for (const double load : sample.profile) writer(load);
    for (const TaxelLoad& load : sample.loads) writer(load.taxel, load.root);
  }
  hash.Add(writer.bytes());
}

}  // namespace

SavedParts::SavedParts(FitJournal* journal,
                       const std::vector<const LabelledContact*>& contacts,
                       const FitOptions& options)
    : journal_(journal != nullptr && journal->KeepsParts() ? journal
                                                           : nullptr) {
  if (journal_ == nullptr) return;
  ByteWriter writer;
  writer(std::string(kVersion), options, uint64_t{contacts.size()});
  Sha256 hash;
  hash.Add(writer.bytes());
  for (const LabelledContact* contact : contacts) AddContact(*contact, hash);
  fit_ = hash.Finish();
}

std::string SavedParts::OwnerOf(absl::string_view part) const {
  return Sha256Of(fit_ + std::string(part));
}

absl::StatusOr<std::optional<std::string>> SavedParts::FindBytes(
    absl::string_view part) const {
  if (journal_ == nullptr) return std::optional<std::string>();
  std::optional<std::string> bytes = journal_->Find(part);
  if (!bytes) return bytes;
  constexpr size_t kSealBytes = 2 * Sha256::kBytes;
  if (bytes->size() < kSealBytes ||
      Sha256Of(absl::string_view(*bytes).substr(
          0, bytes->size() - Sha256::kBytes)) !=
          bytes->substr(bytes->size() - Sha256::kBytes)) {
    return CheckpointInvalid(part, "its checksum is wrong");
  }
  const size_t payload = bytes->size() - kSealBytes;
  if (bytes->compare(payload, Sha256::kBytes, OwnerOf(part)) != 0) {
    return CheckpointInvalid(
        part, "it belongs to other contacts, options or another version");
  }
  bytes->resize(payload);
  return bytes;
}

absl::Status SavedParts::PutBytes(absl::string_view part,
                                  std::string payload) const {
  payload += OwnerOf(part);
  payload += Sha256Of(payload);
  return journal_->Put(part, std::move(payload));
}

}  // namespace tactus::internal
