// What the C interfaces have in common: everything that comes from C is checked, everything that is
// thrown ends before it.
#pragma once

#include <screed/base.h>

#include <atomic>
#include <cstdio>
#include <exception>
#include <new>
#include <stdexcept>
#include <string>

#include "host_sim/core/errors.h"
#include "host_sim/physics/terrain/height_field.h"

namespace screed::interface {

/// Two threads in one handle.
class Busy : public std::runtime_error {
 public:
  explicit Busy(const std::string& what)
      : std::runtime_error("this " + what + " is in use on another thread; one thread at a time") {}
};

/// What every handle begins with.
struct Handle {
  mutable std::atomic_flag in_use = ATOMIC_FLAG_INIT;
};

/// A handle while a call is at work with it. Throws InputError for a null pointer, Busy.
class Use {
 public:
  Use(const Handle* handle, const char* what) : handle_(handle) {
    if (handle == nullptr) throw InputError(std::string(what) + ": a null pointer");
    if (handle->in_use.test_and_set(std::memory_order_acquire)) throw Busy(what);
  }
  ~Use() { handle_->in_use.clear(std::memory_order_release); }
  Use(const Use&) = delete;
  Use& operator=(const Use&) = delete;

 private:
  const Handle* handle_;
};

inline void say(screed_error* error, const char* text) {
  if (error != nullptr) std::snprintf(error->text, sizeof(error->text), "%s", text);
}

/// Does the work; whatever it throws becomes a status and a text.
template <typename Work>
screed_status attempt(screed_error* error, const Work& work) noexcept {
  say(error, "");
  try {
    work();
    return SCREED_OK;
  } catch (const Busy& busy) {
    say(error, busy.what());
    return SCREED_BUSY;
  } catch (const InputError& wrong) {
    say(error, wrong.what());
    return SCREED_BAD_INPUT;
  } catch (const std::bad_alloc&) {
    say(error, "not enough memory");
    return SCREED_NO_MEMORY;
  } catch (const std::exception& failed) {
    say(error, failed.what());
    return SCREED_FAILED;
  }
}

/// Throws InputError "what = value; allowed: range".
void require(bool allowed, const std::string& what, double value, const char* range);
void require_pointer(const void* pointer, const char* what);

/// Heights of a part of a field, row by row from the south, m. Throws InputError.
void copy_heights(const HeightField& field, const screed_rectangle* part, double* heights);

}  // namespace screed::interface
