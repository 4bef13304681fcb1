// A program with one model in it, which answers a touch and prints what it
// weighs in memory, in C; docs/measure-c.sh compiles it.
#include <stdio.h>
#include <string.h>

#include "tactus.h"

// The assembler puts the model there.
extern const char model_begin[];
extern const char model_end[];

enum { ROWS = 16, COLUMNS = 24, FRAMES = 1000 };

static void touch(int frame, float* values) {
  for (int i = 0; i < ROWS * COLUMNS; ++i) values[i] = 0;
  if (frame % 200 < 10 || frame % 200 >= 120) return;
  for (int i = 0; i < 2; ++i) {
    values[(7 + i) * COLUMNS + 11] = (float)(20 * (frame % 200));
    values[(7 + i) * COLUMNS + 12] = (float)(10 * (frame % 200));
  }
}

static int answer_frames(const tactus_model* model, tactus_error* error) {
  static float values[ROWS * COLUMNS];
  tactus_skin skin = TACTUS_SKIN_INIT;
  skin.name = "cody-forearm";
  skin.scale = 0.001;
  tactus_stream* stream = NULL;
  int32_t code = tactus_stream_open(model, &skin, NULL, &stream, error);
  tactus_frame frame = TACTUS_FRAME_INIT;
  frame.values = values;
  frame.count = ROWS * COLUMNS;
  int answered = 0;
  for (int i = 0; code == TACTUS_OK && i < FRAMES; ++i) {
    touch(i, values);
    frame.capture_time_ns = (int64_t)(i + 1) * 10000000;
    code = tactus_stream_push(stream, &frame, error);
    answered += tactus_answer_contact(tactus_stream_answer(stream), 0) != NULL;
    tactus_event event = TACTUS_EVENT_INIT;
    while (tactus_stream_poll(stream, &event)) {
    }
  }
  // Not freed: what it weighs while it streams is the question.
  return code == TACTUS_OK ? answered : -1;
}

static void print_memory(void) {
  char line[256];
  FILE* status = fopen("/proc/self/status", "r");
  if (status == NULL) return;
  while (fgets(line, sizeof line, status) != NULL) {
    if (strncmp(line, "VmHWM", 5) == 0 || strncmp(line, "VmRSS", 5) == 0 ||
        strncmp(line, "RssAnon", 7) == 0 || strncmp(line, "RssFile", 7) == 0) {
      printf("  %s", line);
    }
  }
  fclose(status);
}

int main(void) {
  printf("memory of the program before it loads the model\n");
  print_memory();
  tactus_error error = {0, "", ""};
  tactus_model* model = NULL;
  tactus_model_parse(model_begin, (size_t)(model_end - model_begin), "built in",
                     &model, &error);
  const int answered = model == NULL ? -1 : answer_frames(model, &error);
  if (answered <= 0) {
    fprintf(stderr, "footprint: %s\n", error.text);
    return 1;
  }
  printf("memory after %d frames, of which %d had a contact\n", FRAMES,
         answered);
  print_memory();
  return 0;
}
