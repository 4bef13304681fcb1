// trainctl: simulates, imports, trains, evaluates, serves and shows; on files
// or with a server.
#include "tools/trainctl/app.h"

int main(int argc, char** argv) {
  return tactus::internal::client::RunTrainctl(argc, argv);
}
