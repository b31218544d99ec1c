// Which mutant is alive, and which ones were passed.
#include "tools/mutants/mutant_switch.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>

namespace mutants {

int alive = 0;
namespace {
unsigned char nowhere[1 << 20];
}
unsigned char* reached = nowhere;

namespace {

// Before the constants of other files are made.
__attribute__((constructor(101))) void choose() {
  if (const char* number = std::getenv("MUTANT")) alive = std::atoi(number);
}

/// The file of reached mutants is shared with the programs that a test starts.
void map_reached() {
  const char* path = std::getenv("MUTANTS_REACH");
  if (path == nullptr) return;
  const int file = open(path, O_RDWR | O_CLOEXEC);
  struct stat status {};
  if (file < 0 || fstat(file, &status) != 0) std::_Exit(3);
  void* map = mmap(nullptr, static_cast<std::size_t>(status.st_size), PROT_READ | PROT_WRITE,
                   MAP_SHARED, file, 0);
  close(file);
  if (map == MAP_FAILED) std::_Exit(3);
  reached = static_cast<unsigned char*>(map);
}

}  // namespace
}  // namespace mutants

// The linker puts it in the place of main (--wrap=main): what runs before main is no test's.
// NOLINTBEGIN(bugprone-reserved-identifier)
extern "C" int __real_main(int argc, char** argv);
extern "C" int __wrap_main(int argc, char** argv) {
  mutants::map_reached();
  return __real_main(argc, argv);
}
// NOLINTEND(bugprone-reserved-identifier)
