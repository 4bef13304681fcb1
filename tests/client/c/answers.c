// Prints all that a model answers about recorded frames, in C:
//
//   c_answers MODEL.tactus FRAMES POSES
//
// FRAMES is what frames_of_trials.py writes; POSES is 1 for models of contacts
// with poses, else 0. A line is
//
//   trial INDEX
//   contact NUMBER...   per contact and frame: id, classes, values of questions,
//                       unknown, force, centroid, motion, estimates of the object
//   event NUMBER...     all of an event
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "tactus.h"

enum { TAXELS = 384 };

static void print_contact(const tactus_stream* stream,
                          const tactus_contact* contact) {
  tactus_contact_info info = TACTUS_CONTACT_INFO_INIT;
  tactus_contact_get(contact, &info);
  printf("contact %d", (int)info.id);
  for (size_t i = 0; i < tactus_stream_class_count(stream); ++i) {
    printf(" %.17g", tactus_contact_probability(contact, i));
  }
  for (size_t q = 0; q < tactus_stream_question_count(stream); ++q) {
    for (size_t v = 0; v < tactus_stream_value_count(stream, q); ++v) {
      printf(" %.17g", tactus_contact_value(contact, q, v));
    }
  }
  printf(" %.17g", info.unknown);
  tactus_patch patch = TACTUS_PATCH_INIT;
  if (tactus_contact_patch(contact, &patch)) {
    printf(" %.17g %.17g %.17g", patch.force, patch.centroid_row,
           patch.centroid_column);
  }
  if (!isnan(info.motion_m)) printf(" %.17g", info.motion_m);
  tactus_object object = TACTUS_OBJECT_INIT;
  if (tactus_contact_object(contact, &object)) {
    printf(" %.17g %.17g %.17g %.17g", object.log10_stiffness,
           object.log10_stiffness_deviation, object.moved_m,
           object.moved_deviation_m);
  }
  printf("\n");
}

static void print_answer(tactus_stream* stream) {
  const tactus_answer* answer = tactus_stream_answer(stream);
  const tactus_contact* contact;
  for (size_t i = 0; (contact = tactus_answer_contact(answer, i)) != NULL;
       ++i) {
    print_contact(stream, contact);
  }
  tactus_event event = TACTUS_EVENT_INIT;
  while (tactus_stream_poll(stream, &event)) {
    printf("event %d %d %d %d %d %d\n", (int)event.kind, (int)event.contact,
           (int)event.sequence, (int)(event.since_onset_ns / 1000000),
           (int)event.question, (int)event.value);
  }
}

// False at the end of the file.
static bool read_frame(FILE* file, float* values, tactus_frame* frame) {
  return fread(&frame->capture_time_ns, sizeof(int64_t), 1, file) == 1 &&
         fread(&frame->pose, sizeof(double), 7, file) == 7 &&
         fread(values, sizeof(float), TAXELS, file) == TAXELS;
}

static int32_t run(const tactus_model* model, FILE* file, bool with_poses,
                   tactus_error* error) {
  tactus_skin skin = TACTUS_SKIN_INIT;
  skin.name = "cody-forearm";
  skin.scale = 0.001;
  skin.with_poses = with_poses;
  static float values[TAXELS];
  tactus_frame frame = TACTUS_FRAME_INIT;
  frame.values = values;
  frame.count = TAXELS;
  int32_t code = TACTUS_OK;
  int32_t frames;
  for (int trial = 0;
       code == TACTUS_OK && fread(&frames, sizeof frames, 1, file) == 1;
       ++trial) {
    printf("trial %d\n", trial);
    tactus_stream* stream = NULL;
    code = tactus_stream_open(model, &skin, NULL, &stream, error);
    for (int i = 0; code == TACTUS_OK && i < frames; ++i) {
      if (!read_frame(file, values, &frame)) break;
      code = tactus_stream_push(stream, &frame, error);
      if (code == TACTUS_OK) print_answer(stream);
    }
    if (code == TACTUS_OK) code = tactus_stream_end_trial(stream, error);
    if (code == TACTUS_OK) print_answer(stream);
    tactus_stream_free(stream);
  }
  return code;
}

int main(int argc, char** argv) {
  FILE* file = argc == 4 ? fopen(argv[2], "rb") : NULL;
  if (file == NULL) {
    fprintf(stderr, "usage: c_answers MODEL.tactus FRAMES POSES\n");
    return 2;
  }
  tactus_error error;
  tactus_model* model = NULL;
  int32_t code = tactus_model_load(argv[1], &model, &error);
  if (code == TACTUS_OK) code = run(model, file, argv[3][0] == '1', &error);
  if (code != TACTUS_OK) fprintf(stderr, "%s\n", error.text);
  tactus_model_free(model);
  fclose(file);
  return code == TACTUS_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}
