// trainctl skin find: which skins send on the serial lines of this machine.
#include <iostream>
#include <memory>
#include <vector>

#include "client/drivers/serial/serial_search.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "tools/trainctl/command.h"
#include "tools/trainctl/skin/find_port.h"
#include "tools/trainctl/text.h"

namespace tactus::internal::client {
namespace {

struct FindFlags {
  SerialSearch search;
  double seconds = 4;
  bool json = false;
};

Json FoundJson(const SerialFound& found) {
  Json line = {{"port", found.path}, {"bytes", found.bytes}};
  if (!found.problem.empty()) line["problem"] = found.problem;
  if (found.magnets > 0) {
    line["magnets"] = found.magnets;
    line["rate_hz"] = found.magnets_hz;
    return line;
  }
  if (!found.shape) return line;
  const bool ascii = found.shape->format == SerialFormat::kAscii;
  line["format"] = ascii ? "ascii" : "aa55";
  line["taxels"] = found.shape->taxels;
  line["rate_hz"] = found.shape->rate_hz;
  if (ascii) {
    line["rows"] = found.shape->rows;
    line["columns"] = found.shape->columns;
  }
  return line;
}

absl::Status RunFind(FindFlags flags) {
  flags.search.listen_ns = std::llround(1e9 * flags.seconds);
  const std::vector<SerialFound> lines = ListenToSerialLines(flags.search);
  Json list = Json::array();
  bool any = false;
  for (const SerialFound& found : lines) {
    any |= found.shape.has_value() || found.magnets > 0;
    if (flags.json) {
      list.push_back(FoundJson(found));
      continue;
    }
    std::cout << ToText(found) << "\n";
    if (found.magnets == 0 && found.shape && found.shape->rows == 0) {
      std::cout << "  rows x columns may be " << ShapesOf(found.shape->taxels)
                << "\n";
    }
  }
  if (flags.json) std::cout << JsonText(Json{{"lines", list}}) << "\n";
  return any ? absl::OkStatus()
             : IoError("serial lines", "no skin sends on them");
}

}  // namespace

absl::Status FindPortAloud(SkinSourceOptions& options) {
  TACTUS_ASSIGN_OR_RETURN(const std::string found, FindPort(options));
  if (!found.empty()) std::cerr << found << "\n";
  return absl::OkStatus();
}

void AddSkinFind(CLI::App& app, const SelectCommand& select) {
  auto flags = std::make_shared<FindFlags>();
  CLI::App& group =
      CommandGroup(app, "skin", "Learn about a skin", "estimate mine.h5");
  CLI::App* command =
      &AddVerb(group, "find",
               "Find skins on serial lines, their shapes and their "
               "rates",
               "find");
  command->add_option("--baud", flags->search.baud, "Rate of the serial lines")
      ->capture_default_str();
  command->add_option("--seconds", flags->seconds, "How long to listen")
      ->check(CLI::Range(0.1, 600.0))
      ->capture_default_str();
  command
      ->add_option("--by-id", flags->search.by_id,
                   "Folder with links that name the adapters")
      ->capture_default_str();
  command
      ->add_option("--devices", flags->search.devices,
                   "Folder with the lines ttyUSB* and ttyACM*")
      ->capture_default_str();
  command->add_flag("--json", flags->json, "Print one JSON object on stdout");
  command->callback([=] { select([=] { return RunFind(*flags); }); });
}

}  // namespace tactus::internal::client
