/* Classifies one touch of a skin in this process, without a server: a press
   that grows, wanders by one taxel and ends. A robot would read its skin. */
#include <stdio.h>
#include <stdlib.h>

#include "tactus.h"

enum { ROWS = 16, COLUMNS = 24, FRAMES = 200, TOUCHED = 150 };

/* Millinewtons of each taxel at a frame. */
static void read_skin(int frame, float* values) {
  for (int i = 0; i < ROWS * COLUMNS; ++i) values[i] = 0;
  if (frame < 10 || frame >= TOUCHED) return;
  const float load = (float)(40 * (frame < 60 ? frame : 60));
  const int column = frame < 100 ? 11 : 12;
  for (int row = 7; row < 9; ++row) {
    values[row * COLUMNS + column] = load;
    values[row * COLUMNS + column + 1] = load / 2;
  }
}

static void print_events(tactus_stream* stream) {
  static const char* const names[] = {"touched", "released",       "decided",
                                      "changed", "unknown",        "merged",
                                      "split",   "moved over skin"};
  tactus_event event = TACTUS_EVENT_INIT;
  while (tactus_stream_poll(stream, &event)) {
    if (event.kind < 0 || event.kind > TACTUS_EVENT_MOVED_OVER_SKIN) continue;
    printf("%d ms: contact %d %s", (int)(event.since_onset_ns / 1000000),
           (int)event.contact, names[event.kind]);
    if (event.question >= 0) {
      const size_t question = (size_t)event.question;
      printf(" %s: %s", tactus_stream_question_name(stream, question),
             tactus_stream_value_name(stream, question, (size_t)event.value));
    }
    printf("\n");
  }
}

static void print_classes(const tactus_stream* stream,
                          const tactus_contact* contact) {
  for (size_t i = 0; i < tactus_stream_class_count(stream); ++i) {
    printf("%s %.17g\n", tactus_stream_class_name(stream, i),
           tactus_contact_probability(contact, i));
  }
}

static int32_t run(const tactus_model* model, tactus_error* error) {
  static float values[ROWS * COLUMNS];
  tactus_skin skin = TACTUS_SKIN_INIT;
  skin.name = "cody-forearm";
  skin.scale = 0.001;
  tactus_stream* stream = NULL;
  int32_t code = tactus_stream_open(model, &skin, NULL, &stream, error);
  tactus_frame frame = TACTUS_FRAME_INIT;
  frame.values = values;
  frame.count = ROWS * COLUMNS;
  for (int i = 0; code == TACTUS_OK && i < FRAMES; ++i) {
    read_skin(i, values);
    frame.capture_time_ns = (int64_t)(i + 1) * 10000000; /* 100 Hz */
    code = tactus_stream_push(stream, &frame, error);
    if (code != TACTUS_OK) break;
    if (i == TOUCHED - 1) {
      print_classes(stream,
                    tactus_answer_contact(tactus_stream_answer(stream), 0));
    }
    print_events(stream);
  }
  if (code == TACTUS_OK) code = tactus_stream_close(stream, error);
  tactus_stream_free(stream);
  return code;
}

int main(int argc, char** argv) {
  if (argc != 2) {
    fprintf(stderr, "usage: in_process_c MODEL.tactus\n");
    return 2;
  }
  tactus_error error;
  tactus_model* model = NULL;
  int32_t code = tactus_model_load(argv[1], &model, &error);
  if (code == TACTUS_OK) code = run(model, &error);
  if (code != TACTUS_OK) fprintf(stderr, "%s: %s\n", error.reason, error.text);
  tactus_model_free(model);
  return code == TACTUS_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}
