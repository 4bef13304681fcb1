#include "core/sim/exact/simulate_contact.h"

#include "core/base/status_macros.h"
#include "core/sim/exact/piece_signals.h"

namespace tactus::internal {

absl::StatusOr<SimulatedContact> SimulateContact(
    const TrialSpec& spec, const SimulateOptions& options) {
  const ContactScene scene = SceneOf(spec);
  SimulatedContact contact;
  contact.spec = spec;
  TACTUS_RETURN_IF_ERROR(Validate(scene));
  PieceSignals reader(spec.object, scene, options.area);
  TACTUS_ASSIGN_OR_RETURN(const PieceSummary summary,
                          SolvePieces(scene, options.exact, reader));
  contact.signals = reader.Finish();
  contact.moved = summary.moved;
  contact.events = summary.events;
  contact.skipped_bounces = summary.skipped;
  return contact;
}

absl::StatusOr<std::vector<SimulatedContact>> SimulateWithTwin(
    const TrialSpec& spec) {
  std::vector<SimulatedContact> contacts;
  for (const TrialSpec& each : {spec, FixedTwin(spec)}) {
    TACTUS_ASSIGN_OR_RETURN(contacts.emplace_back(), SimulateContact(each));
    if (!contacts.back().moved) break;
  }
  return contacts;
}

}  // namespace tactus::internal
