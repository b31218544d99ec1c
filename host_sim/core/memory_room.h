// Whether there is memory, for libraries that end the program where there is none.
#pragma once

#include <cstddef>
#include <new>

namespace screed {

/// Throws std::bad_alloc unless so much can be allocated at once.
inline void check_memory(std::size_t bytes) {
  void* const room = ::operator new(bytes);
  *static_cast<volatile char*>(room) = 0;  // or compilers leave it out
  ::operator delete(room);
}

}  // namespace screed
