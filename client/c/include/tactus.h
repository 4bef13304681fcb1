// File: tactus.h
//
// The C interface of Tactus: a model and streams in this process, without a
// server and without gRPC. Its answers have the bits of the C++ interface.
//
//   tactus_error error;
//   tactus_model* model = NULL;
//   if (tactus_model_load("no-poses.tactus", &model, &error) != TACTUS_OK) {
//     printf("%s\n", error.text);
//     return;
//   }
//   tactus_skin skin = TACTUS_SKIN_INIT;
//   skin.name = "cody-forearm";
//   skin.scale = 0.001;
//   tactus_stream* stream = NULL;
//   tactus_stream_open(model, &skin, NULL, &stream, &error);
//   tactus_frame frame = TACTUS_FRAME_INIT;
//   frame.values = values;
//   frame.count = tactus_stream_frame_values(stream);
//   tactus_stream_push(stream, &frame, &error);
//   const tactus_contact* contact =
//       tactus_answer_contact(tactus_stream_answer(stream), 0);
//   printf("%s: %f\n", tactus_stream_class_name(stream, 0),
//          tactus_contact_probability(contact, 0));
//   tactus_stream_free(stream);
//   tactus_model_free(model);
//
// Ownership: who makes a model or a stream frees it; NULL may be freed. A model
// may be freed before its streams. What a stream returns belongs to it: names
// until it is freed, an answer and its contacts until the next call of push,
// end_trial, close or free. What a call is given belongs to the caller and is
// not read after the call.
//
// Threads: a model is immutable and may be shared. A stream belongs to one
// thread at a time; different streams do not disturb each other. There are no
// threads, callbacks or global state behind this.
//
// Errors: a call that can fail returns a code of the enum below, and if `error`
// is not NULL, it writes there what was wrong; it leaves `error` alone when it
// succeeds. Programs react to the code and the reason, which stay, and not to
// the text. Calls that only read take NULL and indices that are too high, and
// return 0, NULL, false or NaN. No call throws or ends the program.
//
// Stability: within one TACTUS_ABI, functions and constants stay and structs
// only grow, at their end. A struct begins with its size in the header that the
// program was compiled with, which the ..._INIT values set. A program runs with
// any newer library of the same TACTUS_ABI, which is the number in the name of
// the library. New codes, states and kinds may appear.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define TACTUS_API __attribute__((visibility("default")))
#else
#define TACTUS_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

#define TACTUS_ABI 1

// TACTUS_ABI of the library, and its release, like "0.1.0".
TACTUS_API int32_t tactus_abi(void);
TACTUS_API const char* tactus_version(void);

// The canonical codes, as gRPC numbers them.
enum {
  TACTUS_OK = 0,
  TACTUS_CANCELLED = 1,
  TACTUS_UNKNOWN = 2,
  TACTUS_INVALID_ARGUMENT = 3,
  TACTUS_DEADLINE_EXCEEDED = 4,
  TACTUS_NOT_FOUND = 5,
  TACTUS_ALREADY_EXISTS = 6,
  TACTUS_PERMISSION_DENIED = 7,
  TACTUS_RESOURCE_EXHAUSTED = 8,
  TACTUS_FAILED_PRECONDITION = 9,
  TACTUS_ABORTED = 10,
  TACTUS_OUT_OF_RANGE = 11,
  TACTUS_UNIMPLEMENTED = 12,
  TACTUS_INTERNAL = 13,
  TACTUS_UNAVAILABLE = 14,
  TACTUS_DATA_LOSS = 15,
  TACTUS_UNAUTHENTICATED = 16
};

// The caller's; its size is fixed. Texts are UTF-8, end with 0, and are cut if
// they are too long.
typedef struct tactus_error {
  int32_t code;
  // A name of tactus.v1.ErrorReason without its prefix, like "INVALID_CONFIG";
  // may be empty.
  char reason[60];
  // What was wrong, its value, and what would be right.
  char text[960];
} tactus_error;

// ---- Models

typedef struct tactus_model tactus_model;

// Reads a model's file (trainctl fit) and checks that it computes here what it
// computed where it was made. IO, BUNDLE_CORRUPT, BUNDLE_VERSION,
// INVALID_MODEL. If it fails, `*model` is NULL.
TACTUS_API int32_t tactus_model_load(const char* path, tactus_model** model,
                                     tactus_error* error);
// The same for a file that is in memory already; `name` stands for its path.
TACTUS_API int32_t tactus_model_parse(const void* bytes, size_t size,
                                      const char* name, tactus_model** model,
                                      tactus_error* error);
TACTUS_API void tactus_model_free(tactus_model* model);

// ---- Skins

enum { TACTUS_NEWTON = 0, TACTUS_COUNTS = 1 };

// What frames hold: whole numbers from 0 to 65,535, any numbers, or whole
// numbers from -32,768 to 32,767.
enum { TACTUS_UINT16 = 0, TACTUS_FLOAT32 = 1, TACTUS_INT16 = 2 };

// As tactus::Skin of tactus/skin.h. With rows and columns 0, `name` is that of
// a preset ("cody-forearm", "vitac-12x32", "icub-6x10").
typedef struct tactus_skin {
  size_t struct_size;
  // Layout class. A model answers for skins of one class.
  const char* name;
  int32_t rows;
  int32_t columns;
  // Metres between neighbours; square metres that one taxel stands for.
  double row_pitch_m;
  double column_pitch_m;
  double taxel_area_m2;
  // TACTUS_NEWTON or TACTUS_COUNTS.
  int32_t unit;
  // TACTUS_UINT16, TACTUS_FLOAT32 or TACTUS_INT16.
  int32_t encoding;
  // A taxel is touched from the first on; a contact begins at the second. In
  // `unit`.
  double contact_threshold;
  double onset_threshold;
  // Row-major indices of taxels to ignore.
  const int32_t* masked_taxels;
  size_t masked_count;
  // Values of a taxel, 1 or 3; the axis that carries the load, or -1.
  int32_t axes;
  int32_t normal_axis;
  // Values times this are in `unit`; above 0.
  double scale;
  // Frames per second.
  double sample_rate_hz;
  // The last column is a neighbour of the first.
  bool wrap_columns;
  // Taxels that touch at a corner only are no neighbours.
  bool only_side_neighbours;
  // Values may be below 0.
  bool signed_values;
  // Every frame has a pose.
  bool with_poses;
  // Contacts too light for a single taxel; off while light_window_s is 0.
  double light_window_s;
  int32_t light_rows;
  int32_t light_columns;
  double light_contact_threshold;
  double light_onset_threshold;
} tactus_skin;

#define TACTUS_SKIN_INIT                                                       \
  {                                                                            \
    sizeof(tactus_skin), NULL, 0, 0, 0, 0, 0, TACTUS_NEWTON, TACTUS_UINT16, 0, \
        0, NULL, 0, 1, -1, 1, 100, false, false, false, false, 0, 0, 0, 0, 0   \
  }

// ---- Streams

typedef struct tactus_stream tactus_stream;

// Which answers come; finals and answers with events always do: after every
// interval_frames-th frame, when the contacts or what they probably are change,
// or no others.
enum { TACTUS_INTERVAL = 0, TACTUS_ON_CHANGE = 1, TACTUS_EVENTS = 2 };

// 0 means what the model was calibrated to, or its own.
typedef struct tactus_options {
  size_t struct_size;
  int32_t cadence;
  int32_t interval_frames;
  // What decides a question: a probability, for how many frames.
  double decision_threshold;
  int32_t decision_frames;
  // A contact ends at the latest this long after its last touch.
  int32_t release_after_ms;
  // Contacts that are followed at the same time, 1 to 8.
  int32_t max_contacts;
  // Only end_trial ends a contact.
  bool never_release;
  // About half of the computing time: less accurate, no tactus_object.
  bool low_effort;
  // tactus_contact_taxels has something to say.
  bool with_taxels;
} tactus_options;

#define TACTUS_OPTIONS_INIT                                               \
  {                                                                       \
    sizeof(tactus_options), TACTUS_INTERVAL, 1, 0, 0, 0, 0, false, false, \
        false                                                             \
  }

// Metres, and a quaternion of unit length: the skin's link in the world.
typedef struct tactus_pose {
  double x, y, z;
  double qx, qy, qz, qw;
} tactus_pose;

typedef struct tactus_frame {
  size_t struct_size;
  // When it was read, on the robot's clock; rises from frame to frame.
  int64_t capture_time_ns;
  // Frames that the skin lost directly before this one.
  uint64_t missing_before;
  // [rows x columns x axes], row-major; `count` of them.
  const float* values;
  size_t count;
  // Used only if the skin has poses.
  tactus_pose pose;
} tactus_frame;

#define TACTUS_FRAME_INIT                                        \
  {                                                              \
    sizeof(tactus_frame), 0, 0, NULL, 0, { 0, 0, 0, 0, 0, 0, 1 } \
  }

// `options` may be NULL. If it fails, `*stream` is NULL. INVALID_CONFIG,
// UNKNOWN_LAYOUT, GEOMETRY_MISMATCH and so on, as a server answers them.
TACTUS_API int32_t tactus_stream_open(const tactus_model* model,
                                      const tactus_skin* skin,
                                      const tactus_options* options,
                                      tactus_stream** stream,
                                      tactus_error* error);
TACTUS_API void tactus_stream_free(tactus_stream* stream);

// Takes the next frame and answers it before it returns. INVALID_CONFIG if its
// values are not as many as the skin has, or not as its encoding says; the
// stream then goes on. Any other error ends the stream, and later calls return
// it again. Once answers have grown to their size, it allocates nothing.
TACTUS_API int32_t tactus_stream_push(tactus_stream* stream,
                                      const tactus_frame* frame,
                                      tactus_error* error);
// Ends the trial: tactus_stream_answer is then its final answer. The next frame
// begins another.
TACTUS_API int32_t tactus_stream_end_trial(tactus_stream* stream,
                                           tactus_error* error);
// Ends an open trial and the stream; it may be read until it is freed.
TACTUS_API int32_t tactus_stream_close(tactus_stream* stream,
                                       tactus_error* error);

// Fixed from the beginning.
TACTUS_API size_t tactus_stream_frame_values(const tactus_stream* stream);
TACTUS_API size_t tactus_stream_class_count(const tactus_stream* stream);
TACTUS_API const char* tactus_stream_class_name(const tactus_stream* stream,
                                                size_t index);
TACTUS_API size_t tactus_stream_question_count(const tactus_stream* stream);
TACTUS_API const char* tactus_stream_question_name(const tactus_stream* stream,
                                                   size_t question);
// True if the answer may change during a contact.
TACTUS_API bool tactus_stream_question_is_state(const tactus_stream* stream,
                                                size_t question);
TACTUS_API size_t tactus_stream_value_count(const tactus_stream* stream,
                                            size_t question);
TACTUS_API const char* tactus_stream_value_name(const tactus_stream* stream,
                                                size_t question, size_t value);
// SHA-256 of the model's file, hexadecimal.
TACTUS_API const char* tactus_stream_model_sha256(const tactus_stream* stream);

// ---- Answers

typedef struct tactus_answer tactus_answer;
typedef struct tactus_contact tactus_contact;

// What the last push, end_trial or close answered; NULL if nothing.
TACTUS_API const tactus_answer* tactus_stream_answer(
    const tactus_stream* stream);

typedef struct tactus_answer_info {
  size_t struct_size;
  // The frame's number and time.
  uint64_t sequence;
  int64_t capture_time_ns;
  // Frames of this trial that were lost so far.
  uint64_t frames_missing;
  // The contacts that there are and those that ended with this frame; of a
  // final answer, those that the end of the trial ended.
  size_t contacts;
  // Regions of touched taxels, also those that are no contact.
  int32_t regions;
  bool is_final;
} tactus_answer_info;

#define TACTUS_ANSWER_INFO_INIT \
  { sizeof(tactus_answer_info), 0, 0, 0, 0, 0, false }

// False if `answer` is NULL; the same below.
TACTUS_API bool tactus_answer_get(const tactus_answer* answer,
                                  tactus_answer_info* info);
// The largest first.
TACTUS_API const tactus_contact* tactus_answer_contact(
    const tactus_answer* answer, size_t index);

enum {
  TACTUS_TOUCHING = 0,
  // It touches no taxel for the moment.
  TACTUS_LOST = 1,
  TACTUS_MERGED = 2,
  TACTUS_RELEASED = 3
};

typedef struct tactus_contact_info {
  size_t struct_size;
  // Counts the contacts of a stream from 1.
  uint64_t id;
  // The frame at which it began, and the time since then.
  uint64_t onset_sequence;
  int64_t since_onset_ns;
  // The contact of whose region it was a part, and the one that it is merged
  // into; 0 if none.
  uint64_t parent;
  uint64_t merged_into;
  // Probability that the model has learned from nothing like this contact.
  double unknown;
  // Metres that it has moved since its onset; NaN after its end.
  double motion_m;
  // TACTUS_TOUCHING and so on.
  int32_t state;
} tactus_contact_info;

#define TACTUS_CONTACT_INFO_INIT \
  { sizeof(tactus_contact_info), 0, 0, 0, 0, 0, 0, 0, TACTUS_TOUCHING }

TACTUS_API bool tactus_contact_get(const tactus_contact* contact,
                                   tactus_contact_info* info);
// The probability of a class of the model, and that of a value of a question.
// The classes sum to 1, and so do the values of each question.
TACTUS_API double tactus_contact_probability(const tactus_contact* contact,
                                             size_t class_index);
TACTUS_API double tactus_contact_value(const tactus_contact* contact,
                                       size_t question, size_t value);

// The value whose probability stayed high for long enough.
typedef struct tactus_decided {
  size_t struct_size;
  // Index of the value.
  size_t value;
  // The frame at which the question was decided first, and the time from onset
  // to it; the same for the last change, 0 if there was none.
  uint64_t sequence;
  int64_t since_onset_ns;
  uint64_t changed_sequence;
  int64_t changed_since_onset_ns;
  // How often the value has changed since then.
  int32_t changes;
  // The question is about what stays, and yet its value changed.
  bool revised;
} tactus_decided;

#define TACTUS_DECIDED_INIT \
  { sizeof(tactus_decided), 0, 0, 0, 0, 0, 0, false }

// False while the question is not decided.
TACTUS_API bool tactus_contact_decided(const tactus_contact* contact,
                                       size_t question,
                                       tactus_decided* decided);

// Where a contact is on the skin, and how hard it presses there.
typedef struct tactus_patch {
  size_t struct_size;
  // Sum and largest of the region's taxels, in the skin's unit.
  double force;
  double max_force;
  double area_m2;
  // The region's centroid by fractional row and column; as a place in metres
  // and the outward normal there, in the frame of the skin's link.
  double centroid_row;
  double centroid_column;
  double place[3];
  double normal[3];
  // The same place in the world; NaN without poses.
  double world_place[3];
  // The centroid by load; NaN if no taxel reads a load at this moment.
  double centre_of_pressure[3];
  int32_t area_taxels;
} tactus_patch;

#define TACTUS_PATCH_INIT                                                 \
  {                                                                       \
    sizeof(tactus_patch), 0, 0, 0, 0, 0, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}, \
        {0, 0, 0}, 0                                                      \
  }

// False unless it touches the skin.
TACTUS_API bool tactus_contact_patch(const tactus_contact* contact,
                                     tactus_patch* patch);
// With tactus_options.with_taxels: writes the first `capacity` row-major
// indices of the region and returns how many it has.
TACTUS_API size_t tactus_contact_taxels(const tactus_contact* contact,
                                        int32_t* taxels, size_t capacity);

// Estimates of the object that is touched: means and standard deviations.
typedef struct tactus_object {
  size_t struct_size;
  // log10 of its stiffness in N/m; metres that it has moved since onset.
  double log10_stiffness;
  double log10_stiffness_deviation;
  double moved_m;
  double moved_deviation_m;
} tactus_object;

#define TACTUS_OBJECT_INIT \
  { sizeof(tactus_object), 0, 0, 0, 0 }

// False if the model estimates none.
TACTUS_API bool tactus_contact_object(const tactus_contact* contact,
                                      tactus_object* object);

// ---- Events and notices

enum {
  TACTUS_EVENT_TOUCHED = 0,
  TACTUS_EVENT_RELEASED = 1,
  // A question was decided, or its decided value changed.
  TACTUS_EVENT_DECIDED = 2,
  TACTUS_EVENT_CHANGED = 3,
  // The contact is probably like none that the model has learned from.
  TACTUS_EVENT_UNKNOWN = 4,
  // Its region has joined, or parted from, that of other_contact.
  TACTUS_EVENT_MERGED = 5,
  TACTUS_EVENT_SPLIT = 6,
  TACTUS_EVENT_MOVED_OVER_SKIN = 7
};

typedef struct tactus_event {
  size_t struct_size;
  uint64_t contact;
  // The frame at which it happened, and the contact's time since onset then.
  uint64_t sequence;
  int64_t capture_time_ns;
  int64_t since_onset_ns;
  // For TACTUS_EVENT_MERGED and TACTUS_EVENT_SPLIT; else 0.
  uint64_t other_contact;
  int32_t kind;
  // Indices, for TACTUS_EVENT_DECIDED and TACTUS_EVENT_CHANGED; else -1.
  int32_t question;
  int32_t value;
} tactus_event;

#define TACTUS_EVENT_INIT \
  { sizeof(tactus_event), 0, 0, 0, 0, 0, 0, -1, -1 }

// Takes the oldest event that waits; false if none does. 16,384 wait at most,
// then the oldest are dropped.
TACTUS_API bool tactus_stream_poll(tactus_stream* stream, tactus_event* event);

// News about the stream, not about a contact: the capture times are those of
// another rate than the skin's, or some taxels read unlike in any recording
// that the model was fitted to.
enum { TACTUS_NOTICE_RATE_DIFFERS = 2, TACTUS_NOTICE_SKIN_DIFFERS = 3 };

typedef struct tactus_notice {
  size_t struct_size;
  int32_t kind;
  // For people.
  char text[960];
} tactus_notice;

#define TACTUS_NOTICE_INIT \
  { sizeof(tactus_notice), 0, "" }

// Takes the oldest notice that waits; false if none does. The last 16 wait.
TACTUS_API bool tactus_stream_poll_notice(tactus_stream* stream,
                                          tactus_notice* notice);

#ifdef __cplusplus
}  // extern "C"
#endif
