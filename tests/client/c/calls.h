// File: calls.h
//
// What a C program does with tactus.h; compiled as C11. Test-only.
#pragma once

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

// Frames that are captured at 100 Hz; the trial ends after the last.
typedef struct played_frames {
  const float* values;
  size_t frames;
  size_t values_each;
} played_frames;

// Plays `frames` on the skin cody-forearm at `scale` with the model in the file
// `path`, and writes every number of each answer and event to `text`, a line
// each. Returns how many bytes there would be, or 0 if a call failed, whose
// error is then the text.
size_t play_in_c(const char* path, double scale, const played_frames* frames,
                 char* text, size_t capacity);

// Gives each call what it cannot take. Returns how many answered otherwise than
// tactus.h says, and prints each.
int refusals_in_c(const char* path, const char* damaged_path);

#ifdef __cplusplus
}  // extern "C"
#endif
