#include "server/registry/default_bundle.h"

// The assembler copies the file; TACTUS_DEFAULT_BUNDLE is its path.
asm(".section .rodata\n"
    ".balign 16\n"
    "tactus_default_bundle_begin:\n"
    ".incbin \"" TACTUS_DEFAULT_BUNDLE
    "\"\n"
    "tactus_default_bundle_end:\n"
    ".byte 0\n"
    ".previous\n");

extern const char kBundleBegin[] asm("tactus_default_bundle_begin");
extern const char kBundleEnd[] asm("tactus_default_bundle_end");

namespace tactus::server {

absl::string_view DefaultBundle() {
  return absl::string_view(kBundleBegin, kBundleEnd - kBundleBegin);
}

}  // namespace tactus::server
