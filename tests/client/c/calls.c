#include "tests/client/c/calls.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tactus.h"

typedef struct text_buffer {
  char* text;
  size_t capacity;
  size_t size;
} text_buffer;

static void add(text_buffer* out, const char* format, ...) {
  va_list arguments;
  const size_t used = out->size < out->capacity ? out->size : out->capacity;
  va_start(arguments, format);
  const int added =
      vsnprintf(out->text + used, out->capacity - used, format, arguments);
  va_end(arguments);
  if (added > 0) out->size += (size_t)added;
}

static void add_contact(text_buffer* out, const tactus_stream* stream,
                        const tactus_contact* contact) {
  tactus_contact_info info = TACTUS_CONTACT_INFO_INIT;
  tactus_contact_get(contact, &info);
  add(out, " contact %llu %d %llu %lld %a", (unsigned long long)info.id,
      (int)info.state, (unsigned long long)info.onset_sequence,
      (long long)info.since_onset_ns, info.unknown);
  if (!isnan(info.motion_m)) add(out, " moved %a", info.motion_m);
  tactus_patch patch = TACTUS_PATCH_INIT;
  if (tactus_contact_patch(contact, &patch)) {
    add(out, " patch %a %a %a %a %a %d", patch.force, patch.max_force,
        patch.area_m2, patch.centroid_row, patch.centroid_column,
        (int)patch.area_taxels);
    for (int i = 0; i < 3; ++i) {
      add(out, " %a %a", patch.place[i], patch.normal[i]);
      if (!isnan(patch.world_place[i])) add(out, " %a", patch.world_place[i]);
      if (!isnan(patch.centre_of_pressure[i])) {
        add(out, " %a", patch.centre_of_pressure[i]);
      }
    }
    int32_t taxels[512];
    const size_t touched = tactus_contact_taxels(contact, taxels, 512);
    for (size_t i = 0; i < touched && i < 512; ++i) {
      add(out, " %d", (int)taxels[i]);
    }
  }
  for (size_t i = 0; i < tactus_stream_class_count(stream); ++i) {
    add(out, " %s %a", tactus_stream_class_name(stream, i),
        tactus_contact_probability(contact, i));
  }
  for (size_t q = 0; q < tactus_stream_question_count(stream); ++q) {
    add(out, " %s", tactus_stream_question_name(stream, q));
    for (size_t v = 0; v < tactus_stream_value_count(stream, q); ++v) {
      add(out, " %s %a", tactus_stream_value_name(stream, q, v),
          tactus_contact_value(contact, q, v));
    }
    tactus_decided decided = TACTUS_DECIDED_INIT;
    if (tactus_contact_decided(contact, q, &decided)) {
      add(out, " decided %s %llu %lld %d",
          tactus_stream_value_name(stream, q, decided.value),
          (unsigned long long)decided.sequence,
          (long long)decided.since_onset_ns, (int)decided.changes);
    }
  }
  tactus_object object = TACTUS_OBJECT_INIT;
  if (tactus_contact_object(contact, &object)) {
    add(out, " object %a %a %a %a", object.log10_stiffness,
        object.log10_stiffness_deviation, object.moved_m,
        object.moved_deviation_m);
  }
}

static void add_answer(text_buffer* out, tactus_stream* stream) {
  const tactus_answer* answer = tactus_stream_answer(stream);
  tactus_answer_info info = TACTUS_ANSWER_INFO_INIT;
  if (!tactus_answer_get(answer, &info)) return;
  add(out, "answer %llu %lld %llu %d %d", (unsigned long long)info.sequence,
      (long long)info.capture_time_ns, (unsigned long long)info.frames_missing,
      (int)info.regions, (int)info.is_final);
  for (size_t i = 0; i < info.contacts; ++i) {
    add_contact(out, stream, tactus_answer_contact(answer, i));
  }
  add(out, "\n");
  tactus_event event = TACTUS_EVENT_INIT;
  while (tactus_stream_poll(stream, &event)) {
    add(out, "event %d %llu %llu %lld", (int)event.kind,
        (unsigned long long)event.contact, (unsigned long long)event.sequence,
        (long long)event.since_onset_ns);
    if (event.question >= 0) {
      add(out, " %s %s",
          tactus_stream_question_name(stream, (size_t)event.question),
          tactus_stream_value_name(stream, (size_t)event.question,
                                   (size_t)event.value));
    }
    add(out, "\n");
  }
}

// TACTUS_OK, or the code of what failed.
static int32_t play(const tactus_model* model, double scale,
                    const played_frames* frames, text_buffer* out,
                    tactus_error* error) {
  tactus_skin skin = TACTUS_SKIN_INIT;
  skin.name = "cody-forearm";
  skin.scale = scale;
  tactus_options options = TACTUS_OPTIONS_INIT;
  options.with_taxels = true;
  tactus_stream* stream = NULL;
  int32_t code = tactus_stream_open(model, &skin, &options, &stream, error);
  tactus_frame frame = TACTUS_FRAME_INIT;
  frame.count = frames->values_each;
  for (size_t i = 0; code == TACTUS_OK && i < frames->frames; ++i) {
    frame.values = frames->values + i * frames->values_each;
    frame.capture_time_ns = (int64_t)(i + 1) * 10000000;
    code = tactus_stream_push(stream, &frame, error);
    if (code == TACTUS_OK) add_answer(out, stream);
  }
  if (code == TACTUS_OK) code = tactus_stream_end_trial(stream, error);
  if (code == TACTUS_OK) add_answer(out, stream);
  if (code == TACTUS_OK) code = tactus_stream_close(stream, error);
  tactus_stream_free(stream);
  return code;
}

size_t play_in_c(const char* path, double scale, const played_frames* frames,
                 char* text, size_t capacity) {
  text_buffer out = {text, capacity, 0};
  tactus_error error;
  tactus_model* model = NULL;
  int32_t code = tactus_model_load(path, &model, &error);
  if (code == TACTUS_OK) code = play(model, scale, frames, &out, &error);
  tactus_model_free(model);
  if (code == TACTUS_OK) return out.size;
  snprintf(text, capacity, "%s", error.text);
  return 0;
}

static int failures = 0;

// The call must answer with `reason` and name `thing`.
static void expect_refusal(const char* call, int32_t code,
                           const tactus_error* error, const char* reason,
                           const char* thing) {
  if (code != TACTUS_OK && code == error->code &&
      strcmp(error->reason, reason) == 0 && strstr(error->text, thing)) {
    return;
  }
  ++failures;
  printf("%s: code %d, reason %s, text %s; want %s and %s\n", call, (int)code,
         error->reason, error->text, reason, thing);
}

#define REFUSES(reason, thing, call)                    \
  do {                                                  \
    tactus_error error = {0, "", ""};                   \
    const int32_t code = (call);                        \
    expect_refusal(#call, code, &error, reason, thing); \
  } while (0)

#define EXPECT(condition)                   \
  do {                                      \
    if (!(condition)) {                     \
      ++failures;                           \
      printf("not true: %s\n", #condition); \
    }                                       \
  } while (0)

static void refuse_models(const char* damaged_path) {
  tactus_model* model = NULL;
  REFUSES("INVALID_CONFIG", "model", tactus_model_load("a", NULL, &error));
  REFUSES("INVALID_CONFIG", "path", tactus_model_load(NULL, &model, &error));
  REFUSES("IO", "/none.tactus",
          tactus_model_load("/none.tactus", &model, &error));
  REFUSES("BUNDLE_CORRUPT", damaged_path,
          tactus_model_load(damaged_path, &model, &error));
  REFUSES("BUNDLE_CORRUPT", "in memory",
          tactus_model_parse("no model", 8, "in memory", &model, &error));
  EXPECT(model == NULL);
  EXPECT(tactus_model_load("/none.tactus", &model, NULL) != TACTUS_OK);
}

static void refuse_skins(const tactus_model* model) {
  tactus_stream* stream = NULL;
  tactus_skin skin = TACTUS_SKIN_INIT;
  REFUSES("INVALID_CONFIG", "skin.name",
          tactus_stream_open(model, &skin, NULL, &stream, &error));
  skin.name = "cody-forearm";
  REFUSES("INVALID_CONFIG", "model",
          tactus_stream_open(NULL, &skin, NULL, &stream, &error));
  REFUSES("INVALID_CONFIG", "skin",
          tactus_stream_open(model, NULL, NULL, &stream, &error));
  REFUSES("INVALID_CONFIG", "stream",
          tactus_stream_open(model, &skin, NULL, NULL, &error));
  skin.encoding = 7;
  REFUSES("INVALID_CONFIG", "skin.encoding",
          tactus_stream_open(model, &skin, NULL, &stream, &error));
  skin.encoding = TACTUS_UINT16;
  skin.struct_size = sizeof skin + 8;
  REFUSES("INVALID_CONFIG", "skin.struct_size",
          tactus_stream_open(model, &skin, NULL, &stream, &error));
  skin.struct_size = 0;
  REFUSES("INVALID_CONFIG", "skin.struct_size",
          tactus_stream_open(model, &skin, NULL, &stream, &error));
  skin.struct_size = sizeof skin;
  skin.masked_count = 3;
  REFUSES("INVALID_CONFIG", "skin.masked_taxels",
          tactus_stream_open(model, &skin, NULL, &stream, &error));
  skin.masked_count = 0;
  skin.name = "icub-6x10";
  REFUSES("GEOMETRY_MISMATCH", "icub-6x10",
          tactus_stream_open(model, &skin, NULL, &stream, &error));
  skin.name = "cody-forearm";
  tactus_options options = TACTUS_OPTIONS_INIT;
  options.cadence = -1;
  REFUSES("INVALID_CONFIG", "options.cadence",
          tactus_stream_open(model, &skin, &options, &stream, &error));
  options.cadence = TACTUS_INTERVAL;
  options.decision_threshold = 0.5;
  REFUSES("INVALID_CONFIG", "decision_threshold",
          tactus_stream_open(model, &skin, &options, &stream, &error));
  EXPECT(stream == NULL);
}

static void refuse_frames(const tactus_model* model) {
  tactus_skin skin = TACTUS_SKIN_INIT;
  skin.name = "cody-forearm";
  skin.encoding = TACTUS_FLOAT32;
  tactus_stream* stream = NULL;
  EXPECT(tactus_stream_open(model, &skin, NULL, &stream, NULL) == TACTUS_OK);
  const size_t count = tactus_stream_frame_values(stream);
  EXPECT(count == 384);
  float* values = calloc(count, sizeof(float));
  tactus_frame frame = TACTUS_FRAME_INIT;
  REFUSES("INVALID_CONFIG", "stream", tactus_stream_push(NULL, &frame, &error));
  REFUSES("INVALID_CONFIG", "frame", tactus_stream_push(stream, NULL, &error));
  REFUSES("INVALID_CONFIG", "384", tactus_stream_push(stream, &frame, &error));
  frame.count = (size_t)-1;
  REFUSES("INVALID_CONFIG", "384", tactus_stream_push(stream, &frame, &error));
  frame.count = count;
  REFUSES("INVALID_CONFIG", "frame.values",
          tactus_stream_push(stream, &frame, &error));
  frame.values = values;
  EXPECT(tactus_stream_answer(stream) == NULL);
  EXPECT(tactus_stream_push(stream, &frame, NULL) == TACTUS_OK);
  EXPECT(tactus_stream_answer(stream) != NULL);
  // This ends the stream.
  values[3] = NAN;
  frame.capture_time_ns = 10000000;
  REFUSES("NON_FINITE_TAXEL", "taxel 3",
          tactus_stream_push(stream, &frame, &error));
  EXPECT(tactus_stream_answer(stream) == NULL);
  REFUSES("NON_FINITE_TAXEL", "taxel 3",
          tactus_stream_end_trial(stream, &error));
  REFUSES("NON_FINITE_TAXEL", "taxel 3", tactus_stream_close(stream, &error));
  tactus_stream_free(stream);
  free(values);
}

static void read_nothing(const tactus_model* model) {
  tactus_skin skin = TACTUS_SKIN_INIT;
  skin.name = "cody-forearm";
  tactus_stream* stream = NULL;
  EXPECT(tactus_stream_open(model, &skin, NULL, &stream, NULL) == TACTUS_OK);
  EXPECT(tactus_stream_class_name(stream, 99) == NULL);
  EXPECT(tactus_stream_question_name(stream, 99) == NULL);
  EXPECT(!tactus_stream_question_is_state(stream, 99));
  EXPECT(tactus_stream_value_count(stream, 99) == 0);
  EXPECT(tactus_stream_value_name(stream, 0, 99) == NULL);
  EXPECT(tactus_stream_value_name(stream, 99, 0) == NULL);
  EXPECT(strlen(tactus_stream_model_sha256(stream)) == 64);
  EXPECT(tactus_stream_close(stream, NULL) == TACTUS_OK);
  REFUSES("STREAM_FINISHED", "", tactus_stream_end_trial(stream, &error));
  tactus_stream_free(stream);
  tactus_event event = TACTUS_EVENT_INIT;
  tactus_notice notice = TACTUS_NOTICE_INIT;
  tactus_patch patch = TACTUS_PATCH_INIT;
  tactus_object object = TACTUS_OBJECT_INIT;
  tactus_decided decided = TACTUS_DECIDED_INIT;
  tactus_contact_info contact = TACTUS_CONTACT_INFO_INIT;
  tactus_answer_info answer = TACTUS_ANSWER_INFO_INIT;
  EXPECT(tactus_stream_frame_values(NULL) == 0);
  EXPECT(tactus_stream_class_count(NULL) == 0);
  EXPECT(tactus_stream_model_sha256(NULL) == NULL);
  EXPECT(tactus_stream_answer(NULL) == NULL);
  EXPECT(!tactus_stream_poll(NULL, &event));
  EXPECT(!tactus_stream_poll_notice(NULL, &notice));
  EXPECT(!tactus_answer_get(NULL, &answer));
  EXPECT(tactus_answer_contact(NULL, 0) == NULL);
  EXPECT(!tactus_contact_get(NULL, &contact));
  EXPECT(isnan(tactus_contact_probability(NULL, 0)));
  EXPECT(isnan(tactus_contact_value(NULL, 0, 0)));
  EXPECT(!tactus_contact_decided(NULL, 0, &decided));
  EXPECT(!tactus_contact_patch(NULL, &patch));
  EXPECT(tactus_contact_taxels(NULL, NULL, 0) == 0);
  EXPECT(!tactus_contact_object(NULL, &object));
  tactus_stream_free(NULL);
  tactus_model_free(NULL);
}

int refusals_in_c(const char* path, const char* damaged_path) {
  failures = 0;
  EXPECT(tactus_abi() == TACTUS_ABI);
  EXPECT(tactus_version()[0] != 0);
  refuse_models(damaged_path);
  tactus_model* model = NULL;
  EXPECT(tactus_model_load(path, &model, NULL) == TACTUS_OK);
  refuse_skins(model);
  refuse_frames(model);
  read_nothing(model);
  tactus_model_free(model);
  return failures;
}
