#include "server/registry/default_bundle.h"

// The assembler copies the files; TACTUS_..._BUNDLE are their paths.
asm(".section .rodata\n"
    ".balign 16\n"
    "tactus_default_bundle_begin:\n"
    ".incbin \"" TACTUS_DEFAULT_BUNDLE
    "\"\n"
    "tactus_default_bundle_end:\n"
    ".byte 0\n"
    ".balign 16\n"
    "tactus_no_poses_bundle_begin:\n"
    ".incbin \"" TACTUS_NO_POSES_BUNDLE
    "\"\n"
    "tactus_no_poses_bundle_end:\n"
    ".byte 0\n"
    ".previous\n");

extern const char kDefaultBegin[] asm("tactus_default_bundle_begin");
extern const char kDefaultEnd[] asm("tactus_default_bundle_end");
extern const char kNoPosesBegin[] asm("tactus_no_poses_bundle_begin");
extern const char kNoPosesEnd[] asm("tactus_no_poses_bundle_end");

namespace tactus::internal::server {

absl::string_view DefaultBundle() {
  return absl::string_view(kDefaultBegin, kDefaultEnd - kDefaultBegin);
}

absl::string_view NoPosesBundle() {
  return absl::string_view(kNoPosesBegin, kNoPosesEnd - kNoPosesBegin);
}

}  // namespace tactus::internal::server
